// Models through their transport form and back, whole, cut, broken.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/reseal_stream.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/transport/packet.hpp"
#include "formats/transport/stream.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/write/ready_file.hpp"
#include "formats/write/writer.hpp"

namespace greenloop::transport {
namespace {

using Bytes = std::vector<std::byte>;

Bytes unpacked_bytes(std::span<const std::byte> stream, std::uint32_t levels = all_levels) {
  UnpackedModel unpacked;
  const StreamResult result = unpack(stream, unpacked, levels);
  CHECK_MESSAGE(result.ok(), describe(result));
  CHECK(unpacked.levels == std::min<std::uint32_t>(levels, unpacked.stream_levels));
  return unpacked.model;
}

// whole, and every prefix
void check_round_trip(const Bytes& model) {
  const Bytes stream = pack(model);
  CHECK(pack(model) == stream);
  CHECK(unpacked_bytes(stream) == model);
  UnpackedModel whole;
  REQUIRE(unpack(stream, whole).ok());
  for (std::uint32_t levels = 1; levels < whole.levels; ++levels) {
    CAPTURE(levels);
    UnpackedModel prefix;
    const StreamResult result = unpack(stream, prefix, levels);
    Bytes expected;
    try {
      expected = truncate_to_level(model, levels - 1);
    } catch (const std::invalid_argument&) {  // below the coarsest constraint level
      CHECK(result.rule == StreamRule::not_a_model);
      CHECK(prefix.model.empty());
      continue;
    }
    CHECK(result.ok());
    CHECK(prefix.model == expected);
    CHECK(unpacked_bytes(pack(expected)) == expected);
  }
}

TEST_CASE("transport: a model with loads comes back, and all its prefixes") {
  check_round_trip(
      encode(synthetic_model({.levels = 3, .coarsest_constraint_level = 1, .gravity = true, .pressures = 2})));
}

TEST_CASE("transport: a model with a share of the period comes back, and all its prefixes") {
  ModelData data = synthetic_model({.levels = 3});
  data.info.share = 0.4F;
  check_round_trip(encode(data));
}

TEST_CASE("transport: the smallest model and synthetic ones come back, and all their prefixes") {
  check_round_trip(encode(smallest_model()));
  for (std::uint32_t levels = 1; levels <= 4; ++levels) check_round_trip(encode(synthetic_model({.levels = levels})));
  check_round_trip(encode(synthetic_model({.levels = 3, .coarsest_constraint_level = 1})));
  check_round_trip(encode(synthetic_model({.levels = 3, .quantum = 1e-6})));
  for (const layout::Wavelet kind : layout::wavelets) {
    check_round_trip(encode(synthetic_model({.levels = 3, .wavelet = kind, .epsilon = 0, .touchable_above = 0.5})));
  }
}

TEST_CASE("transport: scalar models come back, and all their prefixes, in fewer bytes") {
  check_round_trip(encode(smallest_scalar_model()));
  for (const layout::Wavelet kind : layout::wavelets) {
    for (const double epsilon : {0.0, 0.005}) {
      const Bytes model = encode(synthetic_model(
          {.components = 1, .levels = 4, .coarsest_constraint_level = 1, .wavelet = kind, .epsilon = epsilon}));
      check_round_trip(model);
      CHECK(pack(model).size() < model.size() * 2 / 3);
    }
  }
}

TEST_CASE("transport: random numbers of a scalar model come back, hardly larger than they were") {
  std::mt19937_64 random(1);
  ModelData model = synthetic_model({.components = 1, .levels = 4, .epsilon = 0});
  for (LevelData& level : model.levels) {
    for (float& number : level.scales.numbers) number = 0x1p-20F * static_cast<float>(1 + random() % (1U << 24));
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const std::uint32_t range = (1U << layout::value_bits[layer]) - 1;
      for (std::int16_t& value : level.couplings[layer].value) {
        value = static_cast<std::int16_t>(static_cast<int>(random() % range) - static_cast<int>(range / 2));
      }
    }
  }
  const Bytes bytes = encode(model);
  check_round_trip(bytes);
  CHECK(pack(bytes).size() < bytes.size() * 21 / 20);
}

TEST_CASE("transport: a vertex map comes back") {
  check_round_trip(encode(synthetic_model({.levels = 1, .vertices = 1})));
  check_round_trip(encode(synthetic_model({.levels = 3, .vertices = 500})));
}

TEST_CASE("transport: patterns come back, some levels measured and others not") {
  ModelData model = synthetic_model({.levels = 3, .coarsest_constraint_level = 1});
  model.levels[1].patterns = synthetic_patterns();
  check_round_trip(encode(model));
  model.levels[2].patterns = {model.levels[1].patterns.front()};
  check_round_trip(encode(model));
}

// every number that may be anything is random
ModelData random_model(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ModelData model = synthetic_model({.levels = 3});
  const auto number = [&] { return static_cast<float>(random() % 2000001) / 1000000 - 1; };
  model.provenance = "{\"seed\": " + std::to_string(seed) + "}";
  for (LevelData& level : model.levels) {
    for (auto& node : level.nodes) {
      for (float& coordinate : node.position) coordinate = number();
      node.area = number() + 1;
    }
    for (layout::Scale<3>& scale : level.scales.of<3>()) {
      for (float* matrix : {scale.root, scale.diagonal}) {
        for (std::size_t k : {1, 2, 4}) matrix[k] = number() / 4;
        for (std::size_t k : {0, 3, 5}) matrix[k] = number() / 4 + 1;
      }
    }
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const std::uint32_t range = (1U << layout::value_bits[layer]) - 1;
      const auto largest = static_cast<int>(range / 2);
      for (auto& value : level.couplings[layer].value) {
        value = static_cast<std::int16_t>(static_cast<int>(random() % range) - largest);
      }
    }
  }
  return model;
}

TEST_CASE("transport: random contents come back, hardly larger than they were") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const Bytes model = encode(random_model(seed));
    check_round_trip(model);
    CHECK(pack(model).size() < model.size() * 21 / 20);
  }
}

TEST_CASE("transport: scales of few digits take fewer bytes and come back, as do those with a number that has more") {
  ModelData model = random_model(6);
  const std::size_t random = pack(encode(model)).size();
  std::size_t scales = 0;
  for (LevelData& level : model.levels) {
    scales += level.scales.of<3>().size();
    for (layout::Scale<3>& scale : level.scales.of<3>()) {
      for (float* matrix : {scale.root, scale.diagonal}) {
        for (std::size_t k = 0; k < 6; ++k) matrix[k] = std::round(1024 * matrix[k]) / 1024;
      }
    }
  }
  check_round_trip(encode(model));
  CHECK(pack(encode(model)).size() + 12 * scales < random);  // 8 bits a number
  const auto odd = model.levels[2].scales.of<3>();
  odd[1].root[1] = -0.0F;
  odd[1].diagonal[2] = std::numeric_limits<float>::denorm_min();
  odd[0].diagonal[4] = 1e-30F;
  odd[0].diagonal[0] = 1e30F;
  check_round_trip(encode(model));
}

TEST_CASE(
    "transport: blocks in two layers at once, unknown sections and reserved bytes of a newer minor version come back") {
  ModelData model = synthetic_model({.levels = 3});
  auto& layers = model.levels[2].couplings;
  REQUIRE(!layers[2].index.empty());
  layers[1] = layers[2];
  check_round_trip(encode(model));

  ModelMutant newer(encode(synthetic_model({.levels = 3})));
  newer.rebuild([](std::vector<SectionCopy>& sections) {
    SectionCopy unknown;
    unknown.entry.kind = 77;
    unknown.entry.a = 5;
    unknown.entry.reserved = 0x12345678;
    unknown.bytes.assign(1000, std::byte{42});
    for (const std::size_t place : {std::size_t{1}, sections.size() / 2, sections.size()}) {
      sections.insert(sections.begin() + static_cast<std::ptrdiff_t>(place), unknown);
    }
  });
  newer.header().minor = layout::version_minor + 1;
  newer.header().reserved[3] = 9;
  REQUIRE(newer.verdict().ok());
  check_round_trip({newer.bytes().begin(), newer.bytes().end()});
}

TEST_CASE("transport: what a loop can make of a model is not packed") {
  const Bytes model = encode(synthetic_model({.levels = 3}));
  ModelMutant plain(model);
  REQUIRE(plain.verdict().ok());
  const std::vector<std::uint8_t> read(plain.view().domain_count, 1);
  const Bytes ready = ready_file(model, read);
  REQUIRE(ready.size() > model.size());
  CHECK(pack(ready) == pack(model));
}

TEST_CASE("transport: what is not a model is not packed") {
  CHECK_THROWS_AS(static_cast<void>(pack({})), std::invalid_argument);
  Bytes model = encode(smallest_model());
  model.back() ^= std::byte{1};
  CHECK_THROWS_AS(static_cast<void>(pack(model)), std::invalid_argument);
}

// where each packet ends
std::vector<std::size_t> packet_ends(const Bytes& stream) {
  std::vector<std::size_t> ends;
  for (std::size_t at = sizeof(StreamHeader); at < stream.size();) {
    PacketHeader packet;
    std::memcpy(&packet, stream.data() + at, sizeof(packet));
    at += sizeof(packet) + packet.coded_bytes;
    ends.push_back(at);
  }
  return ends;
}

TEST_CASE("transport: cut at any length, it gives the levels that are whole and says where it ends") {
  const Bytes model = encode(synthetic_model({.levels = 3}));
  const Bytes stream = pack(model);
  const auto ends = packet_ends(stream);
  REQUIRE(ends.size() == 3);
  REQUIRE(ends.back() == stream.size());
  const std::vector<Bytes> prefixes{{}, truncate_to_level(model, 0), truncate_to_level(model, 1)};
  for (std::size_t length = 0; length < stream.size(); ++length) {
    const std::size_t whole = std::upper_bound(ends.begin(), ends.end(), length) - ends.begin();
    // decoding every length takes too long: all near the ends of packets, some elsewhere
    const std::size_t begin = whole == 0 ? 0 : ends[whole - 1];
    if (length - begin > 34 && ends[whole] - length > 2 && length % 499 != 0) continue;
    CAPTURE(length);
    UnpackedModel unpacked;
    const StreamResult result = unpack(std::span(stream).first(length), unpacked);
    CHECK(result.rule == StreamRule::truncated);
    CHECK(result.offset <= length);
    CHECK(unpacked.levels == whole);
    CHECK(unpacked.model == prefixes[whole]);
    if (length >= sizeof(StreamHeader)) CHECK(result.packet == whole);
  }
}

TEST_CASE("transport: cut at every length, a small stream gives nothing") {
  const Bytes stream = pack(encode(smallest_model()));
  for (std::size_t length = 0; length < stream.size(); ++length) {
    CAPTURE(length);
    UnpackedModel unpacked;
    CHECK(unpack(std::span(stream).first(length), unpacked).rule == StreamRule::truncated);
    CHECK(unpacked.model.empty());
  }
}

TEST_CASE("transport: every changed byte is found") {
  const Bytes model = encode(synthetic_model({.levels = 2}));
  const Bytes stream = pack(model);
  std::mt19937_64 random(11);
  for (std::size_t i = 0; i < 1400; ++i) {
    const std::size_t at = i < 1024 ? i : random() % stream.size();
    const auto flip = static_cast<std::byte>(1U << random() % 8);
    CAPTURE(at);
    Bytes broken = stream;
    broken[at] ^= flip;
    UnpackedModel unpacked;
    const StreamResult result = unpack(broken, unpacked);
    CHECK(!result.ok());
    CHECK(result.rule != StreamRule::truncated);
    CHECK(unpacked.model.empty());
    CHECK(describe(result).find(rule_name(result.rule)) != std::string::npos);
  }
}

void check_changes(const Bytes& stream) {
  std::mt19937_64 random(12);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < 300; ++i) {
    Bytes broken = stream;
    const std::size_t changes = 1 + random() % 3;
    for (std::size_t k = 0; k < changes; ++k) {
      const std::size_t at = random() % (i % 2 == 0 ? stream.size() : 2 * sizeof(StreamHeader));
      broken[at] = static_cast<std::byte>(random());
    }
    reseal_stream(broken);
    CAPTURE(i);
    UnpackedModel unpacked;
    const StreamResult result = unpack(broken, unpacked);
    if (!unpacked.model.empty()) {
      CHECK(ModelMutant(unpacked.model).verdict().ok());
    } else {
      ++refused;
      CHECK(!result.ok());
    }
  }
  CHECK(refused > 200);
}

TEST_CASE("transport: changed bytes with checksums made right are refused or give a valid model, soon") {
  check_changes(pack(encode(synthetic_model({.levels = 2}))));
  check_changes(pack(encode(synthetic_model({.components = 1, .levels = 3}))));
}

TEST_CASE("transport: an Info too short to name its problem, as only a hostile stream has it, is read to its end") {
  for (const std::size_t bytes : {0U, 1U, 3U}) {
    std::vector<SectionBytes> sections(1), found;
    sections[0].entry.kind = static_cast<std::uint32_t>(layout::SectionKind::info);
    sections[0].entry.bytes = bytes;
    sections[0].bytes.assign(bytes, std::byte{2});
    const FileExtent extent{0, layout::aligned(std::max<std::size_t>(bytes, 1))};
    if (bytes == 0) sections[0].entry.offset = extent.end;
    RangeEncoder encoder;
    PacketModel().code(encoder, 0, extent, sections, nullptr);
    const Bytes coded = encoder.finish(1);
    RangeDecoder decoder(coded);
    PacketModel().code(decoder, 0, extent, found, nullptr);
    REQUIRE(found.size() == 1);
    CHECK(found[0].bytes == sections[0].bytes);
  }
}

TEST_CASE("transport: predictions from nothing come back; a header without terms bounds no work") {
  ModelData data = synthetic_model({.levels = 3, .wavelet = layout::Wavelet::equilibrated});
  data.levels[1].predictions = {};
  const Bytes model = encode(data);
  UnpackedModel unpacked;
  CHECK(unpack(pack(model), unpacked).ok());
  CHECK(unpacked.model == model);

  layout::PredictionsHeader header{};
  header.nodes = layout::none;
  header.index_bytes = 2;
  header.index_offset = header.weight_offset = sizeof(header);
  CHECK_FALSE(transport::PredictionsModel::fits(std::as_bytes(std::span(&header, 1)), 3));
}

TEST_CASE("transport: each fault by name") {
  const Bytes stream = pack(encode(synthetic_model({.levels = 2})));
  const auto ends = packet_ends(stream);
  const auto check_refused = [&](StreamRule rule, const std::string& field, std::size_t offset, auto&& edit,
                                 bool reseal = true) {
    Bytes broken = stream;
    edit(broken);
    if (reseal) reseal_stream(broken);
    UnpackedModel unpacked;
    const StreamResult result = unpack(broken, unpacked);
    CAPTURE(describe(result));
    CHECK(std::string(rule_name(result.rule)) == rule_name(rule));
    CHECK(result.field == field);
    CHECK(result.offset == offset);
    CHECK(unpacked.model.empty());
  };
  const auto set = [](std::size_t at, auto value) {
    return [=](Bytes& bytes) { std::memcpy(bytes.data() + at, &value, sizeof(value)); };
  };
  constexpr std::size_t first = sizeof(StreamHeader), coded = first + sizeof(PacketHeader);
  check_refused(StreamRule::bad_magic, "magic", 0, set(5, 'P'));
  check_refused(StreamRule::unsupported_version, "major", 8, set(8, std::uint16_t{3}));
  check_refused(StreamRule::unsupported_version, "model_major", 10, set(10, std::uint16_t{99}));
  check_refused(StreamRule::out_of_range, "levels", 14, set(14, std::uint16_t{0}));
  check_refused(StreamRule::out_of_range, "levels", 14, set(14, std::uint16_t{13}));
  check_refused(StreamRule::header_checksum, "header_crc", 60, set(20, '\1'), false);
  check_refused(StreamRule::out_of_range, "content_bytes", first + 16, set(16, std::uint64_t{64}));
  check_refused(StreamRule::out_of_range, "model_bytes", 16, set(16, ~std::uint64_t{63}));
  check_refused(StreamRule::out_of_range, "level", first, set(first, std::uint32_t{1}));
  check_refused(StreamRule::header_checksum, "header_crc", first + 28, set(first + 9, '\1'), false);
  check_refused(StreamRule::out_of_range, "content_bytes", first + 16, set(first + 16, ~std::uint64_t{63}));
  check_refused(StreamRule::out_of_range, "coded_bytes", first + 8, set(first + 8, std::uint64_t{5}));
  check_refused(StreamRule::truncated, "coded_bytes", coded, set(first + 8, std::uint64_t{1} << 60));
  check_refused(StreamRule::packet_checksum, "coded_crc", coded, set(coded + 50, '\1'), false);
  check_refused(StreamRule::content_checksum, "content_crc", coded, set(first + 24, 0));
  check_refused(StreamRule::damaged, "coded bytes", coded,
                [&](Bytes& bytes) { std::fill_n(bytes.begin() + coded, 100, std::byte{0x5a}); });
  check_refused(StreamRule::trailing_bytes, "bytes after the last packet", ends.back(),
                [](Bytes& bytes) { bytes.push_back(std::byte{0}); });
}

}  // namespace
}  // namespace greenloop::transport
