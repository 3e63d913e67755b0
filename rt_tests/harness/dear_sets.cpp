#include "rt_tests/harness/dear_sets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/loaded_driver.hpp"
#include "rt_tests/harness/set_works.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/testing/touchable_nodes.hpp"

namespace greenloop {
namespace {

constexpr int most_starts = 12;
constexpr std::uint64_t most_effort = 2'000'000'000;  // at the finest level, a quarter at the next, and so on
constexpr std::size_t draws = 64;                     // of which the nearest is taken
constexpr std::size_t patience = 4;                   // exchanges of every node in vain

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

// the work that sets of contacts may take of a step: answered at a level, or at the next coarser one by a budget that
// does not hold that, the rest of which goes into the finer factor by slices
class Hunt {
 public:
  Hunt(Body& body, const Model& model, const BlockNeighbours& neighbours, std::uint32_t level, std::uint64_t seed)
      : model_(&model), contacts_(body.counts.max_contacts), random_(seed + level), works_(body, neighbours, level) {
    if (level > model.view().info->coarsest_constraint_level) coarser_.emplace(body, neighbours, level - 1);
    std::map<std::uint32_t, std::uint32_t> nodes;  // one for each column
    for (const std::uint32_t node : touchable_nodes(model.view())) {
      nodes.emplace(column_of(model.view(), body.facts, node, level), node);
    }
    for (const auto& [column, node] : nodes) nodes_.push_back(node);
    most_ = std::min(contacts_, nodes_.size());
    order_by_blocks(body, level);
  }

  // effort: about the coefficients and blocks that are looked at
  DearSet dearest(std::uint64_t effort) {
    DearSet dearest;
    std::uint64_t most_spent = 0;
    for (int start = 0; start < most_starts && this->effort() < effort; ++start) {
      begin(start);
      improve(this->effort() + effort / 4);
      if (found_spent_ > most_spent) {
        most_spent = found_spent_;
        dearest = found_;
      }
    }
    return dearest;
  }

 private:
  [[nodiscard]] std::uint64_t effort() const { return works_.effort() + (coarser_ ? coarser_->effort() : 0); }

  void add(std::uint32_t node) {
    works_.add(node);
    if (coarser_) coarser_->add(node);
  }
  void remove(std::uint32_t node) {
    works_.remove(node);
    if (coarser_) coarser_->remove(node);
  }

  // whether the set may take more work than that; it is what is found then
  bool is_dearer(std::uint64_t spent) {
    const std::uint64_t contacts = std::max(contacts_ * set_.size() / most_, set_.size());
    const NeededWork needed = works_.needed(contacts);
    if (needed.whole <= spent) return false;
    std::uint64_t most = needed.whole - works_.unmet();
    if (coarser_) {
      const std::uint64_t coarser = coarser_->needed(contacts).whole;
      most = std::max(most, std::min(needed.whole, most - needed.field + coarser - coarser_->unmet()));
    }
    if (most <= spent) return false;
    found_ = {set_, needed.whole};
    found_spent_ = most;
    return true;
  }

  void order_by(const std::function<double(std::uint32_t)>& cost) {
    std::vector<std::pair<double, std::uint32_t>> keys;
    for (const std::uint32_t node : nodes_) keys.emplace_back(cost(node), node);
    std::sort(keys.begin(), keys.end());
    std::transform(keys.begin(), keys.end(), nodes_.begin(), [](const auto& key) { return key.second; });
  }

  // those first whose functionals have the most blocks
  void order_by_blocks(const Body& body, std::uint32_t level) {
    order_by([&](std::uint32_t node) {
      const std::uint32_t* const blocks = body.cost.blocks_of(column_of(*body.view, body.facts, node, level));
      return -std::accumulate(blocks, blocks + level + 1, 0.0);
    });
  }

  [[nodiscard]] double distance(std::uint32_t a, std::uint32_t b) const {
    const Vec3 from = model_->position(a);
    const Vec3 to = model_->position(b);
    return std::hypot(to.x - from.x, to.y - from.y, to.z - from.z);
  }

  // the first set: the dearest nodes, nodes side by side, any, or fewer, which may be dearer by another way of making
  // the factor
  void begin(int start) {
    for (const std::uint32_t node : set_) remove(node);
    std::vector<std::uint32_t> ordered = nodes_;
    if (start > 0) std::shuffle(nodes_.begin(), nodes_.end(), random_);
    if (start % 3 == 1) {
      order_by([this, middle = nodes_.front()](std::uint32_t node) { return distance(middle, node); });
    }
    const std::size_t size = start > 0 && start % 3 == 0 ? 1 + random_() % most_ : most_;
    set_.assign(nodes_.begin(), nodes_.begin() + static_cast<std::ptrdiff_t>(size));
    nodes_ = std::move(ordered);
    for (const std::uint32_t node : set_) add(node);
  }

  // the dearer by itself, the more often
  std::uint32_t any_node() {
    const double share = static_cast<double>(random_()) / static_cast<double>(std::mt19937_64::max());
    return nodes_[std::min(static_cast<std::size_t>(share * share * static_cast<double>(nodes_.size())),
                           nodes_.size() - 1)];
  }

  // the nearest of some that are drawn
  std::uint32_t near_node(std::uint32_t node) {
    std::uint32_t near = node;
    double least = HUGE_VAL;
    for (std::size_t drawn = 0; drawn < draws; ++drawn) {
      const std::uint32_t other = nodes_[random_() % nodes_.size()];
      const double away = distance(node, other);
      if (other != node && away < least) {
        near = other;
        least = away;
      }
    }
    return near;
  }

  // nodes are exchanged for others as long as that is found to take more work
  void improve(std::uint64_t effort) {
    is_dearer(found_spent_ = 0);
    std::size_t vain = 0;
    while (vain < patience * nodes_.size() && this->effort() < effort) {
      ++vain;
      std::uint32_t& at = set_[random_() % set_.size()];
      const std::uint32_t out = at;
      const std::uint32_t in = random_() % 2 == 0 ? any_node() : near_node(out);
      if (std::find(set_.begin(), set_.end(), in) != set_.end()) continue;
      exchange(at, in);
      if (is_dearer(found_spent_)) {
        vain = 0;
      } else {
        exchange(at, out);
      }
    }
  }

  void exchange(std::uint32_t& at, std::uint32_t node) {
    remove(at);
    add(node);
    at = node;
  }

  const Model* model_;
  std::size_t contacts_;
  std::mt19937_64 random_;
  SetWorks works_;
  std::optional<SetWorks> coarser_;
  std::vector<std::uint32_t> nodes_;  // one for each column, the dearest first
  std::size_t most_ = 0;
  std::vector<std::uint32_t> set_;
  DearSet found_;
  std::uint64_t found_spent_ = 0;
};

}  // namespace

template <Driver D>
std::vector<DearSet> dear_sets(const Model& model, const typename D::Solver::Limits& limits, std::uint64_t seed) {
  const OpenBody open(model, limits);
  const BlockNeighbours neighbours(model.view());
  std::vector<DearSet> sets;
  std::uint32_t finer = model.view().levels - model.view().info->coarsest_constraint_level;
  for (std::uint32_t c = model.view().info->coarsest_constraint_level; c < model.view().levels; ++c) {
    sets.push_back(Hunt(open.body(), model, neighbours, c, seed).dearest(most_effort >> 2 * --finer));
  }
  return sets;
}

template std::vector<DearSet> dear_sets<ElastostaticDriver>(const Model&, const Elastostatic::Limits&, std::uint64_t);
template std::vector<DearSet> dear_sets<LoadedDriver>(const Model&, const Elastostatic::Limits&, std::uint64_t);

}  // namespace greenloop
