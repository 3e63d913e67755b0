// The same steps give the same bits on every compiler and instruction set: this file is compiled with the runtime's
// sources several times, and every program must find the same hash.
#include <doctest/doctest.h>

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

constexpr std::uint64_t golden = 3629242255433389737U;

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

void fill_couplings(std::mt19937_64& random, std::size_t columns, std::size_t rows, bool same, bool every_row,
                    CouplingsData& couplings) {
  couplings.begin = {0};
  couplings.index.clear();
  couplings.value.clear();
  const int most = (1 << (couplings.value_bits - 1)) - 1;
  // small enough that the identity outweighs a whole row
  couplings.quantum = 0x1p-10F / static_cast<float>(most) * (1 + uniform(random));
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::uint32_t i = 0; i < (same ? j : rows); ++i) {
      if (!every_row && random() % 4 != 0) {
        continue;
      }
      if (!every_row) {
        couplings.index.push_back(i);
      }
      for (int k = 0; k < 9; ++k) {
        couplings.value.push_back(static_cast<std::int16_t>(static_cast<int>(random() % (2U * most + 1)) - most));
      }
    }
    couplings.begin.push_back(static_cast<std::uint32_t>(couplings.value.size() / 9));
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
ModelData arbitrary_model() {
  std::mt19937_64 random(20);
  ModelData data = synthetic_model({.levels = 4, .touchable_above = 0.2});
  std::size_t up_to[4];
  for (std::size_t q = 0; q < data.levels.size(); ++q) {
    LevelData& level = data.levels[q];
    up_to[q] = domain(level) + (q > 0 ? up_to[q - 1] : 0);
    for (layout::RefinementRecord& record : level.refinement) {
      for (float& lift : record.lift) {
        lift = lift == 0 ? 0 : uniform(random) / 4;
      }
    }
    fill_scales(random, level.details);
    fill_scales(random, level.averages);
    const std::size_t rows[] = {up_to[q < 2 ? 0 : q - 2], q < 2 ? 0 : domain(data.levels[q - 1]), domain(level)};
    for (std::size_t partner = 0; partner < 3; ++partner) {
      for (std::size_t strength = 0; strength < layout::strengths; ++strength) {
        CouplingsData& couplings = level.couplings[partner][strength];
        if (couplings.begin.empty()) {
          continue;
        }
        couplings.value_bits = q == 0 ? 16 : 4U << (q + partner + strength) % 3;
        fill_couplings(random, domain(level), rows[partner], partner == 2, q == 0, couplings);
      }
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
  const TestModel model(encode(arbitrary_model()));
  const Outcome outcome = run_script(model);
  CHECK(outcome.answered > 390);
  CHECK(outcome.levels == 0xf);
  CHECK(run_script(model).hash == outcome.hash);
  CHECK(outcome.hash == golden);
}

}  // namespace
}  // namespace greenloop
