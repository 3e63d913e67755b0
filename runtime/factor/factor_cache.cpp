#include "runtime/factor/factor_cache.hpp"

#include <cstring>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/algebra/fnv1a.hpp"

namespace greenloop {
namespace {

// FNV-1a over whole words, mixed downwards, never 0
std::uint64_t key_of(ColumnSet set) {
  std::uint64_t key = Fnv1a().value();
  for (std::uint32_t k = 0; k < set.count; ++k) {
    key = (key ^ set.column[k]) * Fnv1a::prime;
    key ^= key >> 29;
  }
  return key == 0 ? 1 : key;
}

bool belongs_to(const Factor& factor, ColumnSet set) {
  return factor.columns == set.count && std::memcmp(factor.column, set.column, sizeof(std::uint32_t) * set.count) == 0;
}

}  // namespace

template <unsigned N>
void FactorCache::carve(Arena& arena, std::uint32_t factors, std::uint32_t columns, bool keeps_capacitance) noexcept {
  stride_ = padded_order(N * columns);
  factors_ = factors;
  factor_ = arena.take_zeroed<Factor>(factors);
  for (std::uint32_t i = 0; i < factors; ++i) {
    Factor factor;
    factor.carve<N>(arena, columns, keeps_capacitance);
    if (factor_ != nullptr) {
      factor_[i] = factor;
    }
  }
}

Factor* FactorCache::find(ColumnSet set) const noexcept {
  const std::uint64_t key = key_of(set);
  for (std::uint32_t i = 0; i < factors_; ++i) {
    if (factor_[i].key == key) {
      // keys are unique: a set with the same key replaces the other one
      return belongs_to(factor_[i], set) ? factor_ + i : nullptr;
    }
  }
  return nullptr;
}

Factor& FactorCache::make_room(ColumnSet set) noexcept {
  const std::uint64_t key = room_key_ = key_of(set);
  Factor* oldest = factor_;
  for (std::uint32_t i = 0; i < factors_; ++i) {
    if (factor_[i].key == key) {
      oldest = factor_ + i;
      break;
    }
    oldest = factor_[i].used < oldest->used ? factor_ + i : oldest;
  }
  oldest->key = 0;
  oldest->used = 0;
  return *oldest;
}

void FactorCache::keep(Factor& factor, ColumnSet set) noexcept {
  factor.key = room_key_;
  use(factor);
  factor.columns = set.count;
  std::memmove(factor.column, set.column, sizeof(std::uint32_t) * set.count);  // may be its own
}

template void FactorCache::carve<1>(Arena&, std::uint32_t, std::uint32_t, bool) noexcept;
template void FactorCache::carve<3>(Arena&, std::uint32_t, std::uint32_t, bool) noexcept;

}  // namespace greenloop
