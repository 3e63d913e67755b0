// The same steps give the same bits on every compiler and instruction set: this file is compiled with the runtime's
// sources several times, and every program must find the same hash.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/test_body.hpp"

#if defined(GREENLOOP_EXPECT_AVX2) && !defined(__AVX2__)
#error "this program is meant to be compiled for AVX2"
#endif
#if defined(GREENLOOP_EXPECT_AVX512) && !defined(__AVX512F__)
#error "this program is meant to be compiled for AVX-512"
#endif
#if defined(GREENLOOP_EXPECT_NO_OPTIMISATION) && defined(__OPTIMIZE__)
#error "this program is meant to be compiled without optimisation"
#endif

namespace greenloop {
namespace {

constexpr std::uint64_t golden = 7299101951166938192U;

bool processor_runs_this() {
#if defined(GREENLOOP_EXPECT_AVX512)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
#elif defined(GREENLOOP_EXPECT_AVX2)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

void fill_blocks(std::mt19937_64& random, std::size_t columns, std::size_t rows, bool every_row, float scale,
                 BlocksData& blocks) {
  blocks.dense = every_row;
  blocks.begin = {0};
  blocks.scale.clear();
  blocks.index.clear();
  blocks.value.clear();
  const int most = blocks.value_bytes == 1 ? 127 : 32767;
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::uint32_t i = 0; i < rows; ++i) {
      if (!every_row && random() % 4 != 0) {
        continue;
      }
      if (!every_row) {
        blocks.index.push_back(i);
      }
      for (int k = 0; k < 9; ++k) {
        blocks.value.push_back(static_cast<std::int16_t>(static_cast<int>(random() % (2U * most + 1)) - most));
      }
    }
    blocks.begin.push_back(static_cast<std::uint32_t>(blocks.value.size() / 9));
    blocks.scale.push_back(scale * (1 + static_cast<float>(random() >> 40) * 0x1p-24F));
  }
}

// the synthetic sphere's mesh with arbitrary numbers on it: bits that no mathematical library has a part in
ModelData arbitrary_model() {
  std::mt19937_64 random(20);
  ModelData data = synthetic_model({.levels = 4, .touchable_above = 0.2});
  for (std::size_t c = 0; c < data.levels.size(); ++c) {
    LevelData& level = data.levels[c];
    for (layout::RefinementRecord& record : level.refinement) {
      for (float& lift : record.lift) {
        lift = lift == 0 ? 0 : static_cast<float>(random() >> 40) * 0x1p-26F;
      }
    }
    for (std::size_t r = 0; r < level.blocks.size(); ++r) {
      std::size_t rows = 0;
      for (const layout::NodeRecord& node : data.levels[r].nodes) {
        rows += (node.flags & layout::node_domain) != 0 ? 1 : 0;
      }
      level.blocks[r].value_bytes = (c + r) % 3 == 0 ? 2 : 1;
      const float scale = std::ldexp(1.0F, -12 - 2 * static_cast<int>(r) - (level.blocks[r].value_bytes == 2 ? 8 : 0));
      fill_blocks(random, level.columns.size(), rows, r == 0, scale, level.blocks[r]);
    }
    level.counts.worst_column_error = 0.5F;
    level.counts.rms_error = 0.25F;
  }
  return data;
}

struct Outcome {
  std::uint64_t hash = empty_hash;
  int answered = 0;
  std::uint32_t levels = 0;  // bit c: answered at level c
};

Outcome run_script(const TestModel& model) {
  std::mt19937_64 random(21);
  TestBody body(model, {.max_contacts = 17, .cached_factors = 3});
  const auto nodes = model.touchable();
  const Requirement& need = body.requirement();
  Outcome outcome;
  std::size_t first = 0;
  for (int i = 0; i < 400; ++i) {
    first = i % 3 == 0 ? random() % nodes.size() : first;
    std::vector<Contact> contacts(1 + (first + static_cast<std::size_t>(i / 9)) % 17);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      contacts[k].node = nodes[(first + 5 * k) % nodes.size()];
      for (float& u : contacts[k].displacement) {
        u = (static_cast<float>(random() >> 40) * 0x1p-23F - 1) * 0x1p-9F;
      }
    }
    const std::uint64_t budget = need.least_work + random() % (need.worst_work[3] - need.least_work);
    const StepReport report = body.step(contacts, budget, i % 4 != 0);
    outcome.hash = hash_step(outcome.hash, report, body.force(), body.field());
    outcome.answered += report.status <= Status::coarser ? 1 : 0;
    outcome.levels |= 1U << report.constraint_level;
  }
  return outcome;
}

TEST_CASE("the same bits everywhere") {
  if (!processor_runs_this()) {
    MESSAGE("this processor lacks the instructions; nothing was compared");
    return;
  }
  const TestModel model(encode(arbitrary_model()));
  const Outcome outcome = run_script(model);
  CHECK(outcome.answered > 390);
  CHECK(outcome.levels == 0xf);
  CHECK(run_script(model).hash == outcome.hash);
  CHECK(outcome.hash == golden);
}

}  // namespace
}  // namespace greenloop
