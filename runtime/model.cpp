#include "runtime/model.hpp"

namespace greenloop {

Model::Opened Model::open(std::span<const std::byte> bytes) noexcept {
  Opened opened;
  opened.result = verify(bytes, opened.model.view_);
  return opened;
}

}  // namespace greenloop
