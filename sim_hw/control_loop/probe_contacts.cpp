#include "sim_hw/control_loop/probe_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "sim_hw/messages/device_state.hpp"

namespace greenloop {
namespace {

std::vector<std::uint32_t> touchable_nodes(const BodySurface& surface) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < surface.touchable.size(); ++i) {
    if (surface.touchable[i]) nodes.push_back(i);
  }
  return nodes;
}

}  // namespace

ProbeContacts::ProbeContacts(const BodySurface& surface, double radius, std::uint32_t max_contacts)
    : surface_(&surface),
      radius_(radius),
      grid_(surface.position, touchable_nodes(surface), radius),
      pushed_by_(surface.position.size(), nobody),
      candidate_(touchable_nodes(surface).size() * max_tools),
      contact_(max_contacts),
      holder_(max_contacts) {}

std::span<const Constraint> ProbeContacts::find(std::span<const Probe> probes, std::span<const float> field) noexcept {
  candidate_count_ = 0;
  for (std::size_t p = 0; p < probes.size(); ++p) gather(probes[p], static_cast<std::uint8_t>(p), field);
  choose_deepest();
  place(probes);
  return {contact_.data(), count_};
}

void ProbeContacts::gather(const Probe& probe, std::uint8_t number, std::span<const float> field) noexcept {
  const double touching = radius_ * (1 - margin);
  grid_.near(probe.centre, radius_, [&](std::uint32_t node) {
    const Double3 offset = surface_->position[node] - probe.centre;
    const double outside = dot(offset, offset) - radius_ * radius_;
    if (outside >= 0 || -dot(surface_->normal[node], probe.axis) < least_facing) return;
    if (pushed_by_[node] != number) {
      const float* moved = &field[std::size_t{4} * node];
      const Double3 now = offset + Double3{moved[0], moved[1], moved[2]};
      if (dot(now, now) >= touching * touching) return;
    }
    const double along = dot(offset, probe.axis);
    candidate_[candidate_count_++] = {std::sqrt(along * along - outside) - along, node, number};
  });
}

void ProbeContacts::choose_deepest() noexcept {
  Candidate* const begin = candidate_.data();
  Candidate* end = begin + candidate_count_;
  // a node inside both probes belongs to the one that pushes it deeper
  std::sort(begin, end, [](const Candidate& a, const Candidate& b) {
    return a.node != b.node ? a.node < b.node : a.depth != b.depth ? a.depth > b.depth : a.probe < b.probe;
  });
  end = std::unique(begin, end, [](const Candidate& a, const Candidate& b) { return a.node == b.node; });
  count_ = std::min(static_cast<std::size_t>(end - begin), contact_.size());
  if (begin + count_ == end) return;
  std::sort(begin, end, [](const Candidate& a, const Candidate& b) {
    return a.depth != b.depth ? a.depth > b.depth : a.node < b.node;
  });
  std::sort(begin, begin + count_, [](const Candidate& a, const Candidate& b) { return a.node < b.node; });
}

void ProbeContacts::place(std::span<const Probe> probes) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    const Candidate& chosen = candidate_[i];
    const Double3 displacement = chosen.depth * probes[chosen.probe].axis;
    contact_[i] = {
        chosen.node,
        {static_cast<float>(displacement.x), static_cast<float>(displacement.y), static_cast<float>(displacement.z)}};
    holder_[i] = chosen.probe;
  }
}

void ProbeContacts::settle(std::span<const Probe> probes, std::span<const float> force) noexcept {
  std::fill(pushed_by_.begin(), pushed_by_.end(), nobody);
  for (std::size_t i = 0; i < count_; ++i) {
    const Double3 holding{force[3 * i], force[3 * i + 1], force[3 * i + 2]};
    const bool pushed = dot(holding, probes[holder_[i]].axis) >= 0;
    if (pushed) pushed_by_[contact_[i].node] = holder_[i];
  }
}

}  // namespace greenloop
