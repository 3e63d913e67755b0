#include "offline/reduce/testing/damped_sheet.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace greenloop::offline {
namespace {

constexpr std::size_t waves = 3;  // along each side
constexpr std::size_t modes = waves * waves;
constexpr double step = 1.0 / 60, length = 0.2, slowest = 3.0, damping = 0.08;  // s, m, Hz, ratio
constexpr int shortest = 45, longest = 150;                                     // frames

/// Where the modes are, and how fast.
struct SheetState {
  std::array<double, modes> x{}, v{};
};

double wave_x(std::size_t mode) { return static_cast<double>(1 + mode % waves); }
double wave_y(std::size_t mode) { return static_cast<double>(1 + mode / waves); }

/// The exact solution of x'' + 2 z w x' + w^2 x = 0 a time step later.
SheetState later(const SheetState& now) {
  SheetState next;
  for (std::size_t m = 0; m < modes; ++m) {
    const double w = 2 * std::numbers::pi * slowest * std::hypot(wave_x(m), wave_y(m)) / std::sqrt(2.0);
    const double wd = w * std::sqrt(1 - damping * damping), fade = std::exp(-damping * w * step);
    const double c = std::cos(wd * step), s = std::sin(wd * step) / wd;
    next.x[m] = fade * (now.x[m] * c + (now.v[m] + damping * w * now.x[m]) * s);
    next.v[m] = fade * (now.v[m] * c - (w * w * now.x[m] + damping * w * now.v[m]) * s);
  }
  return next;
}

void kick(std::uint32_t impulse, SheetState& state) {
  constexpr double speed = 0.6;
  state.v[0] += impulse == 0 ? speed : impulse == 1 ? -speed : 0;
  state.v[1] += impulse == 2 ? speed : 0.1 * speed;
  state.v[4] += impulse == 2 ? -0.5 * speed : 0.2 * speed;
}

bool rests(const SheetState& state) {
  double sum = 0;
  for (std::size_t m = 0; m < modes; ++m) sum += state.x[m] * state.x[m] + 1e-3 * state.v[m] * state.v[m];
  return sum < 1e-10;
}

std::vector<float> positions(const SheetState& state, int side) {
  std::vector<float> result;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double a = std::numbers::pi * column / (side - 1), b = std::numbers::pi * row / (side - 1);
      double height = 0, slope_x = 0, slope_y = 0;
      for (std::size_t m = 0; m < modes; ++m) {
        const double i = wave_x(m), j = wave_y(m);
        height += state.x[m] * std::sin(i * a) * std::sin(j * b);
        slope_x += state.x[m] * i * std::cos(i * a) * std::sin(j * b);
        slope_y += state.x[m] * j * std::sin(i * a) * std::cos(j * b);
      }
      const double bend = std::numbers::pi / length;
      result.push_back(static_cast<float>(length * column / (side - 1) - height * slope_x * bend));
      result.push_back(static_cast<float>(length * row / (side - 1) - height * slope_y * bend));
      result.push_back(static_cast<float>(height));
    }
  }
  return result;
}

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  /// 0 .. count - 1.
  int roll(int count) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<int>((state_ >> 33U) % static_cast<std::uint64_t>(count));
  }

 private:
  std::uint64_t state_;
};

/// An orbit's states and where they stand in the file.
struct PlayedOrbit {
  std::uint64_t first_frame = 0;
  std::vector<SheetState> states{};
};

}  // namespace

TrajectoryScene sheet_scene(const DampedSheet& sheet) {
  TrajectoryScene scene;
  scene.time_step = step;
  scene.rest = positions({}, sheet.side);
  for (int row = 0; row + 1 < sheet.side; ++row) {
    for (int column = 0; column + 1 < sheet.side; ++column) {
      const auto a = static_cast<std::uint32_t>(row * sheet.side + column);
      const auto b = a + static_cast<std::uint32_t>(sheet.side);
      scene.triangles.insert(scene.triangles.end(), {a, a + 1, b, b, a + 1, b + 1});
    }
  }
  for (const char* name : {"up", "down", "askew"}) {
    Impulse impulse;
    impulse.name = name;
    impulse.initial[0] = static_cast<double>(scene.impulses.size());
    scene.impulses.push_back(impulse);
  }
  scene.successions.assign(12, 1);
  scene.provenance = R"({"source": "damped sheet"})";
  return scene;
}

void write_sheet(const std::filesystem::path& path, const DampedSheet& sheet) {
  const int count = sheet.orbits + sheet.held_out;
  const auto orbits = static_cast<std::uint64_t>(count);
  auto writer = TrajectoryWriter::create(path, sheet_scene(sheet), {.frames = orbits * 1000, .orbits = orbits});
  Dice dice(sheet.seed);
  PlayedOrbit before;
  for (int k = 0; k < count; ++k) {
    PlayedOrbit orbit;
    SheetState state;
    std::int64_t previous = -1;
    if (!before.states.empty() && dice.roll(3) != 0) {
      const int frame = 4 + dice.roll(40);
      state = before.states[static_cast<std::size_t>(frame)];
      previous = static_cast<std::int64_t>(before.first_frame) + frame - 1;
    }
    const int built = k - sheet.held_out;
    const auto impulse = static_cast<std::uint32_t>(built >= 0 && built < 3 ? built : dice.roll(3));
    const bool to_rest = sheet.comes_to_rest && k % 3 == 0;
    const int frames = to_rest ? 1000 : shortest + dice.roll(longest - shortest);
    writer.begin_orbit(impulse, previous, built < 0);
    for (int f = 0; f < frames && !(to_rest && f > 45 && rests(state)); ++f) {
      const auto number = writer.add_frame(positions(state, sheet.side));
      if (f == 0) orbit.first_frame = number;
      orbit.states.push_back(state);
      if (f == 0) kick(impulse, state);
      state = later(state);
    }
    writer.end_orbit(to_rest);
    before = std::move(orbit);
  }
  writer.close();
}

}  // namespace greenloop::offline
