#include "runtime/capacitance.hpp"

#include <cstddef>

#include "runtime/cholesky.hpp"

namespace greenloop {
namespace {

Block times(Float4 factor, const Block& block) {
  return {{factor * block.column[0], factor * block.column[1], factor * block.column[2]}};
}

Block times(const Block& a, const Block& b) {
  Block result;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const Float4 splats[3] = {splat(b.column[c][0]), splat(b.column[c][1]), splat(b.column[c][2])};
    result.column[c] = product(a, splats);
  }
  return result;
}

// the functional of the node at `place` into scratch.coefficients from `begin`; returns its end
std::uint32_t write_functional(const CapacitanceModel& model, std::uint32_t c, std::uint32_t place, std::uint32_t begin,
                               CapacitanceScratch& scratch, Float4* force, PointFunctional& functional) {
  Touched& touched = scratch.touched;
  touch(model.refinement, model.coefficients, c, &place, 1, touched);
  force[place] = splat3(1.0F);
  transform_forces(model.refinement, model.coefficients, touched, force);
  std::uint32_t end = begin;
  for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
    functional.begin[g] = end;
    for (std::uint32_t k = 0; in_capacitance(g, c) && k < touched.count[g]; ++k) {
      const std::uint32_t coefficient = touched.list[g][k];
      scratch.coefficients[end++] = {coefficient, force[coefficient][0]};
    }
  }
  functional.begin[Coefficients::groups] = end;
  clear_forces(touched, force);
  clear(touched);
  return end;
}

// gives every coefficient of the functionals a slot; returns their number
std::uint32_t assign_slots(const Coefficients& coefficients, std::uint32_t columns, CapacitanceScratch& scratch) {
  std::uint32_t slots = 0;
  for (std::uint32_t i = 0; i < columns; ++i) {
    const PointFunctional& functional = scratch.functional[i];
    for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
      const CoefficientGroup& group = coefficients.group[g];
      for (std::uint32_t k = functional.begin[g]; k < functional.begin[g + 1]; ++k) {
        const std::uint32_t coefficient = scratch.coefficients[k].coefficient;
        if (scratch.slot[coefficient] == layout::none) {
          scratch.slot[coefficient] = slots;
          scratch.slotted[slots] = coefficient;
          scratch.root[slots] = root_block(group.scale[coefficient - group.begin]);
          scratch.sum[slots++] = Block{};
        }
      }
    }
  }
  return slots;
}

void add_diagonal(const PointFunctional& functional, CapacitanceScratch& scratch) {
  for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
    for (std::uint32_t k = functional.begin[g]; Coefficients::has_diagonal(g) && k < functional.begin[g + 1]; ++k) {
      const std::uint32_t slot = scratch.slot[scratch.coefficients[k].coefficient];
      const Block own = times(splat(scratch.coefficients[k].weight), scratch.root[slot]);
      for (std::uint32_t c = 0; c < 3; ++c) {
        scratch.sum[slot].column[c] += own.column[c];
      }
    }
  }
}

// sum += couplings of the unit forces that `functional` has in `from`, in the coefficients of `to`
void add_couplings(const CapacitanceModel& model, const CouplingSection& section, bool mirrored,
                   const PointFunctional& functional, CapacitanceScratch& scratch) {
  const std::uint32_t from = mirrored ? section.row_group : section.column_group;
  const std::uint32_t to = mirrored ? section.column_group : section.row_group;
  const std::uint32_t begin = model.coefficients.group[from].begin;
  const std::uint32_t* slot = scratch.slot + model.coefficients.group[to].begin;
  for (std::uint32_t k = functional.begin[from]; k < functional.begin[from + 1]; ++k) {
    const PointCoefficient& at = scratch.coefficients[k];
    const Block force = times(splat(at.weight * section.factor), scratch.root[scratch.slot[at.coefficient]]);
    if (mirrored) {
      add_mirrored(section, at.coefficient - begin, force, slot, scratch.chosen, scratch.sum);
    } else {
      add_direct(section, at.coefficient - begin, force, slot, scratch.chosen, scratch.sum);
    }
  }
}

Block apply(const PointFunctional& functional, const CapacitanceScratch& scratch) {
  Block sum{};
  for (std::uint32_t k = functional.begin[0]; k < functional.begin[Coefficients::groups]; ++k) {
    const Block& block = scratch.sum[scratch.slot[scratch.coefficients[k].coefficient]];
    const Float4 weight = splat(scratch.coefficients[k].weight);
    sum.column[0] += weight * block.column[0];
    sum.column[1] += weight * block.column[1];
    sum.column[2] += weight * block.column[2];
  }
  return sum;
}

// a: top left entry of a 3x3 block in a matrix by columns
void store(const Block& block, std::size_t stride, float* a) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      a[c * stride + r] = block.column[c][r];
    }
  }
}

// sections beyond the constraint level have neither forces nor functionals
bool in_reach(const CouplingSection& section, std::uint32_t c) { return section.column_level <= c; }

}  // namespace

ColumnCost column_cost(const CapacitanceModel& model, std::uint32_t c, std::uint32_t place, Touched& touched) noexcept {
  touch(model.refinement, model.coefficients, c, &place, 1, touched);
  ColumnCost cost;
  cost.visits = static_cast<std::uint32_t>(touched.visits);
  for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
    cost.coefficients += in_capacitance(g, c) ? touched.count[g] : 0;
  }
  for (std::uint32_t s = 0; s < model.couplings.count; ++s) {
    const CouplingSection& section = model.couplings.section[s];
    if (!in_reach(section, c)) {
      continue;
    }
    const std::uint32_t column_begin = model.coefficients.group[section.column_group].begin;
    const std::uint32_t row_begin = model.coefficients.group[section.row_group].begin;
    for (std::uint32_t k = 0; k < touched.count[section.column_group]; ++k) {
      cost.blocks += section.direct_length(touched.list[section.column_group][k] - column_begin);
    }
    for (std::uint32_t k = 0; k < touched.count[section.row_group]; ++k) {
      cost.blocks += section.mirrored_length(touched.list[section.row_group][k] - row_begin);
    }
  }
  clear(touched);
  return cost;
}

void assemble_capacitance(const CapacitanceModel& model, const ContactSet& set, CapacitanceScratch& scratch,
                          Float4* force, Float4* a) noexcept {
  const std::size_t stride = padded_order(3 * set.columns);
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i < set.columns; ++i) {
    end = write_functional(model, set.level, set.column[i], end, scratch, force, scratch.functional[i]);
  }
  const std::uint32_t slots = assign_slots(model.coefficients, set.columns, scratch);
  for (std::uint32_t j = 0; j < set.columns; ++j) {
    const PointFunctional& functional = scratch.functional[j];
    add_diagonal(functional, scratch);
    for (std::uint32_t s = 0; s < model.couplings.count; ++s) {
      const CouplingSection& section = model.couplings.section[s];
      if (in_reach(section, set.level)) {
        add_couplings(model, section, false, functional, scratch);
        add_couplings(model, section, true, functional, scratch);
      }
    }
    for (std::uint32_t k = 0; k < slots; ++k) {
      scratch.sum[k] = times(scratch.root[k], scratch.sum[k]);
    }
    float* column = reinterpret_cast<float*>(a) + std::size_t{3} * j * stride;
    for (std::uint32_t i = j; i < set.columns; ++i) {
      store(apply(scratch.functional[i], scratch), stride, column + std::size_t{3} * i);
    }
    for (std::uint32_t k = 0; k < slots; ++k) {
      scratch.sum[k] = Block{};
    }
  }
  for (std::uint32_t k = 0; k < slots; ++k) {
    scratch.slot[scratch.slotted[k]] = layout::none;
  }
}

}  // namespace greenloop
