#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/write/model_file.hpp"
#include "offline/simulate/multigrid_model.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop::offline {

/// A body with its memory; of a scene that makes none a test fails.
class SimulatedBody {
 public:
  explicit SimulatedBody(const MultigridScene& scene, const Multigrid::Limits& limits = {})
      : file_(encoded_file(multigrid_model(scene))) {
    const auto opened = Model::open(file_.bytes.span());
    REQUIRE(opened);
    model_ = opened.model;
    need_ = Multigrid::required(model_, limits);
    memory_ = std::vector<Line>(need_.bytes / sizeof(Line) + 1);
    const auto created = Multigrid::create(model_, limits, {reinterpret_cast<std::byte*>(memory_.data()), need_.bytes});
    REQUIRE(created);
    body_ = created.body;
    displacement_.resize(file_.view.multigrid.info->vertices);
  }

  Multigrid::StepReport step(const Multigrid::Inputs& inputs, std::uint64_t work = std::uint64_t{1} << 60) {
    return body_.step(inputs, {work}, {.displacement = displacement_});
  }
  /// With what the holds act with.
  Multigrid::StepReport hold(std::span<const Multigrid::Hold> holds, std::span<Vec3> reaction) {
    return body_.step({.holds = holds}, {std::uint64_t{1} << 60},
                      {.displacement = displacement_, .reaction = reaction});
  }
  [[nodiscard]] const std::vector<Vec3>& displacement() const { return displacement_; }
  [[nodiscard]] const Multigrid::Requirement& need() const { return need_; }
  [[nodiscard]] const MultigridView& view() const { return file_.view.multigrid; }
  [[nodiscard]] Multigrid& body() { return body_; }

 private:
  struct alignas(64) Line {
    std::byte bytes[64];
  };
  ModelFile file_;
  Model model_;
  Multigrid::Requirement need_;
  std::vector<Line> memory_;
  Multigrid body_;
  std::vector<Vec3> displacement_;
};

}  // namespace greenloop::offline
