#include "offline/compress/measure/certificate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace greenloop::offline {
namespace {

constexpr Eigen::Index most_steps = 1200;
constexpr Eigen::Index steps_between_checks = 25;
constexpr double settled = 0.005;  // relative change of the estimate between checks

// a fixed start without structure
Eigen::VectorXd scrambled(Eigen::Index size) {
  Eigen::VectorXd vector(size);
  std::uint64_t state = 1;
  for (auto& value : vector) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    value = static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
  }
  return vector.normalized();
}

double least_ritz_value(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  const auto size = static_cast<Eigen::Index>(diagonal.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::VectorXd::Map(diagonal.data(), size),
                                Eigen::VectorXd::Map(beside.data(), size - 1), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff();
}

}  // namespace

double estimate_least_eigenvalue(const CompressedCompliance<3>& compressed, const Progress& progress) {
  const auto size = static_cast<Eigen::Index>(3 * compressed.rows(compressed.finest()));
  const Eigen::Index steps = std::min(most_steps, size);
  Eigen::MatrixXd basis(size, steps);
  basis.col(0) = scrambled(size);
  std::vector<double> diagonal, beside;
  Eigen::VectorXd next(size);
  double estimate = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < steps; ++k) {
    compressed.apply(compressed.finest(), 1, basis.col(k).data(), next.data());
    diagonal.push_back(basis.col(k).dot(next));
    for (int twice = 0; twice < 2; ++twice) {
      next -= basis.leftCols(k + 1) * (basis.leftCols(k + 1).transpose() * next);
    }
    const double norm = next.norm();
    const bool last = k + 1 == steps || !(norm > 0);
    if (last || (k + 1) % steps_between_checks == 0) {
      const double before = estimate;
      estimate = least_ritz_value(diagonal, beside);
      if (progress) progress(static_cast<double>(k + 1) / static_cast<double>(steps), "certificate");
      if (last || estimate <= 0 || before - estimate < settled * estimate) break;
    }
    beside.push_back(norm);
    basis.col(k + 1) = next / norm;
  }
  if (progress) progress(1.0, "certificate");
  return estimate;
}

std::size_t certificate_check_bytes(const CompressedCompliance<3>& compressed) {
  const std::size_t n = 3 * compressed.rows(compressed.finest());
  return n * n * sizeof(double);
}

CertificateCheck check_certificate(const CompressedCompliance<3>& compressed, double lambda_min,
                                   const Progress& progress) {
  const std::size_t finest = compressed.finest(), rows = compressed.rows(finest);
  const auto n = static_cast<Eigen::Index>(3 * rows);
  Eigen::MatrixXd matrix(n, n);
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = compressed.column(finest, j);
    for (std::size_t i = 0; i < rows; ++i) {
      matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
          Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
    }
    if (progress && j % 64 == 0) progress(0.5 * static_cast<double>(j) / static_cast<double>(rows), "assemble");
  }
  CertificateCheck check{.unknowns = static_cast<std::size_t>(n)};
  const double rounding = static_cast<double>(n + 1) * std::numeric_limits<double>::epsilon() * matrix.trace();
  check.shift = lambda_min + rounding;
  matrix.diagonal().array() -= check.shift;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);  // in place
  check.holds = lambda_min > 0 && factor.info() == Eigen::Success;
  if (progress) progress(1.0, "factor");
  return check;
}

}  // namespace greenloop::offline
