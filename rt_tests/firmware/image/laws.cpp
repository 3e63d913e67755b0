#include "rt_tests/firmware/image/laws.hpp"

#include <algorithm>

namespace greenloop::firmware {

float LawProblems::between(float low, float high) {
  const auto share =
      static_cast<float>(random_() - std::minstd_rand::min()) / static_cast<float>(std::minstd_rand::max());
  return low + (high - low) * share;
}

// points in a row, whose compliance falls with their distance: convex in it, so positive definite (Polya 1918)
void LawProblems::next() {
  points_ = 1 + made_++ % most_points;
  const float friction = between(0, 1) < 0.25F ? 0 : between(0.1F, 1);
  for (std::uint32_t j = 0; j < points_; ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) {
      const float falling = 1 / static_cast<float>(1 + j - i);
      Block<3>& block = block_[ContactCompliance::size(j) + i];
      block.column[0] = Float4{falling, 0, 0.1F * falling, 0};
      block.column[1] = Float4{0, falling, 0, 0};
      block.column[2] = Float4{0.1F * falling, 0, falling, 0};
    }
    candidate_[j].gap = {between(-0.3F, 0.3F), between(-0.3F, 0.3F), between(-1, 0.4F), 0};
    candidate_[j].normal = {0, 0, 1, 0};
    candidate_[j].friction = friction;
    start_[j] = {0, 0, made_ % 2 == 0 ? between(0, 0.5F) : 0, 0};
  }
}

LawProblems::Solved LawProblems::solve(const Prices& prices, std::span<std::byte> memory) const {
  Arena arena(memory.data());
  ContactProblem problem;
  problem.carve(arena, points_, prices);
  Block<3> block[ContactCompliance::size(most_points)];
  std::copy(std::begin(block_), std::end(block_), block);
  Vec4 force[most_points], displacement[most_points];
  ContactState state[most_points];
  std::copy(std::begin(start_), std::end(start_), force);
  const std::uint64_t begin = instructions();
  const ContactAnswer answer =
      problem.solve({candidate_, points_}, {block}, {.residual = 1e-4F, .iterations = 8}, ~std::uint64_t{0},
                    {force, points_}, {state, points_}, {displacement, points_});
  return {answer.work, instructions() - begin, answer.valid};
}

}  // namespace greenloop::firmware
