// The same steps give the same bits on every compiler and instruction set: this file is compiled with the runtime's
// sources several times, and every program must find the same hash.
#include <doctest/doctest.h>

#include <random>
#include <utility>
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

constexpr std::uint64_t golden = 6004912068896507830U;
constexpr std::uint64_t golden_butterfly = 4036103671875782908U;

bool processor_runs_this() {
#if defined(GREENLOOP_EXPECT_AVX512)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
#elif defined(GREENLOOP_EXPECT_AVX2)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-24F; }

void fill_couplings(std::mt19937_64& random, std::size_t columns, std::size_t before, std::uint32_t layer,
                    CouplingsData& couplings) {
  couplings.begin = {0};
  couplings.index.clear();
  couplings.value.clear();
  const int most = (1 << (layout::value_bits[layer] - 1)) - 1;
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::uint32_t i = 0; i < before + j; ++i) {
      if (random() % 8 != 0) {
        continue;
      }
      couplings.index.push_back(i);
      for (int k = 0; k < 9; ++k) {
        couplings.value.push_back(static_cast<std::int16_t>(static_cast<int>(random() % (2U * most + 1)) - most));
      }
    }
    couplings.begin.push_back(static_cast<std::uint32_t>(couplings.index.size()));
  }
}

void fill_scales(std::mt19937_64& random, std::vector<layout::Scale>& scales) {
  for (layout::Scale& scale : scales) {
    const float size = 0x1p-6F * (1 + uniform(random));
    for (float* matrix : {scale.root, scale.diagonal}) {
      for (int k = 0; k < 6; ++k) {
        matrix[k] = k == 0 || k == 3 || k == 5 ? size : size / 4 * uniform(random);
      }
    }
    for (float& value : scale.diagonal) {
      value *= 64;
    }
  }
}

std::size_t domain(const LevelData& level) {
  std::size_t count = 0;
  for (const layout::NodeRecord& node : level.nodes) {
    count += (node.flags & layout::node_domain) != 0 ? 1 : 0;
  }
  return count;
}

// the synthetic sphere's mesh with arbitrary numbers on it: bits that no mathematical library has a part in
ModelData arbitrary_model(layout::Wavelet wavelet) {
  std::mt19937_64 random(20);
  ModelData data = synthetic_model({.levels = 4, .wavelet = wavelet, .touchable_above = 0.2});
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    // small enough that the identity outweighs a whole row
    const int most = (1 << (layout::value_bits[layer] - 1)) - 1;
    data.info.quantum[layer] = 0x1p-10F / static_cast<float>(most) * (1 + uniform(random));
  }
  std::size_t before = 0;
  for (LevelData& level : data.levels) {
    for (layout::RefinementRecord& record : level.refinement) {
      for (float& lift : record.lift) {
        lift = lift == 0 ? 0 : uniform(random) / 4;
      }
    }
    fill_scales(random, level.scales);
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      fill_couplings(random, domain(level), before, layer, level.couplings[layer]);
    }
    before += domain(level);
    level.counts.worst_column_error = 0.5F;
    level.counts.rms_error = 0.25F;
    level.counts.field_column_error = 0.5F;
    level.counts.field_rms_error = 0.25F;
  }
  allow_all_field_blocks(data);
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
    const std::uint64_t budget = need.least_work + random() % (1 + ((need.worst_work[3] - need.least_work) >> i % 16));
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
  for (const auto& [wavelet, expected] :
       {std::pair(layout::Wavelet::lifted_linear, golden), {layout::Wavelet::lifted_butterfly, golden_butterfly}}) {
    const TestModel model(encode(arbitrary_model(wavelet)));
    const Outcome outcome = run_script(model);
    CHECK(outcome.answered > 390);
    CHECK(outcome.levels == 0xf);
    CHECK(run_script(model).hash == outcome.hash);
    CHECK(outcome.hash == expected);
  }
}

}  // namespace
}  // namespace greenloop
