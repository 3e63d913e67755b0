#include "formats/write/impulse_response.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <stdexcept>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/writer.hpp"

namespace greenloop {
namespace {

// value v of mode m of a group, read back from its planes
std::int32_t stored(const ImpulseResponseView& view, std::uint32_t q, std::uint32_t v, std::uint32_t m) {
  const std::uint32_t pairs = view.group[q].counts->modes / 2;
  const std::size_t at =
      2 * ((std::size_t{v} / layout::block_values * pairs + m / 2) * layout::block_values + v % layout::block_values) +
      m % 2;
  const std::int32_t first = view.group[q].plane[0][at];
  return view.info->planes == 1 ? first : 256 * first + view.group[q].plane[1][at];
}

TEST_CASE("an impulse response model is written and read back as it was, with values of 8 and of 16 bits") {
  for (const std::uint32_t planes : {1U, 2U}) {
    const ImpulseResponseData data = synthetic_motion({.planes = planes});
    const ModelFile file = encoded_file(data);
    const ImpulseResponseView& view = file.view.impulse_response;
    CHECK(file.view.problem == layout::Problem::impulse_response);
    CHECK(file.view.info == nullptr);
    CHECK(file.view.header->minor == 7);
    REQUIRE(view.levels == 2);
    CHECK(view.modes == 6);
    CHECK(view.info->vertices == 100);
    CHECK(view.info->orbits == 10);
    CHECK(view.orbits.size() == 10);
    CHECK(view.impulses.size() == 3);
    CHECK(std::memcmp(view.references, data.references.data(),
                      data.references.size() * sizeof(layout::ReferenceRecord)) == 0);
    for (std::uint32_t q = 0; q < 2; ++q) {
      const std::uint32_t modes = view.group[q].counts->modes;
      CHECK(std::memcmp(view.group[q].coordinates, data.groups[q].coordinates.data(),
                        data.groups[q].coordinates.size() * 2) == 0);
      std::uint32_t different = 0;
      for (std::uint32_t v = 0; v < 300; ++v) {
        for (std::uint32_t m = 0; m < modes; ++m) {
          different += stored(view, q, v, m) == data.groups[q].values[v * modes + m] ? 0 : 1;
        }
      }
      CHECK(different == 0);
    }
    CHECK(encoded_file(data).bytes.size() == file.bytes.size());
    CHECK(std::memcmp(encoded_file(data).bytes.data(), file.bytes.data(), file.bytes.size()) == 0);
  }
}

TEST_CASE("what does not fit is refused by name") {
  const auto refused = [](auto change, const char* name) {
    ImpulseResponseData data = synthetic_motion({});
    change(data);
    try {
      static_cast<void>(encoded_file(data));
      FAIL("not refused: ", name);
    } catch (const std::invalid_argument& error) {
      CHECK_MESSAGE(std::string(error.what()).find(name) != std::string::npos, error.what());
    }
  };
  refused([](auto& data) { data.groups.clear(); }, "groups of modes");
  refused([](auto& data) { data.groups[1].values.pop_back(); }, "groups[1].values");
  refused([](auto& data) { data.groups[0].values[7] = 128; }, "groups[0].values[7] = 128");
  refused([](auto& data) { data.groups[0].coordinates.pop_back(); }, "groups[0].coordinates");
  refused([](auto& data) { data.groups[0].amplitudes.pop_back(); }, "even number");
  refused([](auto& data) { data.references.pop_back(); }, "references");
  refused([](auto& data) { data.successions.push_back(1); }, "successions");
  refused([](auto& data) { data.info.planes = 3; }, "info.planes");
  refused([](auto& data) { data.orbits[3].impulse = 9; }, "impulse");
  refused([](auto& data) { data.appearance.coordinates.push_back(0); }, "appearance.coordinates");
  refused([](auto& data) { data.appearance.amplitudes.push_back({1, 0}); }, "appearance.quanta");
}

TEST_CASE("a model is cut after a level: fewer modes, the same orbits") {
  const auto whole = encode(synthetic_motion({.modes = 8, .groups = 4, .transfer_modes = 3}));
  const auto cut = truncate_to_level(whole, 1);
  const ModelFile file = verified_model(AlignedBytes(cut), "cut");
  CHECK(cut.size() < whole.size());
  CHECK(file.view.impulse_response.levels == 2);
  CHECK(file.view.impulse_response.modes == 4);
  CHECK(file.view.impulse_response.appearance.modes == 0);
  CHECK(truncate_to_level(whole, 3) == whole);
  CHECK(file.view.impulse_response.info->modes == 8);
  CHECK(file.view.impulse_response.orbits.size() == 10);
  CHECK_THROWS_AS(static_cast<void>(truncate_to_level(whole, 4)), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop
