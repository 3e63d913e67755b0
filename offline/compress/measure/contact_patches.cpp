#include "offline/compress/measure/contact_patches.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "offline/compress/measure/point_choice.hpp"

namespace greenloop::offline {
namespace {

// the nodal forces that hold every node at the unit displacements; empty if the compliance is not positive definite
Eigen::MatrixXd holding_forces(const Eigen::MatrixXd& compliance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(compliance);
  if (factor.info() != Eigen::Success) return {};
  return factor.solve(Eigen::Matrix3d::Identity().replicate(compliance.rows() / 3, 1));
}

// relative, the worst of the three displacements; infinite if `found` is not positive definite
double holding_force_error(const Eigen::MatrixXd& exact, const Eigen::MatrixXd& found) {
  const Eigen::MatrixXd wanted = holding_forces(exact), forces = holding_forces(found);
  if (forces.size() == 0) return std::numeric_limits<double>::infinity();
  return ((forces - wanted).colwise().norm().array() / wanted.colwise().norm().array()).maxCoeff();
}

}  // namespace

ContactPatches::ContactPatches(const std::vector<Eigen::Vector3d>& positions, std::size_t count) {
  for (const std::size_t centre : farthest_points(positions, count)) {
    Patch patch{.rows = nearest_points(positions, positions[centre], nodes_per_patch), .compliance = {}};
    std::sort(patch.rows.begin(), patch.rows.end());
    const auto size = static_cast<Eigen::Index>(3 * patch.rows.size());
    patch.compliance = Eigen::MatrixXd::Zero(size, size);
    patches_.push_back(std::move(patch));
  }
}

std::vector<std::size_t> ContactPatches::rows() const {
  std::vector<std::size_t> all;
  for (const auto& patch : patches_) all.insert(all.end(), patch.rows.begin(), patch.rows.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void ContactPatches::add(const Eigen::MatrixXd& block, std::size_t first) {
  const std::size_t end = first + static_cast<std::size_t>(block.cols()) / 3;
  for (auto& patch : patches_) {
    const auto begin = std::lower_bound(patch.rows.begin(), patch.rows.end(), first);
    for (auto it = begin; it != patch.rows.end() && *it < end; ++it) {
      for (std::size_t a = 0; a < patch.rows.size(); ++a) {
        patch.compliance.block<3, 3>(static_cast<Eigen::Index>(3 * a), 3 * (it - patch.rows.begin())) =
            block.block<3, 3>(static_cast<Eigen::Index>(3 * patch.rows[a]),
                              static_cast<Eigen::Index>(3 * (*it - first)));
      }
    }
  }
}

double ContactPatches::force_error(const CompressedCompliance<3>& compressed, std::size_t level,
                                   std::size_t number) const {
  const Patch& patch = patches_[number];
  return holding_force_error(patch.compliance, compressed.between(level, patch.rows));
}

std::vector<ContactPatches::Error> ContactPatches::force_errors(const CompressedCompliance<3>& compressed,
                                                                std::size_t level) const {
  std::vector<Error> errors;
  errors.reserve(patches_.size());
  for (std::size_t p = 0; p < patches_.size(); ++p) errors.push_back({force_error(compressed, level, p), p});
  std::sort(errors.begin(), errors.end(),
            [](const Error& a, const Error& b) { return std::pair(-a.force, a.patch) < std::pair(-b.force, b.patch); });
  return errors;
}

double ContactPatches::worst_force_error(const CompressedCompliance<3>& compressed, std::size_t level) const {
  return patches_.empty() ? 0 : force_errors(compressed, level).front().force;
}

double ContactPatches::worst_force_error(const ContactPatches& found) const {
  double worst = 0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Eigen::MatrixXd& columns = found.patches_[p].compliance;
    worst = std::max(worst, holding_force_error(patches_[p].compliance, 0.5 * (columns + columns.transpose())));
  }
  return worst;
}

ContactPatches ContactPatches::choose(const std::vector<std::size_t>& patches) const {
  ContactPatches chosen;
  for (const std::size_t p : patches) chosen.patches_.push_back(patches_[p]);
  return chosen;
}

}  // namespace greenloop::offline
