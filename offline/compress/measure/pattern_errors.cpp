#include "offline/compress/measure/pattern_errors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace greenloop::offline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// contacts that are stood for by the same row
struct ResolvedContacts {
  std::vector<std::size_t> columns;  // rows, increasing
  std::vector<std::size_t> column;   // by contact: its place among them
  std::vector<double> members;       // by column
};

ResolvedContacts resolve(const std::vector<std::size_t>& representatives) {
  ResolvedContacts set{.columns = representatives, .column = {}, .members = {}};
  std::sort(set.columns.begin(), set.columns.end());
  set.columns.erase(std::unique(set.columns.begin(), set.columns.end()), set.columns.end());
  set.members.assign(set.columns.size(), 0);
  for (const std::size_t row : representatives) {
    const auto at = std::lower_bound(set.columns.begin(), set.columns.end(), row);
    set.column.push_back(static_cast<std::size_t>(at - set.columns.begin()));
    ++set.members[set.column.back()];
  }
  return set;
}

Eigen::MatrixXd average(const ResolvedContacts& set, const Eigen::MatrixXd& displacement) {
  Eigen::MatrixXd averages =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * set.columns.size()), displacement.cols());
  for (std::size_t i = 0; i < set.column.size(); ++i) {
    averages.middleRows<3>(static_cast<Eigen::Index>(3 * set.column[i])) +=
        displacement.middleRows<3>(static_cast<Eigen::Index>(3 * i)) / set.members[set.column[i]];
  }
  return averages;
}

Eigen::MatrixXd share(const ResolvedContacts& set, const Eigen::MatrixXd& force) {
  Eigen::MatrixXd shares(static_cast<Eigen::Index>(3 * set.column.size()), force.cols());
  for (std::size_t i = 0; i < set.column.size(); ++i) {
    shares.middleRows<3>(static_cast<Eigen::Index>(3 * i)) =
        force.middleRows<3>(static_cast<Eigen::Index>(3 * set.column[i])) / set.members[set.column[i]];
  }
  return shares;
}

double total_force_error(const ContactSite& site, const Eigen::VectorXd& found, const Eigen::VectorXd& exact) {
  Eigen::Matrix<double, 3, 2> off = Eigen::Matrix<double, 3, 2>::Zero(), total = off;
  for (std::size_t i = 0; i < site.group.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    off.col(site.group[i]) += found.segment<3>(at) - exact.segment<3>(at);
    total.col(site.group[i]) += exact.segment<3>(at);
  }
  return off.colwise().norm().sum() / total.colwise().norm().sum();
}

float stored(double error) { return static_cast<float>(std::min(error, double{std::numeric_limits<float>::max()})); }

void store(const Quantiles& error, float (&record)[3]) {
  record[0] = stored(error.median);
  record[1] = stored(error.p95);
  record[2] = stored(error.worst);
}

Quantiles quantiles_of(const std::vector<AnswerError>& errors, double AnswerError::*which) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const auto& error : errors) values.push_back(error.*which);
  return quantiles(std::move(values));
}

}  // namespace

Quantiles quantiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {at(0.5), at(0.95), values.back()};
}

AnsweredContacts::AnsweredContacts(const ModelView& view, const CompressedCompliance<3>& compressed,
                                   const ExactContacts& exact)
    : view_(view), compressed_(compressed), exact_(exact), place_(view.node_count, layout::none) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      place_[level.node_begin + i] = level.domain_begin + i;
      area_.push_back(double{level.nodes[i].area});
      read_.push_back((level.nodes[i].flags & layout::node_read) != 0);
    }
  }
}

std::vector<std::size_t> AnsweredContacts::representatives(const std::vector<std::size_t>& rows,
                                                           std::size_t level) const {
  std::vector<std::size_t> result;
  result.reserve(rows.size());
  for (const std::size_t row : rows) {
    const std::size_t node = compressed_.wavelet().nodes()[row];
    std::uint32_t q = 0;
    while (node - view_.level[q].node_begin >= view_.level[q].counts->node_count) ++q;
    result.push_back(place_[view_.representatives[level][q][node - view_.level[q].node_begin]]);
  }
  return result;
}

std::vector<AnswerError> AnsweredContacts::site_errors(std::size_t number, std::size_t level,
                                                       std::size_t details) const {
  const ContactSite& site = exact_.sites()[number];
  const std::size_t samples = site.kinds.size();
  std::vector<AnswerError> errors;
  for (const auto kind : site.kinds) {
    const double total = layout::has_total_force(kind) ? infinity : 0;
    errors.push_back({kind, site.contacts, infinity, infinity, infinity, total});
  }
  const ResolvedContacts set = resolve(representatives(site.rows, level));
  const Eigen::LLT<Eigen::MatrixXd> factor(compressed_.between(level, set.columns));
  if (factor.info() != Eigen::Success) return errors;
  const Eigen::MatrixXd force = factor.solve(average(set, site.displacement));
  const Eigen::MatrixXd shares = share(set, force);
  for (std::size_t k = 0; k < samples; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd exact = exact_.force(number).col(at), found = shares.col(at);
    errors[k].force = (found - exact).norm() / exact.norm();
    if (layout::has_total_force(site.kinds[k])) errors[k].total_force = total_force_error(site, found, exact);
  }

  std::vector<double> f(3 * samples * compressed_.rows(level), 0.0), x(3 * samples * area_.size());
  for (std::size_t c = 0; c < set.columns.size(); ++c) {
    Eigen::Map<Eigen::Matrix3Xd>(f.data() + 3 * samples * set.columns[c], 3, static_cast<Eigen::Index>(samples)) =
        force.middleRows<3>(static_cast<Eigen::Index>(3 * c));
  }
  compressed_.displace(level, details, samples, f.data(), x.data());
  compare_fields(number, level, x, errors);
  return errors;
}

void AnsweredContacts::compare_fields(std::size_t number, std::size_t level, const std::vector<double>& found,
                                      std::vector<AnswerError>& errors) const {
  const Eigen::MatrixXd& exact = exact_.field(number);
  const std::size_t samples = errors.size();
  std::vector<bool> compared = read_;
  if (level == compressed_.finest()) {  // these nodes are held where they are
    for (const std::size_t row : exact_.sites()[number].rows) compared[row] = false;
  }
  for (std::size_t k = 0; k < samples; ++k) {
    double off = 0, norm = 0, largest_off = 0, largest = 0;
    for (std::size_t row = 0; row < area_.size(); ++row) {
      const Eigen::Vector3d u = exact.col(static_cast<Eigen::Index>(k)).segment<3>(static_cast<Eigen::Index>(3 * row));
      largest = std::max(largest, u.squaredNorm());
      norm += area_[row] * u.squaredNorm();
      if (!compared[row]) continue;
      const double error =
          (Eigen::Map<const Eigen::Vector3d>(found.data() + 3 * (samples * row + k)) - u).squaredNorm();
      off += area_[row] * error;
      largest_off = std::max(largest_off, error);
    }
    errors[k].field = std::sqrt(off / norm);
    errors[k].peak = std::sqrt(largest_off / largest);
  }
}

std::vector<AnswerError> AnsweredContacts::all_errors(std::size_t level) const {
  return all_errors(level, compressed_.finest());
}

std::vector<AnswerError> AnsweredContacts::all_errors(std::size_t level, std::size_t details) const {
  std::vector<AnswerError> all;
  for (std::size_t site = 0; site < exact_.sites().size(); ++site) {
    const auto errors = site_errors(site, level, details);
    all.insert(all.end(), errors.begin(), errors.end());
  }
  return all;
}

std::vector<PatternErrors> summarise(const std::vector<AnswerError>& errors) {
  std::map<std::pair<layout::PatternKind, std::uint32_t>, std::vector<AnswerError>> groups;
  for (const auto& error : errors) groups[{error.kind, error.contacts}].push_back(error);
  std::vector<PatternErrors> result;
  for (const auto& [key, group] : groups) {
    result.push_back({.kind = key.first,
                      .contacts = key.second,
                      .samples = group.size(),
                      .field = quantiles_of(group, &AnswerError::field),
                      .peak = quantiles_of(group, &AnswerError::peak),
                      .force = quantiles_of(group, &AnswerError::force),
                      .total_force = {}});
    if (layout::has_total_force(key.first)) result.back().total_force = quantiles_of(group, &AnswerError::total_force);
  }
  return result;
}

std::vector<layout::PatternRecord> pattern_records(const std::vector<PatternErrors>& errors) {
  std::vector<layout::PatternRecord> records;
  for (const auto& error : errors) {
    layout::PatternRecord record{};
    record.kind = static_cast<std::uint32_t>(error.kind);
    record.contacts = error.contacts;
    record.samples = static_cast<std::uint32_t>(error.samples);
    store(error.field, record.field_error);
    store(error.peak, record.field_peak);
    store(error.force, record.force_error);
    if (error.total_force) store(*error.total_force, record.total_force_error);
    records.push_back(record);
  }
  return records;
}

}  // namespace greenloop::offline
