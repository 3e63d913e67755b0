#include "rt_tests/harness/recorded_script.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>

#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

const float* position(const ModelView& view, std::uint32_t node) { return node_record(view, node).position; }

}  // namespace

RecordedScript::RecordedScript(const Model& model, const ScriptBounds& bounds, std::uint64_t seed) noexcept
    : model_(&model), bounds_(bounds), state_(seed) {
  visit_nodes(model.view(), [this](std::uint32_t node, const layout::NodeRecord& record) {
    if ((record.flags & layout::node_touchable) == 0) {
      not_touchable_ = node;
    } else if (touchable_ < most_touchable) {
      candidate_[touchable_++].node = node;
    }
  });
}

RecordedScript::Cycle RecordedScript::next() noexcept {
  if (remaining_ == 0) {
    begin_burst();
  }
  --remaining_;
  const float depth = kind_ == Kind::extremes ? extreme_depth() : 0x1p-17F * static_cast<float>(age_ + 1);
  switch (kind_) {
    case Kind::press:
      touch(0, most_contacts, depth);
      break;
    case Kind::slide:
      touch(age_ / 4, most_contacts, depth);
      break;
    case Kind::alternate:
      touch(age_ % 2 == 0 ? 0 : touchable_ / 2, most_contacts / 2, depth);
      break;
    case Kind::scatter:
    case Kind::extremes:
      scatter(1 + below(most_contacts), depth);
      break;
    case Kind::release:
      count_ = 0;
      break;
    case Kind::garbage:
    case Kind::count:
      scatter(1 + below(most_contacts), depth);
      spoil();
      break;
  }
  ++age_;
  const Budget budget = draw_budget();
  const bool with_field = below(4) != 0;
  return {{contact_.data(), count_}, budget, with_field};
}

void RecordedScript::begin_burst() noexcept {
  kind_ = static_cast<Kind>(below(static_cast<std::uint32_t>(Kind::count)));
  const bool brief = kind_ == Kind::release || kind_ == Kind::garbage;
  remaining_ = 1 + below(brief ? 8 : 40);
  age_ = 0;
  sort_by_distance_from(candidate_[below(touchable_)].node);
}

void RecordedScript::sort_by_distance_from(std::uint32_t centre) noexcept {
  const float* from = position(model_->view(), centre);
  const auto end = candidate_.begin() + touchable_;
  for (auto at = candidate_.begin(); at != end; ++at) {
    const float* to = position(model_->view(), at->node);
    at->square_distance = 0;
    for (int r = 0; r < 3; ++r) {
      at->square_distance += (to[r] - from[r]) * (to[r] - from[r]);
    }
  }
  std::sort(candidate_.begin(), end, [](const Candidate& a, const Candidate& b) {
    return a.square_distance != b.square_distance ? a.square_distance < b.square_distance : a.node < b.node;
  });
}

// `count` nodes of the patch from `first` on
void RecordedScript::touch(std::uint32_t first, std::uint32_t count, float depth) noexcept {
  count_ = std::min(count, touchable_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    contact_[i] = {candidate_[(first + i) % touchable_].node, {depth, -depth / 2, depth / 4 * uniform()}};
  }
}

void RecordedScript::scatter(std::uint32_t count, float depth) noexcept {
  count_ = std::min(count, touchable_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    std::swap(candidate_[i], candidate_[i + below(touchable_ - i)]);
    contact_[i].node = candidate_[i].node;
    for (float& component : contact_[i].value) {
      component = depth * uniform();
    }
  }
}

float RecordedScript::extreme_depth() noexcept {
  constexpr std::array<float, 8> depth{0, FLT_TRUE_MIN, FLT_MIN, 0x1p-90F, 0x1p-40F, 1, 0x1p30F, 0x1p100F};
  return depth[below(depth.size())];
}

// makes the contacts wrong in one of the ways a controller can get them wrong
void RecordedScript::spoil() noexcept {
  constexpr std::array<float, 3> bad{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                     -std::numeric_limits<float>::infinity()};
  Constraint& victim = contact_[below(count_)];
  const std::uint32_t way = below(5);
  const std::uint32_t which = below(3);
  switch (way) {
    case 0:
      victim.value[which] = bad[(which + count_) % bad.size()];
      break;
    case 1:
      victim.node = below(2) == 0 ? 0xffffffff : model_->node_count() + below(1000);
      break;
    case 2:
      victim.node = not_touchable_;
      break;
    case 3:
      contact_[count_++] = victim;
      break;
    default:
      while (count_ <= most_contacts) {
        contact_[count_++] = victim;
      }
      break;
  }
}

Budget RecordedScript::draw_budget() noexcept {
  const std::uint64_t least = bounds_.least_work, worst = bounds_.worst_work;
  switch (below(8)) {
    case 0:
      return {least};
    case 1:
      return {below(16) == 0 ? least - 1 : least + 1};
    case 2:
      return {~std::uint64_t{0}};
    case 3:
      return {worst};
    case 4:
      return {least + random() % (worst - least + 1)};
    default:
      return {least + random() % ((worst - least) / 16 + 1)};  // most steps need far less than the worst
  }
}

// SplitMix64 (Steele, Lea & Flood 2014)
std::uint64_t RecordedScript::random() noexcept {
  state_ += 0x9e3779b97f4a7c15;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

std::uint32_t RecordedScript::below(std::uint32_t bound) noexcept {
  return static_cast<std::uint32_t>(random() % bound);
}

float RecordedScript::uniform() noexcept { return static_cast<float>(random() >> 40) * 0x1p-23F - 1; }

}  // namespace greenloop
