#include "offline/compress/measure/exact_contacts.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace greenloop::offline {
namespace {

using Contacts = std::vector<std::size_t>;  // of a site, by number

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, const Contacts& contacts) {
  Eigen::MatrixXd part(static_cast<Eigen::Index>(3 * contacts.size()), matrix.cols());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    part.middleRows<3>(static_cast<Eigen::Index>(3 * k)) =
        matrix.middleRows<3>(static_cast<Eigen::Index>(3 * contacts[k]));
  }
  return part;
}

// the compliance between two sets of a site's contacts
Eigen::MatrixXd between(const Eigen::MatrixXd& compliance, const Contacts& to, const Contacts& from) {
  return rows_of(rows_of(compliance, to).transpose(), from).transpose();
}

// A sphere against the contacts of its site: which of them it pushes.
class SphereContact {
 public:
  SphereContact(const ContactSite& site, const std::vector<Eigen::Vector3d>& positions,
                const Eigen::MatrixXd& compliance)
      : site_(site), positions_(positions), compliance_(compliance), active_(site.rows.size()) {
    for (std::size_t k = 0; k < active_.size(); ++k) active_[k] = k == 0 || depth(k, Eigen::Vector3d::Zero()) > 0;
  }

  // none if the compliance is not positive definite
  [[nodiscard]] std::optional<Contacts> solve() {
    constexpr int most_rounds = 64;
    for (int round = 0;; ++round) {
      const Contacts contacts = chosen(true);
      const Eigen::LLT<Eigen::MatrixXd> factor(between(compliance_, contacts, contacts));
      if (factor.info() != Eigen::Success) return {};
      const Eigen::VectorXd force = factor.solve(rows_of(site_.displacement, contacts));
      if (release(contacts, force)) continue;
      if (round >= most_rounds || !take(contacts, force)) return contacts;
    }
  }

 private:
  [[nodiscard]] Contacts chosen(bool active) const {
    Contacts contacts;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      if (active_[k] == active) contacts.push_back(k);
    }
    return contacts;
  }

  // how far a displaced contact would be inside, m
  [[nodiscard]] double depth(std::size_t k, const Eigen::Vector3d& displacement) const {
    return site_.sphere->radius - (positions_[site_.rows[k]] + displacement - site_.sphere->centre).norm();
  }

  // lets go of what pulls; never of all
  bool release(const Contacts& contacts, const Eigen::VectorXd& force) {
    bool any = false;
    for (std::size_t i = 0; i < contacts.size() && contacts.size() > 1; ++i) {
      const Eigen::Vector3d outward = positions_[site_.rows[contacts[i]]] - site_.sphere->centre;
      if (!(force.segment<3>(static_cast<Eigen::Index>(3 * i)).dot(outward) < 0)) continue;
      active_[contacts[i]] = false;
      any = true;
    }
    if (chosen(true).empty()) active_[contacts.front()] = true;
    return any && chosen(true) != contacts;
  }

  // takes what would be pierced
  bool take(const Contacts& contacts, const Eigen::VectorXd& force) {
    const Contacts others = chosen(false);
    const Eigen::VectorXd moved = between(compliance_, others, contacts) * force;
    bool any = false;
    for (std::size_t i = 0; i < others.size(); ++i) {
      const double inside = depth(others[i], moved.segment<3>(static_cast<Eigen::Index>(3 * i)));
      if (!(inside > tolerance * site_.sphere->radius)) continue;
      active_[others[i]] = true;
      any = true;
    }
    return any;
  }

  static constexpr double tolerance = 1e-6;
  const ContactSite& site_;
  const std::vector<Eigen::Vector3d>& positions_;
  const Eigen::MatrixXd& compliance_;
  std::vector<bool> active_;
};

}  // namespace

ExactContacts::ExactContacts(std::vector<ContactSite> sites, std::vector<Eigen::Vector3d> positions)
    : sites_(std::move(sites)), positions_(std::move(positions)) {
  for (const auto& site : sites_) {
    const auto size = static_cast<Eigen::Index>(3 * site.rows.size());
    compliance_.emplace_back(Eigen::MatrixXd::Zero(size, size));
  }
}

void ExactContacts::add(const Eigen::MatrixXd& block, std::size_t first) {
  const std::size_t end = first + static_cast<std::size_t>(block.cols()) / 3;
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const auto& rows = sites_[s].rows;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      if (rows[j] < first || rows[j] >= end) continue;
      compliance_[s].middleCols<3>(static_cast<Eigen::Index>(3 * j)) =
          rows_of(block.middleCols<3>(static_cast<Eigen::Index>(3 * (rows[j] - first))), rows);
    }
  }
}

void ExactContacts::keep(std::size_t s, const Contacts& contacts) {
  ContactSite& site = sites_[s];
  const auto rows = std::exchange(site.rows, {});
  const auto group = std::exchange(site.group, {});
  for (const std::size_t k : contacts) {
    site.rows.push_back(rows[k]);
    site.group.push_back(group[k]);
  }
  site.displacement = rows_of(site.displacement, contacts);
  compliance_[s] = between(compliance_[s], contacts, contacts);
}

bool ExactContacts::solve_site(std::size_t s) {
  if (sites_[s].sphere) {
    const auto contacts = SphereContact(sites_[s], positions_, compliance_[s]).solve();
    if (!contacts) return false;
    keep(s, *contacts);
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(compliance_[s]);
  if (factor.info() != Eigen::Success) return false;
  force_.emplace_back(factor.solve(sites_[s].displacement));
  field_.emplace_back(
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * positions_.size()), sites_[s].displacement.cols()));
  return true;
}

void ExactContacts::solve() {
  std::vector<ContactSite> solved;
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    if (solve_site(s)) solved.push_back(std::move(sites_[s]));
    compliance_[s] = {};
  }
  sites_ = std::move(solved);
}

void ExactContacts::add_fields(const Eigen::MatrixXd& block, std::size_t first) {
  const std::size_t end = first + static_cast<std::size_t>(block.cols()) / 3;
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const auto& rows = sites_[s].rows;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      if (rows[j] < first || rows[j] >= end) continue;
      field_[s].noalias() += block.middleCols<3>(static_cast<Eigen::Index>(3 * (rows[j] - first))) *
                             force_[s].middleRows<3>(static_cast<Eigen::Index>(3 * j));
    }
  }
}

}  // namespace greenloop::offline
