#include "sim_hw/device/script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "sim_hw/device/touch_place.hpp"

namespace greenloop {
namespace {

/// Writes down the segments of one probe. Between places it travels on a sphere around the whole body.
class Track {
 public:
  Track(const BodySurface& surface, const ProbeSize& probe)
      : centre_(surface.centre), shell_(0.5 * surface.diagonal + 2 * probe.radius), depth_(probe.depth) {}

  /// The point of the shell from where the place is reached along its outward direction.
  [[nodiscard]] Double3 above(const TouchPlace& place) const {
    const Double3 from = place.centre - centre_;
    const double along = dot(from, place.outward);
    return place.centre + (std::sqrt(along * along + shell_ * shell_ - dot(from, from)) - along) * place.outward;
  }

  void begin_above(const TouchPlace& place) { start_ = at_ = above(place); }

  void move(double duration, std::vector<Double3> knots) { turn(duration, std::move(knots), turned_); }

  /// The same, while it turns: see MotionSegment.
  void turn(double duration, std::vector<Double3> knots, const Double3& turned_to) {
    knots.insert(knots.begin(), at_);
    at_ = knots.back();
    elapsed_ += duration;
    segments_.push_back({duration, std::move(knots), turned_, turned_to});
    turned_ = turned_to;
  }

  void wait(double duration) { move(duration, {}); }

  void press_in(const TouchPlace& place) {
    move(0.8, {over(place)});
    move(1.0, {pressed(place)});
  }

  void lift(const TouchPlace& place) {
    move(1.0, {over(place)});
    move(0.8, {above(place)});
  }

  [[nodiscard]] Double3 pressed(const TouchPlace& place) const { return place.centre - depth_ * place.outward; }

  void travel(const Double3& to) { move(1.0, arc(unit(at_ - centre_), unit(to - centre_))); }
  void travel_home() { travel(start_); }

  /// A little above a place, where it does not touch.
  [[nodiscard]] Double3 over(const TouchPlace& place) const { return place.centre + (0.5 * depth_) * place.outward; }
  [[nodiscard]] double depth() const { return depth_; }

  [[nodiscard]] double elapsed() const { return elapsed_; }
  [[nodiscard]] std::vector<MotionSegment> segments() && { return std::move(segments_); }

 private:
  /// Round the body from direction `a` to `b`; between opposite ones with a bulge to the side.
  [[nodiscard]] std::vector<Double3> arc(const Double3& a, const Double3& b) const {
    constexpr int pieces = 16;
    const double bulge = dot(a, b) < -0.5 ? 1 : 0;
    const Double3 side = perpendicular(a);
    std::vector<Double3> knots;
    for (int i = 1; i <= pieces; ++i) {
      const double s = static_cast<double>(i) / pieces;
      const Double3 direction = (1 - s) * a + s * b + (4 * s * (1 - s) * bulge) * side;
      knots.push_back(centre_ + shell_ * unit(direction));
    }
    return knots;
  }

  Double3 centre_;
  double shell_, depth_;
  Double3 start_, at_, turned_;
  double elapsed_ = 0;
  std::vector<MotionSegment> segments_;
};

void press(Track& track, const std::vector<TouchPlace>& places) {
  for (const TouchPlace& place : places) {
    track.travel(track.above(place));
    track.press_in(place);
    track.wait(0.5);
    track.lift(place);
  }
}

std::vector<Double3> pressed_along(const Track& track, const std::vector<TouchPlace>& row) {
  std::vector<Double3> there;
  for (const TouchPlace& place : row) there.push_back(track.pressed(place));
  return there;
}

std::vector<Double3> reversed(std::vector<Double3> knots) {
  std::reverse(knots.begin(), knots.end());
  return knots;
}

void slide(Track& track, const std::vector<TouchPlace>& row) {
  const std::vector<Double3> there = pressed_along(track, row);
  track.travel(track.above(row.front()));
  track.press_in(row.front());
  track.move(2.0, there);
  track.move(2.0, reversed(there));
  track.lift(row.front());
}

// a ball of this radius rolls along a row and back
void roll(Track& track, const std::vector<TouchPlace>& row, double radius) {
  const std::vector<Double3> there = pressed_along(track, row);
  const Double3 way = there.back() - there.front();
  const double quarter = 0.25 * norm(way) / radius;  // of the angle; its tangent follows
  const Double3 turned = (quarter + quarter * quarter * quarter / 3) * unit(cross(row.front().outward, way));
  track.travel(track.above(row.front()));
  track.press_in(row.front());
  track.turn(2.0, there, turned);
  track.turn(2.0, reversed(there), {});
  track.lift(row.front());
}

// falls on places and bounces off
void drop(Track& track, const std::vector<TouchPlace>& places) {
  for (const TouchPlace& place : places) {
    track.travel(track.above(place));
    track.move(0.05, {track.pressed(place)});
    track.move(0.05, {track.above(place)});
    track.wait(0.2);
  }
}

// comes and goes, again and again
void flap(Track& track, const TouchPlace& place) {
  constexpr int times = 12;
  track.travel(track.above(place));
  track.move(0.5, {track.over(place)});
  for (int i = 0; i < times; ++i) {
    track.move(0.1, {track.pressed(place)});
    track.move(0.1, {track.over(place)});
  }
  track.lift(place);
}

using Pair = std::array<TouchPlace, 2>;

void begin_pair(Track& first, Track& second, const Pair& places) {
  second.wait(first.elapsed() - second.elapsed());
  const std::array<Track*, 2> tracks{&first, &second};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i]->travel(tracks[i]->above(places[i]));
    tracks[i]->press_in(places[i]);
  }
}

// two probes hold the body between them and pull it to the side by friction
void grasp(Track& first, Track& second, const Pair& places) {
  begin_pair(first, second, places);
  const Double3 aside = 0.5 * first.depth() * perpendicular(places[0].outward);
  const std::array<Track*, 2> tracks{&first, &second};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i]->move(0.5, {tracks[i]->pressed(places[i]) + aside});
    tracks[i]->move(0.5, {tracks[i]->pressed(places[i])});
    tracks[i]->lift(places[i]);
  }
}

// two probes squeeze it, again and again
void pinch(Track& first, Track& second, const Pair& places) {
  constexpr int times = 3;
  begin_pair(first, second, places);
  const std::array<Track*, 2> tracks{&first, &second};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (int k = 0; k < times; ++k) {
      tracks[i]->move(0.3, {places[i].centre});
      tracks[i]->move(0.3, {tracks[i]->pressed(places[i])});
    }
    tracks[i]->lift(places[i]);
  }
}

/// Whole numbers, the same everywhere (Marsaglia's xorshift).
class Dice {
 public:
  /// 0 .. sides - 1.
  std::size_t roll(std::size_t sides) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<std::size_t>((state_ >> 11) % sides);
  }
  /// From `low` to `high` in steps of a sixteenth.
  double between(double low, double high) { return low + (high - low) * static_cast<double>(roll(17)) / 16; }

 private:
  std::uint64_t state_ = 0x9e3779b97f4a7c15;
};

// presses at a place, drags aside and lets go
void touch_somewhere(Track& track, const TouchPlace& place, Dice& dice) {
  const Double3 tangent = perpendicular(place.outward), other = cross(place.outward, tangent);
  const auto beside = [&](double depth) {
    const double most = 1.5 * track.depth();
    return place.centre - (depth * track.depth()) * place.outward + dice.between(-most, most) * tangent +
           dice.between(-most, most) * other;
  };
  const double pace = dice.between(0.1, 0.8);
  track.travel(track.above(place));
  track.move(0.3, {track.over(place)});
  track.move(pace, {beside(dice.between(0.2, 1))});
  for (std::size_t times = dice.roll(4); times > 0; --times) {
    const Double3 turned = dice.between(-0.2, 0.2) * place.outward;
    track.turn(dice.between(0.1, 0.8), {beside(dice.between(0.2, 1))}, turned);
    if (dice.roll(3) == 0) track.wait(0.3);
  }
  track.turn(pace, {track.over(place)}, {});
  track.move(0.3, {track.above(place)});
}

// everything, for so many seconds
void at_random(Track& first, Track* second, const std::vector<TouchPlace>& places, const std::optional<Pair>& pair,
               double seconds) {
  Dice dice;
  while (first.elapsed() < seconds) {
    const bool holds = second != nullptr && pair && dice.roll(6) == 0;
    if (holds) {
      const double later = std::max(first.elapsed(), second->elapsed());
      first.wait(later - first.elapsed());
      second->wait(later - second->elapsed());
      (dice.roll(2) == 0 ? pinch : grasp)(first, *second, *pair);
      continue;
    }
    Track& track = second != nullptr && second->elapsed() < first.elapsed() ? *second : first;
    touch_somewhere(track, places[dice.roll(places.size())], dice);
  }
}

/// Probes beyond the two of the scripts, each with a place of its own where there are as many.
void press_beside(std::vector<Track>& tracks, const BodySurface& surface, const ProbeSize& probe, std::size_t probes) {
  constexpr int times = 3;
  if (probes <= 2) return;
  const std::vector<TouchPlace> places = touch_places(surface, probe.radius, probes);
  for (std::size_t i = 2; i < probes; ++i) {
    const TouchPlace& place = places[i % places.size()];
    Track& track = tracks.emplace_back(surface, probe);
    track.begin_above(place);
    press(track, std::vector<TouchPlace>(times, place));
  }
}

std::vector<MotionScript> finish(std::vector<Track> tracks, double seconds) {
  std::vector<MotionScript> scripts;
  for (Track& track : tracks) {
    track.travel_home();
    scripts.emplace_back(std::move(track).segments(), seconds);
  }
  return scripts;
}

}  // namespace

ProbeSize probe_size(const BodySurface& surface) {
  const double radius = std::max(0.06 * surface.diagonal, 1.2 * surface.spacing);
  return {radius, 0.75 * radius};
}

std::vector<MotionScript> make_script(Script script, const BodySurface& surface, const ProbeSize& probe, double seconds,
                                      std::size_t probes) {
  const std::vector<TouchPlace> places = touch_places(surface, probe.radius, 3);
  const bool wants_pair =
      script == Script::random || script == Script::grasp || script == Script::pinch || script == Script::all;
  const auto pair = wants_pair && probes > 1 ? opposing_places(surface, probe.radius) : std::nullopt;
  if (wants_pair && script != Script::all && script != Script::random && !pair) {
    throw std::runtime_error("--script " + std::string(script_names[static_cast<std::size_t>(script)]) +
                             ": there are no two probes, or no two places that they could hold; use press");
  }
  std::vector<Track> tracks(1, Track(surface, probe));
  Track& first = tracks[0];
  const auto row = [&] { return sliding_row(surface, probe.radius, 0.15 * surface.diagonal, places); };
  first.begin_above(places.front());
  switch (script) {
    case Script::press:
    case Script::lose_messages:
      press(first, places);
      break;
    case Script::slide:
      slide(first, row());
      break;
    case Script::all:
      press(first, places);
      slide(first, row());
      break;
    case Script::roll:
      roll(first, row(), probe.radius);
      break;
    case Script::drop:
      drop(first, places);
      break;
    case Script::flap:
      flap(first, places.front());
      break;
    case Script::tilt:
      press(first, {places.front()});
      break;
    case Script::random:
    case Script::grasp:
    case Script::pinch:
      break;
  }
  if (script == Script::random) {
    if (pair) tracks.emplace_back(surface, probe).begin_above((*pair)[1]);
    at_random(tracks[0], pair ? &tracks[1] : nullptr, touch_places(surface, probe.radius, 12), pair, seconds);
  } else if (pair) {
    tracks.emplace_back(surface, probe).begin_above((*pair)[1]);
    (script == Script::pinch ? pinch : grasp)(tracks[0], tracks[1], *pair);
  }
  press_beside(tracks, surface, probe, probes);
  return finish(std::move(tracks), seconds);
}

}  // namespace greenloop
