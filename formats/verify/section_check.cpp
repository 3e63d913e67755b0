#include "formats/verify/section_check.hpp"

namespace greenloop {

bool all_zero(std::span<const std::byte> bytes) {
  std::byte any{0};
  for (const std::byte byte : bytes) any |= byte;
  return any == std::byte{0};
}

bool SectionCheck::require_zero(std::uint64_t begin, std::uint64_t end) {
  const std::span gap(section_.data + begin, static_cast<std::size_t>(end - begin));
  return require(all_zero(gap), VerifyRule::padding_not_zero, "padding", begin, 1, 0);
}

}  // namespace greenloop
