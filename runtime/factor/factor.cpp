#include "runtime/factor/factor.hpp"

#include <cstddef>
#include <cstring>

#include "runtime/algebra/cholesky.hpp"

namespace greenloop {

namespace {

// Lower triangles of matrices by columns, `stride` floats apart.

void copy_lower(std::uint32_t order, std::uint32_t stride, const float* from, float* to) {
  for (std::size_t j = 0; j < order; ++j) {
    std::memcpy(to + j * stride + j, from + j * stride + j, sizeof(float) * (order - j));
  }
}

void remove_rows(std::uint32_t order, std::uint32_t first, std::uint32_t removed, std::uint32_t stride, float* a) {
  const std::size_t end = std::size_t{first} + removed;
  for (std::size_t j = 0; j < first; ++j) {
    std::memmove(a + j * stride + first, a + j * stride + end, sizeof(float) * (order - end));
  }
  for (std::size_t j = end; j < order; ++j) {
    const std::size_t to = j - removed;
    std::memmove(a + to * stride + to, a + j * stride + j, sizeof(float) * (order - j));
  }
}

// rows: `stride` floats apart, up to the diagonal
void append_rows(std::uint32_t order, std::uint32_t added, std::uint32_t stride, const float* rows, float* a) {
  for (std::size_t r = 0; r < added; ++r) {
    for (std::size_t j = 0; j <= order + r; ++j) {
      a[j * stride + order + r] = rows[r * stride + j];
    }
  }
}

}  // namespace

template <unsigned N>
void Factor::carve(Arena& arena, std::uint32_t columns_of_a_set, bool keeps_capacitance) noexcept {
  const std::uint64_t stride = padded_order(N * columns_of_a_set);
  column = arena.take<std::uint32_t>(columns_of_a_set);
  node = arena.take<std::uint32_t>(columns_of_a_set);
  position = arena.take<std::uint32_t>(columns_of_a_set);
  matrix = arena.take<Float4>(stride * stride / 4);
  capacitance = keeps_capacitance ? arena.take<float>(stride * stride) : nullptr;
}

template <unsigned N>
void keep_capacitance(std::uint32_t columns, std::uint32_t stride, Factor& factor) noexcept {
  if (factor.capacitance != nullptr) {
    copy_lower(N * columns, stride, reinterpret_cast<const float*>(factor.matrix), factor.capacitance);
  }
}

template <unsigned N>
void copy_factor(const Factor& from, std::uint32_t stride, Factor& to) noexcept {
  const std::uint32_t order = padded_order(N * from.columns);
  for (std::uint32_t j = 0; j < order; ++j) {
    const std::size_t begin = std::size_t{j} * stride / 4 + j / 4;
    std::memcpy(to.matrix + begin, from.matrix + begin, sizeof(Float4) * (order / 4 - j / 4));
  }
  if (from.capacitance != nullptr) {
    copy_lower(N * from.columns, stride, from.capacitance, to.capacitance);
  }
  std::memcpy(to.node, from.node, sizeof(std::uint32_t) * from.columns);
  to.columns = from.columns;
  to.changes = from.changes;
}

template <unsigned N>
std::uint32_t remove_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept {
  std::uint32_t at = 0;
  while (factor.node[at] != node) {
    ++at;
  }
  cholesky_remove(N * factor.columns, N * at, N, stride, factor.matrix, border);
  if (factor.capacitance != nullptr) {
    remove_rows(N * factor.columns, N * at, N, stride, factor.capacitance);
  }
  --factor.columns;
  std::memmove(factor.node + at, factor.node + at + 1, sizeof(std::uint32_t) * (factor.columns - at));
  return at;
}

template <unsigned N>
bool append_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept {
  if (factor.capacitance != nullptr) {
    append_rows(N * factor.columns, N, stride, reinterpret_cast<const float*>(border), factor.capacitance);
  }
  if (!cholesky_append(N * factor.columns, N, stride, factor.matrix, border)) {
    return false;
  }
  factor.node[factor.columns++] = node;
  return true;
}

void list_positions(ColumnSet set, std::uint32_t* index_of_place, Factor& factor) noexcept {
  for (std::uint32_t i = 0; i < factor.columns; ++i) {
    index_of_place[column_place(factor.node[i])] = i;
  }
  for (std::uint32_t k = 0; k < set.count; ++k) {
    std::uint32_t& index = index_of_place[column_place(set.column[k])];
    factor.position[k] = index;
    index = layout::none;
  }
}

template void Factor::carve<1>(Arena&, std::uint32_t, bool) noexcept;
template void keep_capacitance<1>(std::uint32_t, std::uint32_t, Factor&) noexcept;
template void copy_factor<1>(const Factor&, std::uint32_t, Factor&) noexcept;
template std::uint32_t remove_node<1>(std::uint32_t, std::uint32_t, Factor&, Float4*) noexcept;
template bool append_node<1>(std::uint32_t, std::uint32_t, Factor&, Float4*) noexcept;
template void Factor::carve<3>(Arena&, std::uint32_t, bool) noexcept;
template void keep_capacitance<3>(std::uint32_t, std::uint32_t, Factor&) noexcept;
template void copy_factor<3>(const Factor&, std::uint32_t, Factor&) noexcept;
template std::uint32_t remove_node<3>(std::uint32_t, std::uint32_t, Factor&, Float4*) noexcept;
template bool append_node<3>(std::uint32_t, std::uint32_t, Factor&, Float4*) noexcept;

}  // namespace greenloop
