#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rt_tests/bench/machine_limits.hpp"
#include "runtime/model.hpp"

namespace greenloop::bench {

/// A kernel of the loop against what the machine allows, one set of contacts over and over, so that everything is in
/// the caches; "cold": after a stream longer than any cache.
struct RooflinePoint {
  const char* kernel = "";
  std::size_t contacts = 0;
  double bytes = 0;       ///< that a call has to read and to write; read again in another pass: counted again
  double flops = 0;       ///< of a call
  double us = 0;          ///< a call
  double gb_per_s = 0;    ///< of the least of the streams that is at least `bytes` long
  double bound_us = 0;    ///< bytes at that bandwidth
  double ratio = 0;       ///< us over bound_us, median of rounds that measure both
  double compute_us = 0;  ///< flops at the machine's most
  [[nodiscard]] bool compute_bound() const { return compute_us > bound_us; }
};

struct Roofline {
  std::array<double, stream_bytes.size()> gb_per_s{};  ///< of each stream, median
  double gflops = 0;
  std::vector<RooflinePoint> points;
};

/// Thread CPU time, medians of `rounds`.
[[nodiscard]] Roofline measure_roofline(const Model& model, const std::vector<std::size_t>& contacts,
                                        std::size_t rounds);

}  // namespace greenloop::bench
