#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/friction/contact_compliance.hpp"
#include "runtime/friction/contact_newton.hpp"
#include "runtime/friction/friction.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

// Unilateral contact with Coulomb friction on the compliance of some candidates: points of a body's surface that may
// touch a tool. Forces f are those of the tools on the body; u_i = gap_i + sum_j A_ij f_j. For each, normal force and
// gap u.n are at least 0 and one of them is; the friction force is at most mu times the normal force, and it is that,
// and against the slip, where the point slips over the tool. Slips are those of a step, from the last converged state
// (quasi-static, as Cattaneo and Mindlin solve it).

/// A point that may touch a tool, in the frame of the body.
struct ContactCandidate {
  /// m, without contact forces: along `normal` the distance from the tool's surface, negative inside; across it the
  /// way from where the point would be had it stuck to the tool since the last step
  Vec4 gap;
  Vec4 normal;         ///< unit, out of the tool: against it the body's point would penetrate
  float friction = 0;  ///< mu >= 0
};

struct ContactAccuracy {
  float residual = 1e-3F;         ///< at which the iteration ends
  std::uint32_t iterations = 50;  ///< at most
};

struct ContactAnswer {
  bool valid = false;            ///< false: something was not finite or a point's compliance not positive definite;
                                 ///< then all forces are 0
  float residual = 0;            ///< norm of the natural map (friction.hpp) of all candidates over that of the forces
  std::uint32_t iterations = 0;  ///< pairs of sweeps
  std::uint64_t work = 0;        ///< units spent, at most what was allowed
};

/// Sweeps of block Gauss-Seidel with exact solutions of each candidate's own problem (nonsmooth contact dynamics: Jean
/// 1999), which settle who touches, sticks and slips, and after each pair of sweeps, if it does not suffice, Newton
/// steps of all together (ContactNewton) while they help. A pair, forwards and backwards, reads each block once:
/// forwards the sums of what stands before a candidate are formed, backwards those of what stands behind, and each
/// serves the other (Niethammer 1964).
class ContactProblem {
 public:
  static constexpr std::uint32_t most_candidates = PushedPoints::most;

  /// Arrays out of `arena`; null while it counts. candidates: 1 .. most_candidates. prices: of what `solve` counts.
  void carve(Arena& arena, std::uint32_t candidates, const Prices& prices = {}) noexcept;

  /// Work units that `solve` needs at least for so many candidates: setting up and one pair of sweeps.
  static constexpr std::uint64_t least_work(const Prices& prices, std::uint64_t candidates) {
    return setup_work(prices, candidates) + sweep_work(prices, candidates);
  }

  /// The most that a pair of sweeps and the Newton steps after it take.
  static constexpr std::uint64_t iteration_work(const Prices& prices, std::uint64_t candidates) {
    return sweep_work(prices, candidates) + most_steps * newton_work(prices, candidates, ContactNewton::most_vectors) +
           projection_work(prices, candidates);
  }

  /// force: [candidates] N, where the iteration begins, the last answer or 0; becomes the answer, the one of the least
  /// residual. Normal forces are at least 0 and friction forces within the cone, also in double precision to the
  /// rounding of `normal`, however little work was allowed. states, displacements: [candidates] or empty;
  /// displacements: u, m. work: at least least_work. Fewer candidates than `carve` was told are fine. For the loop;
  /// work: at most `work`, counted, so that the same input gives the same bits.
  ContactAnswer solve(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                      const ContactAccuracy& accuracy, std::uint64_t work, std::span<Vec4> force,
                      std::span<ContactState> states, std::span<Vec4> displacements) noexcept;

  /// A candidate of the problem that was solved last.
  struct Contact {
    const FrictionContact* law;
    ContactState state;
    Float4 force;         ///< N
    Float4 displacement;  ///< u, m
  };
  [[nodiscard]] Contact contact(std::size_t i) const noexcept {
    return {contact_ + i, contact_state(contact_[i], best_force_[i]), best_force_[i], best_displacement_[i]};
  }

  /// Work units of `respond`, at most.
  static constexpr std::uint64_t response_work(const Prices& prices, std::uint64_t candidates) {
    return newton_work(prices, candidates, ContactNewton::most_vectors);
  }

  /// After `solve` with a valid answer: freezes its contacts in their states for `respond`, until the next `solve`. For
  /// the loop, linear in the candidates.
  void linearise() noexcept { newton_.linearise(points_, best_force_, best_displacement_); }

  /// What forces change by when gaps do, to a thousandth. displacement: [candidates] m, the gaps' change, becomes that
  /// of the displacements. force: [candidates] N. Returns the work units that it took. For the loop.
  std::uint64_t respond(Float4* displacement, Float4* force) noexcept;

 private:
  static constexpr std::uint32_t most_steps = 8;  ///< of Newton between sweeps

  // blocks of half the matrix, in one direction
  static constexpr std::uint64_t half_work(const Prices& prices, std::uint64_t candidates) {
    return priced(candidates * candidates / 2, prices.law_block);
  }
  static constexpr std::uint64_t setup_work(const Prices& prices, std::uint64_t candidates) {
    return priced(candidates, prices.law);
  }
  static constexpr std::uint64_t sweep_work(const Prices& prices, std::uint64_t candidates) {
    return 4 * half_work(prices, candidates) + priced(candidates, prices.swept_law);
  }
  static constexpr std::uint64_t projection_work(const Prices& prices, std::uint64_t candidates) {
    return 2 * half_work(prices, candidates) + priced(candidates, prices.projected_law);
  }
  static constexpr std::uint64_t vector_work(const Prices& prices, std::uint64_t candidates) {
    return 2 * half_work(prices, candidates) + priced(candidates, prices.law_vector);
  }
  static constexpr std::uint64_t newton_work(const Prices& prices, std::uint64_t candidates, std::uint64_t vectors) {
    return 4 * half_work(prices, candidates) + priced(candidates, prices.frozen_law) +
           vectors * vector_work(prices, candidates);
  }

  [[nodiscard]] bool set(std::span<const ContactCandidate> candidates, const ContactCompliance& compliance,
                         std::span<const Vec4> force) noexcept;
  void sweep() noexcept;
  void project() noexcept;
  /// Of the natural map.
  struct Residual {
    float square = 0;    ///< N^2
    float of_force = 0;  ///< N^2, the forces'
    [[nodiscard]] float relative() const noexcept;
  };
  [[nodiscard]] Residual residual() const noexcept;
  void judge(ContactAnswer& answer) noexcept;
  [[nodiscard]] bool newton(float accuracy, std::uint64_t work, ContactAnswer& answer) noexcept;
  void bound_energy(ContactAnswer& answer) noexcept;
  void iterate(const ContactAccuracy& accuracy, std::uint64_t work, ContactAnswer& answer) noexcept;

  Prices prices_;
  ContactPoints points_;
  float best_square_ = 0;  ///< the least Residual::square
  FrictionContact* contact_ = nullptr;
  float* multiplier_ = nullptr;  ///< see local_force
  Float4* gap_ = nullptr;
  Float4* force_ = nullptr;         ///< the iterate
  Float4* displacement_ = nullptr;  ///< its u
  Float4* before_ = nullptr;        ///< displacement by the forces of candidates before each
  Float4* behind_ = nullptr;        ///< by those of candidates behind it
  Float4* best_force_ = nullptr;    ///< the iterate of the least residual
  Float4* best_displacement_ = nullptr;
  ContactNewton newton_;
};

}  // namespace greenloop
