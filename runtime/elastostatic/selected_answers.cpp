// What is asked for beside the steps: compliances, and displacements without a field.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/body.hpp"
#include "runtime/elastostatic/loads.hpp"
#include "runtime/stiffness.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// the column of a node of the domain at the finest level
std::uint32_t finest_column(const ModelView& view, std::uint32_t node) {
  return make_column(view.levels - 1, domain_place(view, node));
}

// touches what columns reach, instead of what was touched before, and counts it
SetCounts touch_columns(const Body& body, ColumnSet columns, Touched& touched) {
  clear(touched);
  touch(body.refinement, columns.column, columns.count, touched);
  SetCounts counts;
  counts.columns = columns.count;
  counts.coefficients = touched.coefficients();
  counts.visits = touched.visits;
  counts.stored = count_stored(body.stored, touched);
  return counts;
}

// the forces of the last answer as they are in its field
ColumnForces last_forces(const Body& body, LoadState& state) {
  std::uint32_t count = 0;
  const auto add = [&](const ColumnForces& forces) {
    for (std::uint32_t i = 0; i < forces.count; ++i, ++count) {
      state.asked_column[count] = forces.column[i];
      for (std::size_t r = 0; r < 3; ++r) {
        state.asked_force[std::size_t{3} * count + r] = forces.force[std::size_t{3} * i + r];
      }
    }
  };
  add({body.planned.columns, body.planned.column, body.column_force});
  if (body.is_loaded) {
    add(state.forces.on_columns());
  }
  return {count, state.asked_column, state.asked_force};
}

struct Asked {
  SetCounts moved;
  LoadCounts loads;
};

// touches what forces reach and what columns depend on; returns what both hold
Asked touch_both(Body& body, const ColumnForces& forces, ColumnSet columns, std::uint32_t acting) {
  Asked asked;
  asked.loads.forces = touch_columns(body, {forces.count, forces.column}, body.loads->forces.touched);
  asked.moved = touch_columns(body, columns, body.touched);
  asked.loads.set_stored = asked.moved.stored;
  asked.loads.amounts = acting;
  return asked;
}

bool is_point(const ModelView& view, const MeshPoint& point) {
  bool is = true;
  for (std::size_t k = 0; k < 3; ++k) {
    is = is && point.node[k] < view.node_count && std::isfinite(point.weight[k]);
  }
  return is;
}

// columns of the corners that are in the domain
ColumnSet list_corners(const ModelView& view, std::span<const MeshPoint> points, std::uint32_t* column) {
  std::uint32_t count = 0;
  for (const MeshPoint& point : points) {
    for (const std::uint32_t node : point.node) {
      if (in_domain(view, node)) {
        column[count++] = finest_column(view, node);
      }
    }
  }
  return {count, column};
}

Vec3 displacement_at(const ModelView& view, const MeshPoint& point, const Float4* x) {
  Float4 sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (in_domain(view, point.node[k])) {
      sum = added(sum, scaled(point.weight[k], x[domain_place(view, point.node[k])]));
    }
  }
  return {sum[0], sum[1], sum[2]};
}

bool is_mask(const Body& body, const Mask& mask) {
  bool is = !mask.node.empty() && mask.node.size() == mask.weight.size() &&
            mask.node.size() <= std::size_t{body.counts.max_contacts} + body.counts.max_forces;
  for (std::size_t k = 0; is && k < mask.node.size(); ++k) {
    is = mask.node[k] < body.view->node_count && body.facts[mask.node[k]].touchable && std::isfinite(mask.weight[k]);
  }
  return is;
}

// a newton along an axis, spread by a mask
ColumnForces unit_force(const ModelView& view, const Mask& mask, std::size_t axis, LoadState& state) {
  for (std::size_t k = 0; k < mask.node.size(); ++k) {
    state.asked_column[k] = finest_column(view, mask.node[k]);
    for (std::size_t r = 0; r < 3; ++r) {
      state.asked_force[3 * k + r] = r == axis ? mask.weight[k] : 0;
    }
  }
  return {static_cast<std::uint32_t>(mask.node.size()), state.asked_column, state.asked_force};
}

}  // namespace

bool Elastostatic::compliance(std::uint32_t i, std::uint32_t j, std::span<float, 9> block) const noexcept {
  const Body& body = *body_;
  const ContactSet& set = body.planned;
  if (!body.answered || i >= body.last.contacts() || j >= body.last.contacts() || !set.holds(i) || !set.holds(j)) {
    return false;
  }
  const Factor* const factor = body.cache.find(set.all());
  if (factor == nullptr || factor->capacitance == nullptr) {
    return false;
  }
  kept_block<3>(*factor, body.cache.stride(), set.place[i], set.place[j], block.data());
  for (float& entry : block) {
    entry /= body.stiffness;
  }
  return true;
}

std::uint64_t Elastostatic::displacements(std::span<const MeshPoint> points, std::span<Vec3> displacement) noexcept {
  Body& body = *body_;
  if (!body.answered || points.size() > body.counts.max_points || points.size() != displacement.size()) {
    return 0;
  }
  for (const MeshPoint& point : points) {
    if (!is_point(*body.view, point)) {
      return 0;
    }
  }
  LoadState& state = *body.loads;
  const ColumnForces forces = last_forces(body, state);
  const ColumnSet columns = list_corners(*body.view, points, state.point_column);
  const ActingLoads acting = body.is_loaded ? state.acting() : ActingLoads{};
  const Asked asked = touch_both(body, forces, columns, acting.count);
  const std::uint64_t between = displace(body, forces, acting);
  for (std::size_t i = 0; i < points.size(); ++i) {
    displacement[i] = displacement_at(*body.view, points[i], state.displaced);
  }
  clear_forces<3>(body.touched, state.displaced);
  return ask_work(body.counts, asked.moved, asked.loads) +
         displace_by_loads_work(body.counts, asked.moved, asked.loads, between);
}

std::uint64_t Elastostatic::masked_compliance(std::uint32_t node, const Mask& mask,
                                              std::span<float, 9> block) noexcept {
  Body& body = *body_;
  const ModelView& view = *body.view;
  if (body.counts.max_points == 0 || node >= view.node_count || !in_domain(view, node) || !is_mask(body, mask)) {
    return 0;
  }
  LoadState& state = *body.loads;
  const std::uint32_t column = finest_column(view, node);
  const Asked asked = touch_both(body, unit_force(view, mask, 0, state), {1, &column}, 0);
  std::uint64_t work = ask_work(body.counts, asked.moved, asked.loads);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t between = displace(body, unit_force(view, mask, axis, state), {});
    work += displace_by_loads_work(body.counts, asked.moved, asked.loads, between);
    for (std::size_t r = 0; r < 3; ++r) {
      block[3 * axis + r] = state.displaced[column_place(column)][r];
    }
    clear_forces<3>(body.touched, state.displaced);
  }
  return work;
}

std::uint64_t Elastostatic::stiffness(const MeshPoint& point, std::span<const Mask, 3> masks, float rigid, bool capped,
                                      std::span<float, 9> stiffness) noexcept {
  if (!is_point(*body_->view, point)) {
    return 0;
  }
  float sum[9] = {};
  std::uint64_t work = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (point.weight[k] == 0) {
      continue;
    }
    float of_corner[9];
    if (in_domain(*body_->view, point.node[k])) {
      const std::uint64_t spent = masked_compliance(point.node[k], masks[k], of_corner);
      if (spent == 0 || !invert_compliance(of_corner, of_corner)) {
        return 0;
      }
      work += spent;
    } else {
      write_rigid_stiffness(rigid, of_corner);
    }
    if (capped) {
      cap_stiffness(rigid, of_corner);
    }
    for (std::size_t e = 0; e < 9; ++e) {
      sum[e] += point.weight[k] * of_corner[e];
    }
  }
  std::copy_n(sum, 9, stiffness.begin());
  return work == 0 ? 1 : work;
}

std::uint64_t Elastostatic::local_model(std::span<const ToolPoint> points, std::uint32_t tools,
                                        std::uint32_t components, float length, LocalModel& model) noexcept {
  Body& body = *body_;
  const bool sized =
      tools >= 1 && tools <= LocalModel::most_tools && (components == 3 || components == 6) && length > 0;
  if (!body.pushed || points.size() != body.surfaces || !sized) {
    return 0;
  }
  UnilateralScratch& scratch = body.unilateral;
  for (std::uint32_t i = 0; i < scratch.held; ++i) {
    scratch.point[i] = points[scratch.contact[i]];
    if (scratch.point[i].tool >= tools) {
      return 0;
    }
  }
  const std::uint64_t work =
      scratch.builder.build(scratch.problem, {scratch.point, scratch.held}, tools, components, length, model);
  // what is kept is of the model's own stiffness
  for (std::uint32_t r = 0; r < 6 * tools; ++r) {
    model.wrench[r] *= body.stiffness;
    for (std::uint32_t c = 0; c < components * tools; ++c) {
      model.change[c][r] *= body.stiffness;
    }
  }
  return work;
}

std::uint64_t Elastostatic::local_model_work(std::uint32_t contacts, std::uint32_t tools,
                                             std::uint32_t components) const noexcept {
  return LocalModelBuilder::work(body_->counts.prices, contacts, tools, components);
}

}  // namespace greenloop
