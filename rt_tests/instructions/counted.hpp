#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {

// one copy of it for each kind of work: what is inlined there counts as well
template <class Work>
[[gnu::noinline]] std::uint64_t count_once(Work& work) {
  instruction_counter::start();
  work();
  return instruction_counter::stop();
}

/// Instructions that `work` takes after `prepare`, by the counter, which must be installed. They are counted until two
/// counts in a row agree, four times at most: a virtual machine may lose a trap where it is interrupted.
template <class Prepare, class Work>
std::uint64_t count_instructions(Prepare prepare, Work work) {
  std::uint64_t count = 0, last = 0;
  for (int attempt = 0; attempt < 4 && (attempt == 0 || count != last); ++attempt) {
    last = count;
    prepare();
    count = count_once(work);
  }
  return count;
}

template <class Work>
std::uint64_t count_instructions(Work work) {
  return count_instructions([] {}, work);
}

/// Instructions of work(i) after `prepare`, for each i below n. If two or more counts all agree, one of each is enough;
/// otherwise each is counted until two in a row agree.
template <class Prepare, class Work>
std::vector<std::uint64_t> count_each(std::size_t n, Prepare prepare, Work work) {
  std::size_t i = 0;
  const auto of_this = [&] { work(i); };
  std::vector<std::uint64_t> counts(n);
  for (i = 0; i < n; ++i) {
    prepare();
    counts[i] = count_once(of_this);
  }
  const bool agree = n > 1 && std::count(counts.begin(), counts.end(), counts[0]) == static_cast<std::ptrdiff_t>(n);
  for (i = 0; i < n && !agree; ++i) {
    counts[i] = count_instructions(prepare, of_this);
  }
  return counts;
}

/// Says what the counts were where they differ.
inline bool all_equal(const std::vector<std::uint64_t>& counts) {
  const auto other = [&](std::uint64_t count) { return count != counts[0]; };
  const auto found = std::find_if(counts.begin(), counts.end(), other);
  if (found != counts.end()) {
    MESSAGE("the first takes " << counts[0] << " instructions, number " << found - counts.begin() << " takes "
                               << *found);
  }
  return found == counts.end();
}

}  // namespace greenloop
