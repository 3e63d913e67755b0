#include "runtime/wavelet/pair_inverse.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "runtime/algebra/stored_block.hpp"
#include "runtime/testing/rooms.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t slots = 40;

template <unsigned N>
constexpr std::size_t block_bytes = StoredBlock<N, 16>::bytes;

// steps of none to seven terms; every third is by numbers alone, as the others are without blocks
template <unsigned N>
struct Steps {
  explicit Steps(bool with_blocks) : stored(block_bytes<N> * 8 * slots + 16) {
    for (std::size_t k = 0; k + 2 <= stored.size(); k += 2) {
      const auto value = static_cast<std::int16_t>(static_cast<int>(random() % 65535) - 32767);
      std::memcpy(stored.data() + k, &value, sizeof value);
    }
    for (std::uint32_t s = 0; s < slots; ++s) {
      const bool blocks = with_blocks && s % 3 != 0;
      block.push_back(blocks ? stored.data() + block_bytes<N> * term.size() : nullptr);
      for (std::uint32_t k = 0; k < s % 8; ++k) {
        term.push_back({static_cast<std::uint32_t>((s + 1 + random() % (slots - 1)) % slots), blocks ? 1 : number()});
      }
      step.push_back({s, static_cast<std::uint32_t>(term.size())});
      x.push_back({{arbitrary(), arbitrary()}});
    }
    inverse.step = step.data();
    inverse.term = term.data();
    inverse.steps = slots;
    inverse.block = with_blocks ? block.data() : nullptr;
  }

  float number() { return static_cast<float>(static_cast<int>(random() >> 40) - (1 << 23)) * 0x1p-24F; }
  Block<N> arbitrary() {
    Block<N> m;
    for (Vector<N>& column : m.column) {
      const float numbers[] = {number(), number(), number()};
      column = load_vector<N>(numbers);
    }
    return m;
  }

  std::mt19937_64 random{N};
  std::vector<std::byte> stored;
  std::vector<SparseInverse::Step> step;
  std::vector<SparseInverse::Term> term;
  std::vector<const std::byte*> block;
  std::vector<BlockPair<N>> x;
  SparseInverse inverse;
};

template <unsigned N>
std::vector<std::uint32_t> bits(const std::vector<BlockPair<N>>& x) {
  std::vector<std::uint32_t> result(x.size() * sizeof(BlockPair<N>) / sizeof(std::uint32_t));
  std::memcpy(result.data(), x.data(), x.size() * sizeof(BlockPair<N>));
  return result;
}

template <unsigned N>
double entry(const Block<N>& m, std::size_t i, std::size_t j) {
  return double{component(m.column[j], i)};
}

// element (i, j) of x P^T for a stored block P
template <unsigned N>
double moved(const Block<N>& x, const std::byte* stored, std::size_t i, std::size_t j) {
  double sum = 0;
  for (std::size_t k = 0; k < N; ++k) {
    std::int16_t value;
    std::memcpy(&value, stored + sizeof value * (N * k + j), sizeof value);
    sum += entry(x, i, k) * value / 4096.0;
  }
  return sum;
}

TEST_CASE_TEMPLATE("steps add their terms to two rows, as many as are asked for, on every processor the same bits",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const bool with_blocks : {false, true}) {
    CAPTURE(with_blocks);
    const Steps<N> steps(with_blocks);
    auto x = steps.x;
    for (std::uint32_t s = 0; s < slots; ++s) {
      const std::vector<BlockPair<N>> before = x;  // by all steps before
      auto fastest = steps.x;
      auto portable = steps.x;
      invert_pair<N>(steps.inverse, s + 1, portable.data());
      fastest_invert_pair<N>()(steps.inverse, s + 1, fastest.data());
      CHECK(bits(fastest) == bits(portable));
      const std::uint32_t first = s == 0 ? 0 : steps.step[s - 1].end;
      for (std::size_t e = 0; e < std::size_t{2} * N * N; ++e) {
        const std::size_t row = e / N / N, i = e % N, j = e / N % N;
        double wanted = entry(before[s].row[row], i, j);
        for (std::uint32_t k = first; k < steps.step[s].end; ++k) {
          const Block<N>& source = before[steps.term[k].source].row[row];
          wanted += steps.block[s] != nullptr && with_blocks
                        ? moved(source, steps.block[s] + block_bytes<N> * (k - first), i, j)
                        : double{steps.term[k].weight} * entry(source, i, j);
        }
        CHECK(entry(portable[s].row[row], i, j) == doctest::Approx(wanted).epsilon(1e-5));
      }
      x = portable;
    }
  }
}

}  // namespace
}  // namespace greenloop
