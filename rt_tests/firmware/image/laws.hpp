#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>

#include "rt_tests/firmware/image/instruction_clock.hpp"
#include "runtime/friction/contact_problem.hpp"

namespace greenloop::firmware {

/// Problems of unilateral contact with friction of 1 to 16 points, pressed and dragged at random.
class LawProblems {
 public:
  static constexpr std::uint32_t most_points = 16, problems = 192;

  explicit LawProblems(std::uint64_t seed) : random_(static_cast<std::uint32_t>(seed)) {}

  /// Makes the next one.
  void next();

  /// Solves it as it was made; work: units at `prices`.
  struct Solved {
    std::uint64_t work = 0, instructions = 0;
    bool valid = false;
  };
  [[nodiscard]] Solved solve(const Prices& prices, std::span<std::byte> memory) const;

  [[nodiscard]] std::uint32_t points() const { return points_; }

 private:
  float between(float low, float high);

  std::minstd_rand random_;
  std::uint32_t made_ = 0, points_ = 0;
  Block<3> block_[ContactCompliance::size(most_points)] = {};
  ContactCandidate candidate_[most_points] = {};
  Vec4 start_[most_points] = {};
};

}  // namespace greenloop::firmware
