#include "runtime/friction/contact_compliance.hpp"

namespace greenloop {

Float4 gathered(const Block<3>* column, const Float4* force, std::uint32_t count) noexcept {
  Float4 even[3] = {};
  Float4 odd[3] = {};
  std::uint32_t i = 0;
  for (; i + 2 <= count; i += 2) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      even[k] += column[i].column[k] * force[i];
      odd[k] += column[i + 1].column[k] * force[i + 1];
    }
  }
  if (i < count) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      even[k] += column[i].column[k] * force[i];
    }
  }
  const Block<3> rows = transposed(Block<3>{{even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]}});
  return (rows.column[0] + rows.column[1]) + rows.column[2];
}

void scatter(const Block<3>* column, Float4 force, std::uint32_t count, Float4* displacement) noexcept {
  if (force[0] == 0 && force[1] == 0 && force[2] == 0) {
    return;
  }
  const Splats<3> of_all = splats(force);
  for (std::uint32_t i = 0; i < count; ++i) {
    displacement[i] += product(column[i], of_all);
  }
}

void multiply(const ContactCompliance& compliance, std::uint32_t count, const Float4* force,
              Float4* displacement) noexcept {
  for (std::uint32_t j = 0; j < count; ++j) {
    displacement[j] = gathered(compliance.column(j), force, j) + product(compliance.at(j, j), force[j]);
    scatter(compliance.column(j), force[j], j, displacement);
  }
}

}  // namespace greenloop
