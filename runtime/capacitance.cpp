#include "runtime/capacitance.hpp"

#include <cstddef>

#include "runtime/lu.hpp"

namespace greenloop {
namespace {

Block apply(const PointCoefficient* begin, const PointCoefficient* end, const Block* blocks) {
  Block sum{};
  for (const PointCoefficient* at = begin; at != end; ++at) {
    const Block& block = blocks[at->node];
    const Float4 weight = splat(at->weight);
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

}  // namespace

void assemble_capacitance(const ModelView& view, const Lifting& lifting, const ContactSet& set,
                          CapacitanceScratch& scratch, Float4* a) noexcept {
  const std::size_t stride = lu_padded(3 * set.columns);
  const layout::ColumnRecord* columns = view.level[set.level].columns;
  scratch.begin[0] = 0;
  for (std::uint32_t i = 0; i < set.columns; ++i) {
    PointCoefficient* functional = scratch.coefficients + scratch.begin[i];
    scratch.begin[i + 1] = scratch.begin[i] + point_functional(view, lifting, columns[set.column[i]].node, functional);
  }
  for (std::uint32_t j = 0; j < set.columns; ++j) {
    scatter_column(view, set.level, set.column[j], scratch.blocks);
    float* column = reinterpret_cast<float*>(a) + std::size_t{3} * j * stride;
    for (std::uint32_t i = 0; i < set.columns; ++i) {
      const PointCoefficient* begin = scratch.coefficients + scratch.begin[i];
      const PointCoefficient* end = scratch.coefficients + scratch.begin[i + 1];
      store(apply(begin, end, scratch.blocks), stride, column + std::size_t{3} * i);
    }
    clear_column(view, set.level, set.column[j], scratch.blocks);
  }
}

}  // namespace greenloop
