#include <cblas.h>

#include <Eigen/SparseCore>
#include <stdexcept>
#include <utility>
#include <vector>

#include "offline/sources/fem/factorization.hpp"
#include "offline/sources/fem/fem_source.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/harness/time_of.hpp"

#ifdef GREENLOOP_HAS_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

namespace greenloop::bench {
namespace {

constexpr int repetitions = 9;

template <class Solve>
double median_seconds(Solve solve) {
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) seconds.push_back(1e-6 * time_of(1, solve));
  return median(std::move(seconds));
}

}  // namespace

BackSubstitution time_back_substitution(const GreenStore& store) {
  const auto& contents = store.contents();
  if (contents.volume.tetrahedra.empty()) {
    throw std::runtime_error(store.path().string() +
                             ": holds no volume, so there is no stiffness matrix to solve with");
  }
  openblas_set_num_threads(1);
  const offline::FemProblem problem = offline::fem_problem(contents);
  const offline::MeshEdges edges = offline::list_edges(problem.volume);
  const auto stiffness = offline::assemble_stiffness(problem, edges, offline::free_points(problem, edges));
  const Eigen::VectorXd force = Eigen::VectorXd::Ones(stiffness.rows());
  BackSubstitution result;
  double checksum = 0;
#ifdef GREENLOOP_HAS_CHOLMOD
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(stiffness);
  result.solver = "CHOLMOD";
  result.seconds = median_seconds([&] { checksum += Eigen::VectorXd(factor.solve(force))[0]; });
#else
  offline::Factorization factor(stiffness, 3);
  const Eigen::SparseMatrix<double> right_hand_side = Eigen::MatrixXd(force).sparseView();
  Eigen::MatrixXd solution(stiffness.rows(), 1);
  result.solver = "MUMPS";
  result.seconds = median_seconds([&] {
    factor.solve(right_hand_side, solution);
    checksum += solution(0, 0);
  });
#endif
  if (!(checksum != 0)) {
    throw std::runtime_error("back-substitution gave no displacement");
  }
  return result;
}

}  // namespace greenloop::bench
