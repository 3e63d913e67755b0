#include "sim_hw/session/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "formats/output/output_file.hpp"
#include "sim_hw/device/encoder.hpp"
#include "sim_hw/device/touch_place.hpp"
#include "sim_hw/session/agreement.hpp"
#include "sim_hw/session/hosted_contact_body.hpp"
#include "sim_hw/session/loaded_model.hpp"

namespace greenloop {
namespace {

struct Bench {
  const Model& model;
  Agreement agreement;
  TouchPlace place;
  double depth = 0, radius = 0, friction = 0;  // m, m
  Coupling coupling;                           ///< without gain
  HandParameters hand;
  Passive passive = Passive::none;
};

ContactBody::ToolInput ball(const Bench& bench, double outward) {
  const Double3 centre = bench.place.centre + (outward - bench.depth) * bench.place.outward;
  return {{Shape::sphere(bench.radius), {centre, {1, 0, 0, 0}}}, bench.friction, 0};
}

/// A body into which a ball is pressed.
struct PressedBody {
  explicit PressedBody(const Bench& bench) : hosted(bench.model, bench.agreement.limits) {
    constexpr int steps = 20;
    for (int k = 1; k <= steps; ++k) {
      const ContactBody::ToolInput tool = ball(bench, bench.depth * (steps - k) / steps);
      static_cast<void>(hosted.body().step({&tool, 1}, {}, bench.agreement.budget));
    }
    force = dot(hosted.body().tools()[0].force, bench.place.outward);
  }

  /// N/m, along the push.
  [[nodiscard]] double stiffness(const Bench& bench) {
    LocalModel local;
    double sum = 0;
    const double out[3] = {bench.place.outward.x, bench.place.outward.y, bench.place.outward.z};
    if (hosted.body().local_model(false, static_cast<float>(bench.radius), local) > 0) {
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) sum -= out[r] * static_cast<double>(local.change[c][r]) * out[c];
      }
    }
    if (!(sum > 0)) throw std::runtime_error("stability: the body cannot be pressed with this budget");
    return sum;
  }

  HostedContactBody hosted;
  double force = 0;  ///< N, along the push
};

/// A device that moves along the push alone. Positions are those of the handle from where the ball is pressed, m.
class Loop {
 public:
  static constexpr double disturbance = 2e-4;  // m

  Loop(const Bench& bench, double rate, std::int64_t delay, double gain)
      : bench_(&bench),
        pressed_(bench),
        coupling_(bench.coupling),
        period_(1 / rate),
        tank_({.enabled = bench.passive == Passive::tank,
               .period = period_,
               .most_damping = 0.5 * hand_of(Holder::absent).mass * rate}) {
    coupling_.force_scale *= gain;
    // the hand holds against what the body pushes with, and swings a little
    const double push = coupling_.force_scale * pressed_.force;
    target_ = {-push / bench.hand.stiffness, 0, 0};
    hand_ = Hand(bench.hand, {disturbance, 0, 0});
    under_way_.assign(static_cast<std::size_t>(delay) + 1, {push, 0});
    if (bench.passive == Passive::coupling) {
      const double limit =
          passive_stiffness({period_, static_cast<double>(delay) * period_, HandParameters::device_damping});
      compliance_ = coupling_.stiffness_scale() / limit;
    }
  }

  /// Where the handle is along the push, m.
  double cycle() {
    const Double3 handle{encoder_value(encoder_counts(hand_.position().x, Coupling::resolution), Coupling::resolution),
                         0, 0};
    ContactBody::ToolInput tool = ball(*bench_, coupling_.motion_scale * handle.x - compliance_ * pressed_.force);
    tool.compliance = compliance_;
    ContactBody& body = pressed_.hosted.body();
    static_cast<void>(body.step({&tool, 1}, {}, bench_->agreement.budget));
    under_way_.pop_front();
    under_way_.push_back({coupling_.force_scale * dot(body.tools()[0].force, bench_->place.outward),
                          coupling_.energy_scale() * body.energy().stored});
    Double3 force{under_way_.front().force, 0, 0};
    tank_.step({&handle, 1}, {&force, 1}, under_way_.front().stored);
    hand_.advance({target_, target_, target_}, force, period_);
    return hand_.position().x;
  }

 private:
  struct Rendering {
    double force = 0, stored = 0;
  };

  const Bench* bench_;
  PressedBody pressed_;
  Coupling coupling_;
  double period_, compliance_ = 0;
  Double3 target_;
  Hand hand_;
  std::deque<Rendering> under_way_;
  EnergyTank tank_;
};

// of_body: N/m, without gain
StabilityCell try_loop(const Bench& bench, double of_body, double rate, std::int64_t delay, double stiffness) {
  StabilityCell cell{.rate = rate, .delay = static_cast<double>(delay) / rate, .stiffness = stiffness};
  cell.bound = passive_stiffness({1 / rate, cell.delay, HandParameters::device_damping});
  Loop loop(bench, rate, delay, stiffness / (bench.coupling.stiffness_scale() * of_body));
  const auto quarter = static_cast<int>(rate / 4);
  for (int q = 0; q < 4; ++q) {
    double low = 0, high = 0;
    for (int k = 0; k < quarter; ++k) {
      const double at = loop.cycle();
      low = k == 0 ? at : std::min(low, at);
      high = k == 0 ? at : std::max(high, at);
    }
    cell.largest = std::max(cell.largest, high - low);
    (q == 1 ? cell.early : cell.late) = high - low;
  }
  return cell;
}

}  // namespace

bool StabilityCell::stable() const {
  constexpr double seen = 5 * Coupling::resolution;
  return (late <= seen || late <= 0.9 * early) && largest <= 10 * Loop::disturbance;
}

std::vector<StabilityCell> stability_map(const SessionOptions& options, std::size_t steps) {
  const LoadedModel loaded = load_model(options.model);
  const BodySurface surface = body_surface(loaded.model);
  const ProbeSize probe = probe_size(surface);
  Bench bench{.model = loaded.model,
              .agreement = agree(options, loaded.model),
              .place = touch_places(surface, probe.radius, 1).front(),
              .depth = 0.5 * probe.depth,
              .radius = probe.radius,
              .friction = options.friction,
              .passive = options.passive};
  bench.coupling = coupling(*loaded.model.view().info, surface, probe, bench.hand);
  bench.hand = hand_of(options.hand);
  const double of_body = PressedBody(bench).stiffness(bench);
  std::vector<StabilityCell> cells;
  for (const double rate : {500.0, 1000.0, 2000.0}) {
    for (const std::int64_t delay : {0, 1, 2, 4, 8}) {
      const double bound =
          passive_stiffness({1 / rate, static_cast<double>(delay) / rate, HandParameters::device_damping});
      for (std::size_t i = 0; i < steps; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(steps - 1);
        cells.push_back(try_loop(bench, of_body, rate, delay, bound * std::exp2(-2 + 5 * share)));
      }
    }
  }
  return cells;
}

void write_stability(const std::filesystem::path& file, const std::vector<StabilityCell>& cells) {
  OutputFile out(file);
  out.write("rate,delay,stiffness,bound,early,late,largest,stable\n");
  for (const StabilityCell& cell : cells) {
    out.write(fmt::format("{},{},{},{},{},{},{},{}\n", cell.rate, cell.delay, cell.stiffness, cell.bound, cell.early,
                          cell.late, cell.largest, cell.stable() ? 1 : 0));
  }
  out.close();
}

}  // namespace greenloop
