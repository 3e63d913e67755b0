#include "rt_tests/bench/synthesis_benchmark.hpp"

#include <set>
#include <stdexcept>
#include <utility>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/bench/machine_limits.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/harness/time_of.hpp"

namespace greenloop::bench {
namespace {

constexpr std::uint32_t steps_per_impulse = 64;

// A body that is pushed now and then by whatever may follow.
class Pushed {
 public:
  explicit Pushed(const Model& model)
      : impulses_(model.view().impulse_response.info->impulses),
        need_(ImpulseResponse::required(model, {})),
        memory_(need_.bytes) {
    const auto created = ImpulseResponse::create(model, {}, {memory_.data(), memory_.size()});
    if (!created) throw std::runtime_error("no body for this model");
    body_ = created.body;
  }

  ImpulseResponse::StepReport step(std::uint64_t work, const ImpulseResponse::Response& response) {
    std::uint32_t impulse = ImpulseResponse::no_impulse;
    if (step_++ % steps_per_impulse == 0) {
      for (std::uint32_t k = 0; k < impulses_ && impulse == ImpulseResponse::no_impulse; ++k) {
        const std::uint32_t next = (last_ + 1 + k) % impulses_;
        if (body_.may_follow(next)) impulse = last_ = next;
      }
    }
    return body_.step(impulse, {work}, response);
  }
  [[nodiscard]] const ImpulseResponse::Requirement& need() const { return need_; }

 private:
  std::uint32_t impulses_;
  ImpulseResponse::Requirement need_;
  AlignedBytes memory_;
  ImpulseResponse body_;
  std::uint32_t step_ = 0, last_ = 0;
};

double over_reading(double us, double bytes) {
  return us / (bytes / ReadStream(static_cast<std::size_t>(bytes)).measure());
}

SynthesisFigures measure_frames(Pushed& pushed, std::uint64_t work, std::span<Vec3> displacement, std::size_t rounds) {
  SynthesisFigures figures;
  std::vector<double> us;
  ImpulseResponse::StepReport report;
  for (std::size_t i = 0; i < rounds; ++i) {
    us.push_back(time_of(1, [&] { report = pushed.step(work, {{}, {}, displacement, {}}); }));
  }
  figures.rank = report.modes;
  figures.planes = report.planes;
  figures.vertices = static_cast<std::uint32_t>(displacement.size());
  figures.error = static_cast<double>(report.truncation_error);
  figures.us = median(us);
  figures.frames_per_s = 1e6 / figures.us;
  figures.bytes = static_cast<double>(displacement.size()) * (3.0 * report.modes * report.planes + sizeof(Vec3));
  figures.bandwidth_ratio = over_reading(figures.us, figures.bytes);
  figures.work = report.work;
  return figures;
}

ColourFigures measure_colours(const ImpulseResponseView& view, Pushed& pushed, std::size_t rounds) {
  std::vector<Vec3> colour(view.info->vertices);
  Light light;
  for (std::uint32_t i = 0; i < Light::coefficients; ++i) light.red[i] = light.green[i] = light.blue[i] = 1;
  ColourFigures figures;
  std::vector<double> us;
  ImpulseResponse::StepReport report;
  for (std::size_t i = 0; i < rounds; ++i) {
    us.push_back(
        time_of(1, [&] { report = pushed.step(pushed.need().worst_work, {.colour = colour, .light = &light}); }));
  }
  figures.rank = report.transfer_modes;
  figures.us = median(us);
  figures.frames_per_s = 1e6 / figures.us;
  figures.bytes = static_cast<double>(view.blocks()) * layout::colours *
                      static_cast<double>(layout::transfer_bytes(report.transfer_modes)) +
                  static_cast<double>(colour.size() * sizeof(Vec3));
  figures.bandwidth_ratio = over_reading(figures.us, figures.bytes);
  figures.work = report.work;
  return figures;
}

}  // namespace

MotionFigures measure_motion(const Model& model, std::size_t rounds) {
  const ImpulseResponseView& view = model.view().impulse_response;
  Pushed pushed(model);
  std::vector<float> coordinate(view.modes), velocity(view.modes);
  std::vector<Vec3> displacement(view.info->vertices);
  MotionFigures figures;
  const std::size_t steps = rounds * steps_per_impulse;
  figures.step_us = time_of(steps, [&] {
    figures.step_work = pushed.step(pushed.need().least_work, {coordinate, velocity, {}, {}}).work;
  });
  // from the whole down to the fewest modes, each fineness once
  const ImpulseResponse::Requirement& need = pushed.need();
  constexpr std::uint64_t rungs = 16;
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::uint64_t k = 0; k <= rungs; ++k) {
    const std::uint64_t work = need.frame_work - (need.frame_work - need.least_frame_work) * k / rungs;
    const auto report = pushed.step(work, {{}, {}, displacement, {}});
    if (!seen.emplace(report.modes, report.planes).second) continue;
    figures.synthesis.push_back(measure_frames(pushed, work, displacement, rounds));
  }
  if (view.appearance.modes > 0) figures.colours = measure_colours(view, pushed, rounds);
  return figures;
}

}  // namespace greenloop::bench
