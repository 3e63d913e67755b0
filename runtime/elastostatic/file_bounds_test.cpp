// What a file can ask a body for is bounded by its length.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

#include "formats/layout.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/writer.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop {
namespace {

// docs/format.md, "What a file may ask for"
constexpr std::uint64_t most_bytes_per_byte = 2048, most_bytes_else = 1 << 20;

// bytes of the body; 0 if there can be none
std::uint64_t checked_bytes(ModelData data) {
  data.info.max_contacts = 1;
  const std::size_t length = encode(data).size();
  const std::uint64_t domain = data.levels.front().nodes.size() * data.levels.size();
  const std::uint64_t most = layout::contact_pairs_per_byte * length / domain;
  data.info.max_contacts = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(domain <= most ? std::uint64_t{layout::most_contacts} : most, layout::most_contacts));
  const AlignedBytes file(encode(data));
  const auto opened = Model::open(file.span());
  REQUIRE(opened);
  const auto need = Elastostatic::required(opened.model, Elastostatic::intended(opened.model).limits);
  CAPTURE(domain);
  CAPTURE(data.info.max_contacts);
  CAPTURE(length);
  MESSAGE(domain, " nodes, ", data.info.max_contacts, " contacts: ", static_cast<double>(need.bytes) / 1e6,
          " MB of a file of ", static_cast<double>(length) / 1e6, " MB");
  CHECK(need.bytes <= most_bytes_else + most_bytes_per_byte * length);
  return need.bytes;
}

TEST_CASE("the memory of a body is bounded by the length of its file, whatever that asks for") {
  CHECK(checked_bytes(smallest_model()) > 0);
  for (const std::uint32_t nodes : {60, 288, 320, 600, 6000, 20000}) CHECK(checked_bytes(crowded_model(nodes, 1)) > 0);
  for (const std::uint32_t nodes : {12, 100, 1000}) {
    for (const layout::Wavelet wavelet : {layout::Wavelet::lifted_butterfly, layout::Wavelet::lifted_linear}) {
      (void)checked_bytes(crowded_model(nodes, 12, wavelet));
    }
  }
}

}  // namespace
}  // namespace greenloop
