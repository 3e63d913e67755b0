#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "rt_tests/firmware/image/image_driver.hpp"
#include "rt_tests/firmware/image/instruction_clock.hpp"
#include "rt_tests/harness/recorded_script.hpp"

namespace greenloop::firmware {

/// A body with these prices that runs RecordedScript on the model file in `bytes`, in this memory.
struct CountedScript {
  std::span<const std::byte> bytes;
  Prices prices;
  std::uint64_t seed;
  std::span<std::byte> arena;
  std::span<float> field;

  /// Calls visit(report, instructions) for every step; false if the model is too large for the memory.
  template <class Visit>
  bool run(Visit visit) const {
    const auto opened = Model::open(bytes);
    const Solver::Limits limits = ImageDriver::limits(RecordedScript::most_contacts, RecordedScript::sets, prices);
    auto created = Solver::create(opened.model, limits, arena);
    const std::size_t floats = std::size_t{4} * opened.model.node_count();
    if (!created || field.size() < floats) {
      return false;
    }
    RecordedScript script(opened.model, ImageDriver::bounds(limits, Solver::required(opened.model, limits)), seed);
    std::array<float, 3 * (RecordedScript::most_contacts + 1)> force{};
    for (std::uint32_t i = 0; i < RecordedScript::cycles; ++i) {
      const RecordedScript::Cycle cycle = script.next();
      const Solver::Response response{as_vec3(std::span(force).first(3 * cycle.contacts.size())),
                                      as_vec4(cycle.with_field ? field.first(floats) : std::span<float>())};
      const std::uint64_t begin = instructions();
      const Solver::StepReport report = created.body.step(cycle.contacts, cycle.budget, response);
      visit(report, instructions() - begin);
    }
    return true;
  }
};

/// Work of answered steps over the instructions that they took.
class PredictedInstructions {
 public:
  void add(std::uint64_t work, std::uint64_t instructions) {
    ++steps_;
    within_ += 5 * work >= 4 * instructions && 4 * work <= 5 * instructions ? 1 : 0;
    least_ = std::min(least_, 100 * work / instructions);
    most_ = std::max(most_, 100 * work / instructions);
  }

  void print() const;

  /// 95 in a hundred steps within 0.8..1.25, none below 0.67.
  [[nodiscard]] bool meets_the_bar() const { return 20 * within_ >= 19 * steps_ && least_ >= 67; }

 private:
  std::uint64_t steps_ = 0, within_ = 0;
  std::uint64_t least_ = ~std::uint64_t{0}, most_ = 0;  // hundredths
};

}  // namespace greenloop::firmware
