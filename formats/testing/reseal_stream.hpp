#pragma once

#include <cstddef>
#include <vector>

namespace greenloop::transport {

/// Recomputes the checksums of headers and coded bytes of a `.gloopz`, so that a reader believes them. For tests only.
void reseal_stream(std::vector<std::byte>& stream);

}  // namespace greenloop::transport
