#include "rt_tests/stress/contact_script.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>

#include "runtime/domain.hpp"

namespace greenloop {
namespace {

const layout::NodeRecord& record(const ModelView& view, std::uint32_t node) {
  const LevelView& level = view.level[level_of(view, node)];
  return level.nodes[node - level.node_begin];
}

float square_distance(const float* a, const float* b) {
  float sum = 0;
  for (int r = 0; r < 3; ++r) {
    sum += (a[r] - b[r]) * (a[r] - b[r]);
  }
  return sum;
}

}  // namespace

ContactScript::ContactScript(const ModelView& view, const Limits& limits, const Requirement& requirement,
                             std::uint64_t seed)
    : view_(&view), max_contacts_(limits.max_contacts), requirement_(requirement), random_(seed) {
  worst_work_ = *std::max_element(std::begin(requirement.worst_work), std::end(requirement.worst_work));
  for (std::uint32_t node = 0; node < view.node_count; ++node) {
    if ((record(view, node).flags & layout::node_touchable) != 0) {
      touchable_.push_back(node);
    }
  }
}

const ScriptedStep& ContactScript::next() {
  if (remaining_ == 0) {
    begin_burst();
  }
  --remaining_;
  step_.valid = true;
  step_.smooth = kind_ == Kind::press && age_ > 0;
  const std::size_t most = std::min<std::size_t>(max_contacts_, touchable_.size());
  switch (kind_) {
    case Kind::press:
      touch(0, 1 + most / 4);
      break;
    case Kind::slide:
      touch(age_, std::min<std::size_t>(most, 9));
      break;
    case Kind::scattered:
      scatter(most);
      break;
    case Kind::alternate:
      touch(age_ % 2 == 0 ? 0 : nearest_.size() / 2, 1 + most / 2);
      break;
    case Kind::thrash:
    case Kind::extremes:
      scatter(1 + below(most));
      break;
    case Kind::release:
      step_.contacts.clear();
      break;
    case Kind::garbage:
    case Kind::count:
      scatter(1 + below(most));
      spoil();
      break;
  }
  if (kind_ == Kind::extremes) {
    constexpr float sizes[] = {0, FLT_TRUE_MIN, FLT_MIN, 1e-30F, 1e-12F, 1, 1e10F};
    const float size = sizes[below(std::size(sizes))];
    for (Contact& contact : step_.contacts) {
      for (float& u : contact.displacement) {
        u = size * uniform();
      }
    }
  }
  draw_budget();
  ++age_;
  return step_;
}

void ContactScript::begin_burst() {
  kind_ = static_cast<Kind>(below(static_cast<std::size_t>(Kind::count)));
  remaining_ = 1 + static_cast<std::uint32_t>(below(40));
  age_ = 0;
  for (float& component : direction_) {
    component = uniform();
  }
  place_patch();
}

void ContactScript::place_patch() {
  nearest_ = touchable_;
  const float* centre = record(*view_, touchable_[below(touchable_.size())]).position;
  std::stable_sort(nearest_.begin(), nearest_.end(), [this, centre](std::uint32_t a, std::uint32_t b) {
    return square_distance(record(*view_, a).position, centre) < square_distance(record(*view_, b).position, centre);
  });
}

// `count` nodes of the patch from `first` on, pressed the deeper the older the burst
void ContactScript::touch(std::size_t first, std::size_t count) {
  step_.contacts.clear();
  const float depth = 1e-5F * static_cast<float>(age_ + 1);
  for (std::size_t i = 0; i < std::min(count, nearest_.size()); ++i) {
    Contact contact{nearest_[(first + i) % nearest_.size()], {}};
    for (int r = 0; r < 3; ++r) {
      contact.displacement[r] = depth * direction_[r];
    }
    step_.contacts.push_back(contact);
  }
}

void ContactScript::scatter(std::size_t count) {
  step_.contacts.clear();
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(nearest_[i], nearest_[i + below(nearest_.size() - i)]);
    step_.contacts.push_back({nearest_[i], {1e-4F * uniform(), 1e-4F * uniform(), 1e-4F * uniform()}});
  }
}

// makes the contacts wrong in one of the ways a controller can get them wrong
void ContactScript::spoil() {
  step_.valid = false;
  Contact& victim = step_.contacts[below(step_.contacts.size())];
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(), FLT_MAX, -FLT_MAX};
  switch (below(5)) {
    case 0:
      victim.displacement[below(3)] = bad[below(std::size(bad))];
      break;
    case 1:
      victim.node = view_->node_count + static_cast<std::uint32_t>(below(0x80000000 - view_->node_count));
      break;
    case 2:
      victim.node = static_cast<std::uint32_t>(random_() | 0xffff0000);
      break;
    case 3:
      step_.contacts.push_back(victim);
      break;
    default:
      step_.contacts.resize(max_contacts_ + 1 + below(4), victim);
      break;
  }
}

void ContactScript::draw_budget() {
  const std::uint64_t least = requirement_.least_work;
  const std::uint64_t span = worst_work_ > least ? worst_work_ - least : 1;
  switch (below(8)) {
    case 0:
      step_.budget = least;
      break;
    case 1:
      step_.budget = below(16) == 0 ? random_() % least : least + 1;
      break;
    case 2:
      step_.budget = ~std::uint64_t{0};
      break;
    case 3:
      step_.budget = worst_work_;
      break;
    case 4:
      step_.budget = least + random_() % span;
      break;
    default:
      // most steps of a loop need far less than the worst
      step_.budget = least + random_() % (span / 16 + 1);
      break;
  }
  step_.with_field = below(4) != 0;
}

}  // namespace greenloop
