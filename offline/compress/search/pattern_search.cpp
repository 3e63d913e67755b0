#include "offline/compress/search/pattern_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace greenloop::offline {
namespace {

using Sites = std::vector<std::size_t>;

constexpr std::size_t searched_sites = 24;  // the worst ones, added each time all are checked
constexpr int checks = 4;                   // of all sites
constexpr int steps = 8;                    // of the search between two checks
constexpr double near = 1.06;               // thresholds that are not told apart
constexpr double good = 0.95;               // an excess not worth improving

double excess_of(layout::PatternKind kind, double field, double peak, const Accuracy& accuracy) {
  return layout::is_rough(kind) ? field / accuracy.field_rough
                                : std::max(field / accuracy.field, peak / accuracy.field_peak);
}

double excess_of(const PatternErrors& errors, const Accuracy& accuracy) {
  return errors.contacts > most_accurate_contacts
             ? 0
             : excess_of(errors.kind, errors.field.worst, errors.peak.worst, accuracy);
}

ModelFile encoded_at(const TrialBench& bench, double threshold) {
  return encoded_file(encoded_model(bench, encoding_at(threshold)));
}

Sites all_sites(const ExactContacts& contacts) {
  Sites sites(contacts.sites().size());
  std::iota(sites.begin(), sites.end(), std::size_t{0});
  return sites;
}

std::vector<AnswerError> errors_of(const ModelFile& model, const ExactContacts& contacts, const Sites& sites) {
  const CompressedCompliance<3> compressed(model.view);
  const AnsweredContacts answered(model.view, compressed, contacts);
  std::vector<AnswerError> all;
  for (const std::size_t site : sites) {
    const auto errors = answered.site_errors(site, compressed.finest(), compressed.finest());
    all.insert(all.end(), errors.begin(), errors.end());
  }
  return all;
}

class ThresholdSearch {
 public:
  ThresholdSearch(const TrialBench& bench, const ExactContacts& contacts, double floor)
      : bench_(bench), contacts_(contacts), floor_(floor) {}

  // by the errors of all sites; those that were worst join the searched ones
  double check(const std::vector<AnswerError>& errors) {
    std::vector<std::pair<double, std::size_t>> worst;
    auto next = errors.begin();
    for (std::size_t s = 0; s < contacts_.sites().size(); ++s) {
      const auto end = next + static_cast<std::ptrdiff_t>(contacts_.sites()[s].kinds.size());
      worst.emplace_back(-pattern_excess({next, end}, bench_.accuracy), s);
      next = end;
    }
    std::sort(worst.begin(), worst.end());
    for (std::size_t k = 0; k < std::min(searched_sites, worst.size()); ++k) searched_.push_back(worst[k].second);
    std::sort(searched_.begin(), searched_.end());
    searched_.erase(std::unique(searched_.begin(), searched_.end()), searched_.end());
    return worst.empty() ? 0 : -worst.front().first;
  }

  // below `fails`, whose excess is known, with the searched sites; 0 if not even the floor helps
  [[nodiscard]] double descend(double fails, double excess) const {
    double meets = 0;
    for (int step = 0; step < steps && fails > floor_; ++step) {
      const double next =
          meets > 0 ? std::sqrt(fails * meets) : std::max(floor_, fails / std::clamp(near * excess, near, 4.0));
      const double found = pattern_excess(errors_of(encoded_at(bench_, next), contacts_, searched_), bench_.accuracy);
      if (found <= 1) {
        meets = next;
        if (found > good || fails < near * meets) break;
      } else {
        fails = next;
        excess = found;
      }
    }
    return meets;
  }

 private:
  const TrialBench& bench_;
  const ExactContacts& contacts_;
  double floor_;
  Sites searched_;
};

}  // namespace

double pattern_excess(const std::vector<AnswerError>& errors, const Accuracy& accuracy) {
  double excess = 0;
  for (const auto& error : errors) {
    if (error.contacts > most_accurate_contacts) continue;
    excess = std::max(excess, excess_of(error.kind, error.field, error.peak, accuracy));
  }
  return excess;
}

const PatternErrors& worst_pattern(const std::vector<PatternErrors>& errors, const Accuracy& accuracy) {
  return *std::max_element(errors.begin(), errors.end(), [&](const PatternErrors& a, const PatternErrors& b) {
    return excess_of(a, accuracy) < excess_of(b, accuracy);
  });
}

std::vector<AnswerError> answer_errors(const TrialBench& bench, const ExactContacts& contacts,
                                       const Encoding& encoding) {
  return errors_of(encoded_file(encoded_model(bench, encoding)), contacts, all_sites(contacts));
}

std::optional<FoundEncoding> search_threshold(const TrialBench& bench, const ExactContacts& contacts, double threshold,
                                              double floor) {
  ThresholdSearch search(bench, contacts, floor);
  for (int round = 0;; ++round) {
    FoundEncoding found{.encoding = encoding_at(threshold), .model = encoded_at(bench, threshold), .errors = {}};
    found.errors = errors_of(found.model, contacts, all_sites(contacts));
    const double excess = search.check(found.errors);
    if (excess <= 1) return found;
    threshold = round < checks ? search.descend(threshold, excess) : 0;
    if (threshold == 0) return {};
  }
}

}  // namespace greenloop::offline
