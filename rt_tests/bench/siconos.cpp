#include "rt_tests/bench/siconos.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "rt_tests/bench/thread_timer.hpp"
#ifdef GREENLOOP_HAS_SICONOS
#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#endif

namespace greenloop::bench {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector(const Vec4& v) { return {v.x, v.y, v.z}; }

Matrix3d frame_of(const Vec4& normal) {
  const Vector3d n = vector(normal).normalized();
  Matrix3d rows;
  rows.row(0) = n;
  rows.row(1) = n.unitOrthogonal();
  rows.row(2) = n.cross(Vector3d(rows.row(1)));
  return rows;
}

Matrix3d block_of(const ContactCompliance& compliance, std::size_t i, std::size_t j) {
  const Block<3>& of = compliance.at(std::min(i, j), std::max(i, j));
  Matrix3d block;
  for (int c = 0; c < 3; ++c) block.col(c) << of.column[c][0], of.column[c][1], of.column[c][2];
  return i <= j ? block : Matrix3d(block.transpose());
}

}  // namespace

SiconosProblem::SiconosProblem(const ContactCompliance& compliance, const std::vector<ContactCandidate>& candidates)
    : count_(candidates.size()), frame_(9 * candidates.size()) {
  const auto order = static_cast<Index>(3 * count_);
  matrix_.resize(9 * count_ * count_);
  free_.resize(3 * count_);
  Eigen::Map<Eigen::MatrixXd> all(matrix_.data(), order, order);
  std::vector<Matrix3d> frames;
  double trace = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    frames.push_back(frame_of(candidates[i].normal));
    Eigen::Map<Matrix3d>(frame_.data() + 9 * i) = frames[i];
    friction_.push_back(candidates[i].friction);
    trace += block_of(compliance, i, i).trace();
  }
  const double unit = 3 * static_cast<double>(count_) / trace;
  for (std::size_t j = 0; j < count_; ++j) {
    for (std::size_t i = 0; i < count_; ++i) {
      all.block<3, 3>(static_cast<Index>(3 * i), static_cast<Index>(3 * j)) =
          unit * frames[i] * block_of(compliance, i, j) * frames[j].transpose();
    }
    Eigen::Map<Vector3d>(free_.data() + 3 * j) = unit * frames[j] * vector(candidates[j].gap);
  }
}

#ifdef GREENLOOP_HAS_SICONOS

bool SiconosProblem::available() { return true; }

SiconosProblem::Answer SiconosProblem::solve(bool newton, const std::vector<Vec4>& start,
                                             const std::vector<Vec4>& forces, double residual) {
  std::vector<double> reaction(3 * count_);
  std::vector<double> velocity(3 * count_);
  double size = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Map<Matrix3d> frame(frame_.data() + 9 * i);
    Eigen::Map<Vector3d>(reaction.data() + 3 * i) = frame * vector(start[i]);
    size += vector(forces[i]).squaredNorm();
  }
  const double of_free = Eigen::Map<Eigen::VectorXd>(free_.data(), static_cast<Index>(3 * count_)).norm();
  const int order = static_cast<int>(3 * count_);
  NumericsMatrix* const matrix = NM_create_from_data(NM_DENSE, order, order, matrix_.data());
  FrictionContactProblem problem{3, static_cast<int>(count_), matrix, free_.data(), friction_.data()};
  SolverOptions* const options = solver_options_create(newton ? SICONOS_FRICTION_3D_NSN_AC : SICONOS_FRICTION_3D_NSGS);
  options->dparam[SICONOS_DPARAM_TOL] = residual * std::sqrt(size) / of_free;
  const ThreadTimer timer;
  const int failed = fc3d_driver(&problem, reaction.data(), velocity.data(), options);
  const double us = timer.us();
  solver_options_delete(options);
  matrix->matrix0 = nullptr;  // ours
  NM_clear(matrix);
  std::free(matrix);
  return {failed == 0, us};
}

#else

bool SiconosProblem::available() { return false; }

SiconosProblem::Answer SiconosProblem::solve(bool, const std::vector<Vec4>&, const std::vector<Vec4>&, double) {
  return {};
}

#endif

}  // namespace greenloop::bench
