#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "offline/compress/measure/contact_patterns.hpp"

namespace greenloop::offline {

/// The exact answers to contact patterns, gathered while the exact columns stream by: once all columns through add,
/// then solve, then all columns through add_fields. Memory: 3 rows numbers per sample. Offline only.
class ExactContacts {
 public:
  /// `positions` [m]: of the domain rows.
  ExactContacts(std::vector<ContactSite> sites, std::vector<Eigen::Vector3d> positions);

  /// Reads the sites' entries out of exact columns [first, first + block columns / 3); m/N.
  void add(const Eigen::MatrixXd& block, std::size_t first);

  /// The forces that hold the contacts where they are: f = U_SS^-1 u_S. A sphere lets go of contacts that pull and
  /// takes those of its contacts that it would pierce, until neither is left or 64 times round; then it lets go only.
  /// Sites whose exact compliance is not positive definite are left out. Work: a Cholesky factorisation per site, for
  /// spheres per time round.
  void solve();

  /// Adds what exact columns from `first` on contribute to the fields u = U_:S f.
  void add_fields(const Eigen::MatrixXd& block, std::size_t first);

  [[nodiscard]] const std::vector<ContactSite>& sites() const { return sites_; }  ///< spheres: pushing contacts only
  [[nodiscard]] const Eigen::MatrixXd& force(std::size_t site) const { return force_[site]; }  ///< 3 contacts x samples
  [[nodiscard]] const Eigen::MatrixXd& field(std::size_t site) const { return field_[site]; }  ///< 3 rows x samples, m

 private:
  [[nodiscard]] bool solve_site(std::size_t s);
  void keep(std::size_t s, const std::vector<std::size_t>& contacts);

  std::vector<ContactSite> sites_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::MatrixXd> compliance_, force_, field_;  // by site
};

}  // namespace greenloop::offline
