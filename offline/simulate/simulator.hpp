#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace greenloop::offline {

/// A scene that moves when impulses of a palette hit it, and comes to rest by itself. Offline only; one thread at a
/// time. The same calls from the same state give the same bits.
class Simulator {
 public:
  virtual ~Simulator() = default;

  /// s, of a step.
  [[nodiscard]] virtual double time_step() const = 0;
  /// Triangles of what is shown, [triangles][3].
  [[nodiscard]] virtual const std::vector<std::uint32_t>& triangles() const = 0;
  /// Vertices of what is shown.
  [[nodiscard]] virtual std::size_t vertices() const = 0;

  /// To rest, as it is before the first impulse.
  virtual void reset() = 0;
  /// Lets an impulse of the palette act from here on: what is impulsive in the next step, what persists until the next
  /// impulse (James & Fatahalian 2003, section 3.2).
  virtual void apply(std::size_t impulse) = 0;
  /// Throws std::runtime_error if the step has no solution; the state is as before then.
  virtual void step() = 0;
  /// Of what is shown, m, to [vertices][3].
  virtual void positions(std::span<float> out) const = 0;
  /// Whether it moves too little to be seen, and will not move more unless it is hit.
  [[nodiscard]] virtual bool at_rest() const = 0;

  /// All that the motion from here on follows from, numbers of a fixed count.
  [[nodiscard]] virtual std::vector<double> state() const = 0;
  /// Throws std::invalid_argument for another count.
  virtual void restore(std::span<const double> state) = 0;
};

}  // namespace greenloop::offline
