#include "offline/compress/encode/ready_model.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "formats/write/ready_file.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop::offline {
namespace {

// one that has base columns, some whose coefficients are not all read, and every wavelet
std::vector<std::vector<std::byte>> models(std::uint32_t components) {
  ModelData dense = synthetic_model({.components = components, .levels = 5, .epsilon = 0});
  dense.info.quantum[3] = dense.info.quantum[2];
  std::vector<std::vector<std::byte>> files{encode(dense)};
  for (const layout::Wavelet wavelet : layout::wavelets) {
    files.push_back(encode(synthetic_model({.components = components, .levels = 4, .wavelet = wavelet})));
    files.push_back(
        encode(synthetic_model({.components = components, .levels = 4, .wavelet = wavelet, .read_above = 0.6})));
  }
  return files;
}

// rows and values, layer by layer
template <unsigned N>
void check_equal(const MirroredCouplings& ready, const MirroredCouplings& made, std::uint32_t columns) {
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const CouplingsView &a = ready.layer[layer], &b = made.layer[layer];
    const std::uint32_t blocks = b.begin[columns];
    REQUIRE(block_count(a) == blocks);
    if (blocks == 0) continue;
    CHECK(std::equal(a.begin, a.begin + columns + 1, b.begin));
    CHECK(a.index_bytes == b.index_bytes);
    CHECK(std::memcmp(a.index, b.index, std::size_t{a.index_bytes} * blocks) == 0);
    CHECK(std::memcmp(a.value, b.value, layout::block_bytes(N, layout::value_bits[layer]) * blocks) == 0);
  }
}

TEST_CASE_TEMPLATE("a ready model holds what a loop makes of the plain one", Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const auto& file : models(N)) {
    const TestModel plain(file), ready(ready_model(file));
    const Rooms<N> rooms(plain.view());
    const ReadyTables& tables = ready.view().ready;
    check_equal<N>(tables.mirrored, rooms.mirrored, plain.view().domain_count);
    REQUIRE(tables.base.columns == rooms.base.columns);
    CHECK(std::equal(rooms.base.holds, rooms.base.holds + layout::layers, tables.base.holds));
    const std::size_t bytes = BaseColumns::tile_bytes<N> * rooms.base.tiles * rooms.base.columns;
    CHECK((bytes == 0 || std::memcmp(tables.base.value, rooms.base.value, bytes) == 0));
  }
}

// of steps of a patch that moves over the body
std::uint64_t digest(const TestModel& model, TestBody& body) {
  std::uint64_t hash = empty_hash;
  for (std::size_t first = 0; first < 8; ++first) {
    const auto contacts = patch(model, first, 4);
    for (const std::uint64_t work : {any_budget, body.requirement().least_work}) {
      const auto report = body.step(contacts, work);
      hash = hash_step(hash, report, body.force(), body.field());
    }
  }
  return hash;
}

TEST_CASE("a body of a ready model answers bit for bit like that of the plain one, in less memory") {
  for (const auto& file : models(3)) {
    const TestModel plain(file), ready(ready_model(file));
    const Elastostatic::Limits limits{.max_contacts = 4, .cached_factors = 2};
    TestBody of_plain(plain, limits), of_ready(ready, limits);
    CHECK(digest(plain, of_plain) == digest(ready, of_ready));
    CHECK(of_ready.requirement().least_work == of_plain.requirement().least_work);
    CHECK(std::ranges::equal(of_ready.requirement().worst_work, of_plain.requirement().worst_work));
    std::size_t mirrored = 0;
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      mirrored += static_cast<std::size_t>(block_count(plain.view(), layer, layer + 1)) *
                  layout::block_bytes(3, layout::value_bits[layer]);
    }
    CHECK(of_ready.requirement().bytes + mirrored / 2 < of_plain.requirement().bytes);
  }
}

TEST_CASE("a body is not created of a file whose marks are not those of what is read, unless it has no fields") {
  const TestModel plain(models(3)[2]);
  REQUIRE(plain.view().domain_count > 0);
  const std::vector<std::uint8_t> all(plain.view().domain_count, 1);
  const TestModel other(ready_file(models(3)[2], all));
  REQUIRE(std::memcmp(other.view().ready.read, TestModel(ready_model(models(3)[2])).view().ready.read, all.size()) !=
          0);
  for (const bool forces_only : {false, true}) {
    const Elastostatic::Limits limits{.max_contacts = 4, .forces_only = forces_only};
    const auto need = Elastostatic::required(other.model(), limits);
    REQUIRE(need.bytes > 0);
    AlignedBytes memory(need.bytes);
    const auto created = Elastostatic::create(other.model(), limits, {memory.data(), memory.size()});
    CHECK((created.error == CreateError::unsupported_model) == !forces_only);
    CHECK(static_cast<bool>(created) == forces_only);
  }
}

TEST_CASE("what is no model is not made ready") {
  CHECK_THROWS_AS(static_cast<void>(ready_model({})), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
