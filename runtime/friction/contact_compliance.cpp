#include "runtime/friction/contact_compliance.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace greenloop {
namespace {

bool is_none(const Float4& force) {
  if constexpr (!has_vectors) return force[0] == 0 && force[1] == 0 && force[2] == 0;
  const auto bits = std::bit_cast<std::array<std::uint64_t, 2>>(force);
  return (bits[0] | bits[1]) == 0;
}

void add_product(const Block<3>& block, Float4 force, Float4 (&sum)[3]) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    sum[k] += block.column[k] * force;
  }
}

Float4 sum_of_rows(const Float4 (&even)[3], const Float4 (&odd)[3]) {
  const Block<3> rows = transposed(Block<3>{{even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]}});
  return (rows.column[0] + rows.column[1]) + rows.column[2];
}

}  // namespace

void PushedPoints::add(std::uint32_t i, const Float4& force) noexcept {
  if constexpr (!has_vectors) {
    count_[0] = i + 1;
    return;
  }
  std::uint32_t& count = count_[i % 2];
  point_[i % 2][count] = static_cast<std::uint8_t>(i);
  count += is_none(force) ? 0 : 1;
}

Float4 PushedPoints::gathered(const Block<3>* column, const Float4* force) const noexcept {
  Float4 even[3] = {};
  Float4 odd[3] = {};
  if constexpr (!has_vectors) {
    std::uint32_t i = 0;
    for (; i + 2 <= count_[0]; i += 2) {
      add_product(column[i], force[i], even);
      add_product(column[i + 1], force[i + 1], odd);
    }
    if (i < count_[0]) add_product(column[i], force[i], even);
    return sum_of_rows(even, odd);
  }
  const std::uint32_t both = std::min(count_[0], count_[1]);
  for (std::uint32_t k = 0; k < both; ++k) {
    const std::uint32_t i = point_[0][k];
    const std::uint32_t j = point_[1][k];
    add_product(column[i], force[i], even);
    add_product(column[j], force[j], odd);
  }
  for (std::uint32_t k = both; k < count_[0]; ++k) {
    add_product(column[point_[0][k]], force[point_[0][k]], even);
  }
  for (std::uint32_t k = both; k < count_[1]; ++k) {
    add_product(column[point_[1][k]], force[point_[1][k]], odd);
  }
  return sum_of_rows(even, odd);
}

void scatter(const Block<3>* column, Float4 force, std::uint32_t count, Float4* displacement) noexcept {
  if (is_none(force)) return;
  const Splats<3> of_all = splats(force);
  for (std::uint32_t i = 0; i < count; ++i) {
    displacement[i] += product(column[i], of_all);
  }
}

void multiply(const ContactCompliance& compliance, std::uint32_t count, const Float4* force,
              Float4* displacement) noexcept {
  PushedPoints before;
  for (std::uint32_t j = 0; j < count; ++j) {
    displacement[j] = before.gathered(compliance.column(j), force) + product(compliance.at(j, j), force[j]);
    before.add(j, force[j]);
    scatter(compliance.column(j), force[j], j, displacement);
  }
}

}  // namespace greenloop
