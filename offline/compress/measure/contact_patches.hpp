#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "offline/compress/encode/compressed_compliance.hpp"

namespace greenloop::offline {

/// Contact patches all over a body whose exact compliance is known, to measure what the compressed model makes of the
/// forces that hold them. A patch is a node and the nodes nearest to it.
class ContactPatches {
 public:
  static constexpr std::size_t nodes_per_patch = 64;

  /// At most `count` patches around nodes spread as far from each other as can be (farthest-point sampling), thin parts
  /// included. `positions` [m]: of the domain rows of one level.
  ContactPatches(const std::vector<Eigen::Vector3d>& positions, std::size_t count);

  /// Reads the patches' entries out of exact columns [first, first + block columns / 3); m/N.
  void add(const Eigen::MatrixXd& block, std::size_t first);

  [[nodiscard]] std::size_t size() const { return patches_.size(); }

  /// The rows of all patches, increasing.
  [[nodiscard]] std::vector<std::size_t> rows() const;

  /// Relative error ||f^ - f|| / ||f|| of the nodal forces that hold a patch displaced as a whole along x, y or z (so
  /// pressed and sheared), the worst of the three, with the compliance of `level`; infinite if the compressed patch is
  /// not positive definite. Work: 64 columns.
  [[nodiscard]] double force_error(const CompressedCompliance<3>& compressed, std::size_t level,
                                   std::size_t patch) const;

  struct Error {
    double force = 0;  ///< force_error
    std::size_t patch = 0;
  };
  /// The errors of all patches, the worst first.
  [[nodiscard]] std::vector<Error> force_errors(const CompressedCompliance<3>& compressed, std::size_t level) const;

  /// The worst over all patches.
  [[nodiscard]] double worst_force_error(const CompressedCompliance<3>& compressed, std::size_t level) const;

  /// The worst over all patches, with the symmetric part of a compliance whose columns were added to `found`, which has
  /// the same patches.
  [[nodiscard]] double worst_force_error(const ContactPatches& found) const;

  /// Some of the patches, by number.
  [[nodiscard]] ContactPatches choose(const std::vector<std::size_t>& patches) const;

 private:
  struct Patch {
    std::vector<std::size_t> rows;  ///< increasing
    Eigen::MatrixXd compliance;     ///< 3n x 3n, m/N
  };
  ContactPatches() = default;
  std::vector<Patch> patches_;
};

}  // namespace greenloop::offline
