#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/algebra/block.hpp"
#include "runtime/contact/friction.hpp"
#include "runtime/contact/mixing.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// Unilateral contact with Coulomb friction on the compliance of some candidates: points of a body's surface that may
/// touch a tool. Forces f are those of the tools on the body; u_i = gap_i + sum_j A_ij f_j. For each, normal force and
/// gap are at least 0 and one of them is; the friction force is at most mu times the normal force, and it is that, and
/// against the slip, where the point slips over the tool. Slips are those of a step, from the last converged state
/// (quasi-static, as Cattaneo and Mindlin solve it).

/// A point that may touch a tool, in the frame of the body.
struct ContactCandidate {
  /// m, without contact forces: along `normal` the distance from the tool's surface, negative inside; across it the
  /// way from where the point would be had it stuck to the tool since the last step
  Vec4 gap;
  Vec4 normal;         ///< unit, out of the tool: against it the body's point would penetrate
  float friction = 0;  ///< mu >= 0
};

/// Blocks of the upper triangle, column by column: a candidate more is a column more, of blocks 0 .. itself. What block
/// `at(i, j)`, i <= j, times a force at j adds to the displacement of i, m/N. Fourth lanes are 0.
struct ContactCompliance {
  Block<3>* block = nullptr;

  static constexpr std::size_t size(std::size_t candidates) { return candidates * (candidates + 1) / 2; }
  [[nodiscard]] Block<3>* column(std::size_t j) const noexcept { return block + size(j); }
  [[nodiscard]] Block<3>& at(std::size_t i, std::size_t j) const noexcept { return column(j)[i]; }
};

struct ContactAccuracy {
  float residual = 1e-3F;            ///< at which the iteration ends
  std::uint32_t iterations = 0xffff;  ///< at most
};

struct ContactAnswer {
  bool valid = false;            ///< false: something was not finite or a point's compliance not positive definite;
                                 ///< then all forces are 0
  float residual = 0;            ///< norm of the natural map (friction.hpp) of all candidates over that of the forces
  std::uint32_t iterations = 0;  ///< pairs of sweeps
  std::uint64_t work = 0;        ///< units spent, at most what was allowed
};

/// Block Gauss-Seidel iterations, forward and backward in turn, with exact solutions of each candidate's own problem
/// (nonsmooth contact dynamics: Jean 1999; Acary & Brogliato 2008), extrapolated by Anderson's mixing of the last few
/// (Walker & Ni 2011). A sweep back and forth reads each block once: forwards the sums of what stands before a
/// candidate are formed, backwards those of what stands behind, and each serves the other (Niethammer 1964).
class ContactProblem {
 public:
  static constexpr std::uint32_t most_candidates = 256;

  /// Arrays out of `arena`; null while it counts. candidates: 1 .. most_candidates.
  void carve(Arena& arena, std::uint32_t candidates) noexcept;

  // Work units of solve with so many candidates: what it needs, and the most that an iteration takes.
  static constexpr std::uint64_t least_work(std::uint64_t candidates) {
    return setup_work(candidates) + iteration_work(candidates);
  }
  static constexpr std::uint64_t iteration_work(std::uint64_t candidates) {
    return 3 * half_work(candidates) + candidates * iteration_price;
  }

  /// force: [candidates] N, where the iteration begins, for instance the last answer or 0; becomes the answer, which
  /// lies in the friction cones (within rounding of `normal` to unit length) however little work was allowed.
  /// states, displacements: [candidates] or empty; displacements: u, m, of which the part across the normal is the
  /// slip. work: at least least_work. Fewer candidates than `carve` was told are fine. For the loop; work: at most
  /// `work`; the same bits for the same input.
  ContactAnswer solve(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                      const ContactAccuracy& accuracy, std::uint64_t work, std::span<Vec4> force,
                      std::span<ContactState> states, std::span<Vec4> displacements) noexcept;

 private:
  static constexpr std::uint64_t block_price = 14;  ///< instructions for a block in one direction
  static constexpr std::uint64_t setup_price = 400;
  static constexpr std::uint64_t iteration_price = 900;
  static constexpr std::uint64_t half_work(std::uint64_t candidates) {
    return candidates * candidates / 2 * block_price;
  }
  static constexpr std::uint64_t setup_work(std::uint64_t candidates) {
    return 2 * half_work(candidates) + candidates * setup_price;
  }

  struct Sizes {
    float force = 0;
    float residual = 0;
  };
  [[nodiscard]] bool set(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                         std::span<const Vec4> force) noexcept;
  void sum_behind(const ContactCompliance& compliance) noexcept;
  void sweep_forwards(const ContactCompliance& compliance) noexcept;
  void sweep_backwards(const ContactCompliance& compliance) noexcept;
  [[nodiscard]] Sizes step() const noexcept;
  [[nodiscard]] Sizes displace(const ContactCompliance& compliance) noexcept;
  void extrapolate() noexcept;

  std::uint32_t count_ = 0;
  FrictionContact* contact_ = nullptr;
  float* multiplier_ = nullptr;    ///< see local_force
  Float4* gap_ = nullptr;
  Float4* force_ = nullptr;        ///< the iterate
  Float4* begun_ = nullptr;        ///< what the iteration began with
  Float4* before_ = nullptr;       ///< displacement by the forces of candidates before each
  Float4* behind_ = nullptr;       ///< by those of candidates behind it
  Float4* displacement_ = nullptr;
  Mixing mixing_;
};

}  // namespace greenloop
