#include "runtime/model.hpp"

#include "runtime/wavelet/domain.hpp"

namespace greenloop {

Model::Opened Model::open(std::span<const std::byte> bytes) noexcept {
  Opened opened;
  opened.result = verify(bytes, opened.model.view_);
  return opened;
}

std::uint32_t Model::node_count(std::uint32_t level) const noexcept { return nodes_up_to(view_, level); }

bool Model::is_touchable(std::uint32_t node) const noexcept {
  return node < view_.node_count && (node_record(view_, node).flags & layout::node_touchable) != 0;
}

Vec3 Model::position(std::uint32_t node) const noexcept {
  const float* const at = node_record(view_, node).position;
  return {at[0], at[1], at[2]};
}

}  // namespace greenloop
