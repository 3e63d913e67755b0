#include "rt_tests/harness/dear_sets.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>
#include <utility>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/loaded_driver.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/planner.hpp"
#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop {
namespace {

constexpr int most_starts = 12;
constexpr std::uint64_t most_effort = 20'000'000;  // about: visits and coefficients of the sets of a level

// a body, as the solver keeps it
class OpenBody {
 public:
  OpenBody(const Model& model, const Elastostatic::Limits& limits) {
    BodySizes sizes;
    Elastostatic::Requirement requirement;
    measure_body(model.view(), limits, sizes, requirement);
    if (!sizes.supported) throw std::runtime_error("no body for these limits");
    Arena counting;
    place_body(counting, model.view(), sizes);
    memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory_.data());
    body_ = place_body(arena, model.view(), sizes);
    if (body_ == nullptr) throw std::runtime_error("no body for this model");
  }

  [[nodiscard]] Body& body() const { return *body_; }

 private:
  AlignedBytes memory_;
  Body* body_ = nullptr;
};

// one node for each column of a level
struct Candidate {
  std::uint32_t column;
  std::uint32_t node;
};

class Hunt {
 public:
  Hunt(Body& body, std::uint32_t level, std::size_t contacts, std::uint64_t seed)
      : body_(&body), contacts_(contacts), random_(seed + level) {
    std::map<std::uint32_t, std::uint32_t> nodes;
    for (const std::uint32_t node : touchable_nodes(*body.view)) {
      nodes.emplace(column_of(*body.view, body.facts, node, level), node);
    }
    for (const auto& [column, node] : nodes) candidates_.push_back({column, node});
    size_ = most_ = std::min(contacts, candidates_.size());
  }

  DearSet dearest() {
    order_by_cost();
    DearSet dearest = improved();
    for (int start = 1; start < most_starts && effort_ < most_effort; ++start) {
      std::shuffle(candidates_.begin(), candidates_.end(), random_);
      size_ =
          start % 2 == 0 ? most_ : 1 + random_() % most_;  // fewer may be dearer, by another way of making the factor
      DearSet other = improved();
      if (other.work > dearest.work) dearest = std::move(other);
    }
    return dearest;
  }

 private:
  // planning, a fresh factor, forces and the field
  std::uint64_t work_of(std::vector<std::uint32_t> columns) {
    const ModelCounts& model = body_->counts;
    std::sort(columns.begin(), columns.end());
    clear(body_->touched);
    touch(body_->refinement, columns.data(), static_cast<std::uint32_t>(columns.size()), body_->touched);
    SetCounts set;
    set.contacts = std::max(contacts_ * columns.size() / most_, columns.size());
    set.columns = columns.size();
    count_factor({static_cast<std::uint32_t>(columns.size()), columns.data()}, body_->touched, body_->cost,
                 body_->stored, set);
    effort_ += set.visits + set.coefficients;
    const std::uint32_t finest = model.levels - 1;
    const std::uint64_t field =
        model.forces_only
            ? 0
            : field_work(model, set, {finest, finest}, count_field_blocks(body_->field_blocks, body_->touched, finest));
    return plan_set_work(model, set) + factor_work(model, set) + force_work(model.prices, set) + field;
  }

  void order_by_cost() {
    std::vector<std::pair<std::uint64_t, std::size_t>> cost;
    for (std::size_t i = 0; i < candidates_.size(); ++i) cost.emplace_back(work_of({candidates_[i].column}), i);
    std::sort(cost.rbegin(), cost.rend());
    std::vector<Candidate> ordered;
    ordered.reserve(candidates_.size());
    for (const auto& [work, i] : cost) ordered.push_back(candidates_[i]);
    candidates_ = std::move(ordered);
  }

  [[nodiscard]] std::vector<std::uint32_t> first_columns() const {
    std::vector<std::uint32_t> columns;
    for (std::size_t i = 0; i < size_; ++i) columns.push_back(candidates_[i].column);
    return columns;
  }

  // the set is the first candidates, which change places with others
  DearSet improved() {
    std::uint64_t work = work_of(first_columns());
    const std::uint64_t most = effort_ + most_effort / 2;
    std::size_t vain = size_ < candidates_.size() ? 0 : candidates_.size();
    while (vain < candidates_.size() && effort_ < most) {
      const std::size_t in = random_() % size_;
      const std::size_t out = size_ + random_() % (candidates_.size() - size_);
      std::swap(candidates_[in], candidates_[out]);
      const std::uint64_t changed = work_of(first_columns());
      if (changed > work) {
        work = changed;
        vain = 0;
      } else {
        ++vain;
        std::swap(candidates_[in], candidates_[out]);
      }
    }
    DearSet set;
    for (std::size_t i = 0; i < size_; ++i) set.nodes.push_back(candidates_[i].node);
    set.work = work;
    return set;
  }

  Body* body_;
  std::size_t contacts_;
  std::size_t most_ = 0;
  std::size_t size_ = 0;
  std::vector<Candidate> candidates_;
  std::mt19937_64 random_;
  std::uint64_t effort_ = 0;
};

}  // namespace

template <Driver D>
std::vector<DearSet> dear_sets(const Model& model, const typename D::Solver::Limits& limits, std::uint64_t seed) {
  const OpenBody open(model, limits);
  std::vector<DearSet> sets;
  for (std::uint32_t c = model.view().info->coarsest_constraint_level; c < model.view().levels; ++c) {
    sets.push_back(Hunt(open.body(), c, limits.max_contacts, seed).dearest());
  }
  return sets;
}

template std::vector<DearSet> dear_sets<ElastostaticDriver>(const Model&, const Elastostatic::Limits&, std::uint64_t);
template std::vector<DearSet> dear_sets<LoadedDriver>(const Model&, const Elastostatic::Limits&, std::uint64_t);

}  // namespace greenloop
