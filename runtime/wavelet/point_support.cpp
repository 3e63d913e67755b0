#include "runtime/wavelet/point_support.hpp"

#include "formats/stored_blocks.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/prediction.hpp"

namespace greenloop {
namespace {

void raise(std::uint32_t& bound, std::uint32_t value) { bound = value > bound ? value : bound; }

bool add_if_stored(const ModelView& view, std::uint32_t node, PointSupport& support) {
  return node == layout::none || !in_domain(view, node) || support.add(node);
}

// what predicts node i of M(level)
bool add_prediction(const ModelView& view, const LevelView& at, std::uint32_t i, PointSupport& coarse) {
  bool fits = true;
  if (at.predictions.weight != nullptr) {
    const std::uint32_t terms = at.predictions.terms;
    for (std::uint32_t k = 0; k < terms; ++k) {
      const std::uint32_t place = stored_source(at.predictions, std::size_t{terms} * i + k);
      fits = fits && coarse.add(domain_node(view, place));
    }
    return fits;
  }
  for (const std::uint32_t parent : at.refinement[i].parent) {
    fits = fits && add_if_stored(view, parent, coarse);
  }
  if (at.stencils != nullptr) {
    for (const std::uint32_t wing : at.stencils[i].wing) {
      fits = fits && add_if_stored(view, wing, coarse);
    }
    for (const std::uint32_t outer : at.stencils[i].outer) {
      fits = fits && add_if_stored(view, outer, coarse);
    }
  }
  return fits;
}

// nodes of M(level) in the support that are lifted into no node: nobody's neighbours
std::uint32_t orphans(const ModelView& view, std::uint32_t level, const PointSupport& support) {
  const LevelView& at = view.level[level];
  std::uint32_t count = 0;
  for (std::uint32_t k = 0; k < support.count(); ++k) {
    if (support.node(k) >= at.node_begin) {
      const float* lift = at.refinement[support.node(k) - at.node_begin].lift;
      count += lift[0] != 0 || lift[1] != 0 ? 0 : 1;
    }
  }
  return count;
}

bool follow(const ModelView& view, std::uint32_t c, std::uint32_t node, const LiftingCounts* lifting,
            ReachBound& bound) {
  PointSupport supports[2] = {PointSupport(most_support(view)), PointSupport(most_support(view))};
  PointSupport* support = supports;
  PointSupport* coarse = supports + 1;
  support->add(node);
  for (std::uint32_t level = c; level > 0; --level) {
    const std::uint32_t alone = orphans(view, level, *support);
    if (!coarsen(view, level, *support, *coarse)) {
      return false;
    }
    PointSupport* const finer = support;
    support = coarse;
    coarse = finer;
    raise(bound.coefficients[level], support->count() * lifting[level].most_neighbours + alone);
  }
  raise(bound.coefficients[0], support->count());
  return true;
}

}  // namespace

bool PointSupport::add(std::uint32_t node) {
  std::uint32_t at = node * 0x9e3779b1U >> 24;  // of 256
  while (slot_[at] != layout::none) {
    if (slot_[at] == node) {
      return true;
    }
    at = (at + 1) % slots;
  }
  if (count_ == limit_) {
    return false;
  }
  slot_[at] = node;
  node_[count_++] = node;
  return true;
}

void PointSupport::clear() {
  count_ = 0;
  for (std::uint32_t& slot : slot_) {
    slot = layout::none;
  }
}

std::uint32_t most_support(const ModelView& view) noexcept {
  const Prediction prediction = prediction_of(view);
  return prediction.blocks || prediction.length > 2 ? PointSupport::most : 3;
}

bool coarsen(const ModelView& view, std::uint32_t level, const PointSupport& support, PointSupport& coarse) noexcept {
  const LevelView& at = view.level[level];
  coarse.clear();
  for (std::uint32_t k = 0; k < support.count(); ++k) {
    const std::uint32_t node = support.node(k);
    const bool fits = node < at.node_begin ? coarse.add(node) : add_prediction(view, at, node - at.node_begin, coarse);
    if (!fits) {
      return false;
    }
  }
  return true;
}

ReachBound bound_reach(const ModelView& view, std::uint32_t c, const LiftingCounts* lifting) noexcept {
  ReachBound bound;
  for (std::uint32_t q = 0; q <= c; ++q) {
    for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
      if (!follow(view, c, view.level[q].node_begin + i, lifting, bound)) {
        return bound;
      }
    }
  }
  bound.bounded = true;
  return bound;
}

}  // namespace greenloop
