#include "runtime/model.hpp"

#include "runtime/wavelet/domain.hpp"

namespace greenloop {

Model::Opened Model::open(std::span<const std::byte> bytes) noexcept {
  Opened opened;
  opened.result = verify(bytes, opened.model.view_);
  return opened;
}

std::uint32_t Model::node_count(std::uint32_t level) const noexcept { return nodes_up_to(view_, level); }

}  // namespace greenloop
