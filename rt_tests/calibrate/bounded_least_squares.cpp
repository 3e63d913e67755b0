#include "rt_tests/calibrate/bounded_least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace greenloop {
namespace {

// min z^T G z / 2 - b^T z, z >= 0, by the set of the components that are not bound
class ActiveSet {
 public:
  ActiveSet(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs)
      : gram_(gram), rhs_(rhs), z_(Eigen::VectorXd::Zero(rhs.size())) {}

  Eigen::VectorXd solve() {
    // no set comes twice but for rounding
    for (Eigen::Index round = 0; round < 10 * rhs_.size(); ++round) {
      const Eigen::Index entering = steepest();
      if (entering < 0) break;
      free_.push_back(entering);
      while (!move_to_minimum()) {
      }
    }
    return z_;
  }

 private:
  // the bound component whose growth makes the sum fall most; -1: none does
  [[nodiscard]] Eigen::Index steepest() const {
    constexpr double rounding = 1e-10;
    const Eigen::VectorXd descent = rhs_ - gram_ * z_;
    Eigen::Index best = -1;
    double most = 0;
    for (Eigen::Index i = 0; i < rhs_.size(); ++i) {
      if (gram_(i, i) <= 0 || std::find(free_.begin(), free_.end(), i) != free_.end()) continue;
      const double slope = descent[i] / std::sqrt(gram_(i, i));
      const double terms = std::abs(rhs_[i]) + gram_.row(i).cwiseAbs() * z_;
      if (descent[i] > rounding * terms && slope > most) {
        best = i;
        most = slope;
      }
    }
    return best;
  }

  // towards the minimum over the free components; false: some met their bounds on the way and are free no longer
  bool move_to_minimum() {
    if (free_.empty()) return true;
    const Eigen::VectorXd from = z_(free_);
    const Eigen::VectorXd way = Eigen::VectorXd(gram_(free_, free_).ldlt().solve(rhs_(free_))) - from;
    double step = 1;
    for (Eigen::Index k = 0; k < way.size(); ++k) {
      if (from[k] + way[k] < 0) step = std::min(step, -from[k] / way[k]);
    }
    z_(free_) = from + step * way;
    if (step == 1) return true;
    std::vector<Eigen::Index> still;
    for (Eigen::Index k = 0; k < way.size(); ++k) {
      const Eigen::Index i = free_[static_cast<std::size_t>(k)];
      const bool met = from[k] + way[k] < 0 && -from[k] / way[k] <= step;
      if (met) z_[i] = 0;
      if (!met) still.push_back(i);
    }
    free_ = still;
    return false;
  }

  const Eigen::MatrixXd& gram_;
  const Eigen::VectorXd& rhs_;
  Eigen::VectorXd z_;
  std::vector<Eigen::Index> free_;
};

}  // namespace

Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                                      const Eigen::VectorXd& lower) {
  if (gram.rows() != rhs.size() || gram.cols() != rhs.size() || lower.size() != rhs.size()) {
    throw std::invalid_argument("bounded_least_squares: sizes differ");
  }
  const Eigen::VectorXd shifted = rhs - gram * lower;
  return lower + ActiveSet(gram, shifted).solve();
}

}  // namespace greenloop
