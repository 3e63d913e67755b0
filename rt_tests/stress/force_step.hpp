#pragma once

#include <span>
#include <vector>

#include "runtime/elastostatic.hpp"

namespace greenloop {

/// How far contact forces step from one answered cycle to the next while nothing moves: by changes of level alone.
class ForceStep {
 public:
  /// Forgets the cycle before.
  void restart() { answered_ = false; }

  /// ||f - f'|| over the larger of ||f|| and ||f'||, f' of the cycle before; 0 unless both were answered with the same
  /// contacts and displacements. force: [3 * contacts] N.
  double follow(std::span<const Constraint> contacts, bool answered, std::span<const float> force);

 private:
  bool answered_ = false;
  std::vector<Constraint> contacts_;
  std::vector<float> force_;
};

}  // namespace greenloop
