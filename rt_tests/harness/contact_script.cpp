#include "rt_tests/harness/contact_script.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>
#include <stdexcept>
#include <utility>

#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t cycles_of_dear_set = 4;
constexpr std::size_t patch_sets = 4;  // disjoint sets that a patch has room for

const float* position(const ModelView& view, std::uint32_t node) { return node_record(view, node).position; }

float square_distance(const float* a, const float* b) {
  float sum = 0;
  for (int r = 0; r < 3; ++r) {
    sum += (a[r] - b[r]) * (a[r] - b[r]);
  }
  return sum;
}

// the generator of a kind's script
std::mt19937_64 generator(ScriptKind kind, std::uint64_t seed) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         static_cast<std::uint32_t>(kind)};
  return std::mt19937_64(sequence);
}

}  // namespace

ContactScript::ContactScript(const ModelView& view, const ScriptBounds& bounds, ScriptKind kind, std::uint64_t seed,
                             std::vector<DearSet> dear)
    : view_(&view), bounds_(bounds), script_(kind), dear_(std::move(dear)), random_(generator(kind, seed)) {
  list_touchable();
  if (touchable_.empty()) {
    throw std::runtime_error(
        "no node of the model's levels is touchable; keep more levels, or name a place in the "
        "scene's [[touched]]");
  }
  shuffled_ = touchable_;
  list_short_edges();
  most_ = std::min<std::size_t>(bounds.contacts, touchable_.size());
}

void ContactScript::list_touchable() {
  visit_nodes(*view_, [this](std::uint32_t node, const layout::NodeRecord& record) {
    if ((record.flags & layout::node_touchable) != 0) {
      touchable_.push_back(node);
    } else {
      not_touchable_ = node;
    }
  });
}

// the halves of edges that have been split
void ContactScript::list_short_edges() {
  const auto is_touchable = [this](std::uint32_t node) {
    return std::binary_search(touchable_.begin(), touchable_.end(), node);
  };
  std::vector<std::pair<float, Pair>> edges;
  for (std::uint32_t q = 1; q < view_->levels; ++q) {
    const LevelView& level = view_->level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      const std::uint32_t odd = level.node_begin + i;
      for (const std::uint32_t parent : level.refinement[i].parent) {
        if (is_touchable(odd) && is_touchable(parent)) {
          edges.push_back({square_distance(level.nodes[i].position, position(*view_, parent)), {odd, parent}});
        }
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& edge : edges) {
    short_edges_.push_back(edge.second);
  }
}

const ScriptedStep& ContactScript::next() {
  if (remaining_ == 0) {
    begin_burst();
  }
  --remaining_;
  step_.valid = true;
  step_.with_field = below(4) != 0;
  place_contacts();
  draw_budget();
  ++age_;
  return step_;
}

void ContactScript::begin_burst() {
  kind_ = script_ == ScriptKind::mixed ? static_cast<ScriptKind>(below(static_cast<std::size_t>(ScriptKind::mixed)))
                                       : script_;
  remaining_ = 1 + static_cast<std::uint32_t>(below(40));
  age_ = 0;
  unlimited_ = below(2) == 0;
  size_ = 1 + below(most_);
  shift_ = 1 + below(size_);
  for (float& component : direction_) {
    component = uniform();
  }
  place_patch();
  if (kind_ == ScriptKind::defeat_cache) {
    draw_sets();
  } else if (kind_ == ScriptKind::every_node) {
    scatter(most_);
  } else if (kind_ == ScriptKind::hunt && !dear_.empty()) {
    // every other time the finest level's
    dear_set_ = below(2) == 0 ? dear_.size() - 1 : below(dear_.size());
    remaining_ = bounds_.sets + cycles_of_dear_set;
  }
}

void ContactScript::place_patch() {
  const float* centre = position(*view_, touchable_[below(touchable_.size())]);
  std::vector<std::pair<float, std::uint32_t>> nearest;
  nearest.reserve(touchable_.size());
  for (const std::uint32_t node : touchable_) {
    nearest.emplace_back(square_distance(position(*view_, node), centre), node);
  }
  const std::size_t count = std::min(nearest.size(), patch_sets * most_);
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count - 1), nearest.end());
  std::sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count));
  patch_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    patch_.push_back(nearest[i].second);
  }
}

// one more than the cache holds: strangers to each other, or each a few nodes from the one before
void ContactScript::draw_sets() {
  const bool strangers = below(2) == 0;
  const std::size_t apart = 1 + below(4);
  sets_.assign(bounds_.sets + std::size_t{1}, {});
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    if (strangers) {
      scatter(size_);
    } else {
      touch(apart * i, size_, 1e-4F);
    }
    sets_[i] = step_.contacts;
  }
  remaining_ = static_cast<std::uint32_t>(3 * sets_.size());
}

void ContactScript::place_contacts() {
  const float depth = 1e-5F * static_cast<float>(age_ + 1);
  switch (kind_) {
    case ScriptKind::single:
      touch(age_ % 2, 1, depth);
      break;
    case ScriptKind::press:
      touch(0, size_, depth);
      break;
    case ScriptKind::slide:
      touch(age_, size_, depth);
      break;
    case ScriptKind::neighbours:
      touch(age_ % 2 == 0 ? 0 : shift_, size_, depth);
      break;
    case ScriptKind::coincident:
      touch_pairs(1 + below(std::max<std::size_t>(most_ / 2, 1)));
      break;
    case ScriptKind::random:
      scatter(1 + below(most_));
      break;
    case ScriptKind::defeat_cache:
      step_.contacts = sets_[age_ % sets_.size()];
      break;
    case ScriptKind::every_node:
      step_.contacts[below(most_)].value[below(3)] = depth;
      break;
    case ScriptKind::flap_levels:
      // a set that is at hand is answered at the finest level for any budget: every other time they come in pairs
      touch(unlimited_ ? age_ / 2 : 0, size_, 1e-4F);
      break;
    case ScriptKind::extremes:
      scatter(1 + below(most_));
      displace_extremely();
      break;
    case ScriptKind::release:
      step_.contacts.clear();
      break;
    case ScriptKind::hunt:
      touch_dear_set();
      break;
    case ScriptKind::garbage:
    case ScriptKind::mixed:  // is never the kind of a burst
      scatter(1 + below(most_));
      spoil();
      break;
  }
}

// `count` nodes of the patch from `first` on
void ContactScript::touch(std::size_t first, std::size_t count, float depth) {
  step_.contacts.clear();
  for (std::size_t i = 0; i < std::min(count, patch_.size()); ++i) {
    Constraint contact{patch_[(first + i) % patch_.size()], {}};
    for (int r = 0; r < 3; ++r) {
      contact.value[r] = depth * direction_[r];
    }
    step_.contacts.push_back(contact);
  }
}

// the ends of short edges, without common nodes, moved against each other
void ContactScript::touch_pairs(std::size_t count) {
  step_.contacts.clear();
  const std::size_t first = below(1 + short_edges_.size() / 16);
  const auto is_held = [this](std::uint32_t node) {
    return std::any_of(step_.contacts.begin(), step_.contacts.end(), [node](auto& at) { return at.node == node; });
  };
  for (std::size_t i = first; i < short_edges_.size() && step_.contacts.size() + 2 <= std::min(2 * count, most_); ++i) {
    const auto& [a, b] = short_edges_[i];
    if (!is_held(a) && !is_held(b)) {
      const float depth = 1e-4F * uniform();
      step_.contacts.push_back({a, {depth, depth, -depth}});
      step_.contacts.push_back({b, {-depth, -depth, depth}});
    }
  }
}

// distinct nodes from anywhere
void ContactScript::scatter(std::size_t count) {
  step_.contacts.clear();
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(shuffled_[i], shuffled_[i + below(shuffled_.size() - i)]);
    step_.contacts.push_back({shuffled_[i], {1e-4F * uniform(), 1e-4F * uniform(), 1e-4F * uniform()}});
  }
}

// after strangers, so that no factor is at hand
void ContactScript::touch_dear_set() {
  step_.with_field = true;
  if (dear_.empty()) {
    scatter(most_);
    return;
  }
  const std::vector<std::uint32_t>& dear = dear_[dear_set_].nodes;
  if (age_ < bounds_.sets) {
    do {
      scatter(1);
    } while (dear.size() < touchable_.size() &&
             std::find(dear.begin(), dear.end(), step_.contacts[0].node) != dear.end());
    return;
  }
  step_.contacts.clear();
  for (const std::uint32_t node : dear) {
    step_.contacts.push_back({node, {1e-4F * uniform(), 1e-4F * uniform(), 1e-4F * uniform()}});
  }
}

void ContactScript::displace_extremely() {
  constexpr float sizes[] = {0, FLT_TRUE_MIN, FLT_MIN, 1e-30F, 1e-12F, 1, 1e10F};
  const float size = sizes[below(std::size(sizes))];
  for (Constraint& contact : step_.contacts) {
    for (float& u : contact.value) {
      u = size * uniform();
    }
  }
}

// makes the contacts wrong in one of the ways a controller can get them wrong
void ContactScript::spoil() {
  step_.valid = false;
  Constraint& victim = step_.contacts[below(step_.contacts.size())];
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(), FLT_MAX, -FLT_MAX};
  switch (below(6)) {
    case 0:
      victim.value[below(3)] = bad[below(std::size(bad))];
      break;
    case 1:
      victim.node = view_->node_count + static_cast<std::uint32_t>(below(0x80000000 - view_->node_count));
      break;
    case 2:
      victim.node = static_cast<std::uint32_t>(random_() | 0xffff0000);
      break;
    case 3:
      victim.node = not_touchable_;
      break;
    case 4:
      step_.contacts.push_back(victim);
      break;
    default:
      step_.contacts.resize(bounds_.contacts + 1 + below(4), victim);
      break;
  }
}

void ContactScript::draw_budget() {
  const std::uint64_t least = bounds_.least_work;
  const std::uint64_t span = bounds_.worst_work > least ? bounds_.worst_work - least : 1;
  if (kind_ == ScriptKind::flap_levels) {
    step_.budget = age_ % 2 == 0 ? least : ~std::uint64_t{0};
    return;
  }
  if (unlimited_ || (kind_ == ScriptKind::hunt && (dear_.empty() || age_ < bounds_.sets))) {
    step_.budget = ~std::uint64_t{0};
    return;
  }
  if (kind_ == ScriptKind::hunt) {
    // the budget of the level's answer or of one at a finer level, and such as do not quite hold one
    const std::uint64_t works[] = {least, dear_[dear_set_].work, dear_.back().work, ~std::uint64_t{0}};
    const std::uint64_t work = works[below(std::size(works))];
    step_.budget = std::max(least, work - below(2) * below(work / 4));
    return;
  }
  switch (below(8)) {
    case 0:
      step_.budget = least;
      break;
    case 1:
      step_.budget = below(16) == 0 ? random_() % least : least + 1;
      break;
    case 2:
      step_.budget = bounds_.worst_work;
      break;
    case 3:
      step_.budget = least + random_() % span;
      break;
    default:
      // most steps of a loop need far less than the worst
      step_.budget = least + random_() % (span / 16 + 1);
      break;
  }
}

}  // namespace greenloop
