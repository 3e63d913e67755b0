#include "sim_hw/device/script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
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

  void move(double duration, std::vector<Double3> knots, const Double3& axis) {
    knots.insert(knots.begin(), at_);
    at_ = knots.back();
    elapsed_ += duration;
    segments_.push_back({duration, std::move(knots), axis});
  }

  void wait(double duration) { move(duration, {}, segments_.empty() ? Double3{0, 0, -1} : segments_.back().axis); }

  void press_in(const TouchPlace& place) {
    move(0.8, {place.centre + (0.5 * depth_) * place.outward}, -place.outward);
    move(1.0, {pressed(place)}, -place.outward);
  }

  void lift(const TouchPlace& place) {
    move(1.0, {place.centre + (0.5 * depth_) * place.outward}, -place.outward);
    move(0.8, {above(place)}, -place.outward);
  }

  [[nodiscard]] Double3 pressed(const TouchPlace& place) const { return place.centre - depth_ * place.outward; }

  void travel(const Double3& to, const Double3& axis) { move(1.0, arc(unit(at_ - centre_), unit(to - centre_)), axis); }
  void travel_home() { travel(start_, segments_.back().axis); }

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
  Double3 start_, at_;
  double elapsed_ = 0;
  std::vector<MotionSegment> segments_;
};

void press(Track& track, const std::vector<TouchPlace>& places) {
  for (const TouchPlace& place : places) {
    track.travel(track.above(place), -place.outward);
    track.press_in(place);
    track.wait(0.5);
    track.lift(place);
  }
}

void slide(Track& track, const std::vector<TouchPlace>& row) {
  std::vector<Double3> there, back;
  for (const TouchPlace& place : row) there.push_back(track.pressed(place));
  std::copy(there.rbegin(), there.rend(), std::back_inserter(back));
  const Double3 axis = -row.front().outward;
  track.travel(track.above(row.front()), axis);
  track.press_in(row.front());
  track.move(2.0, there, axis);
  track.move(2.0, back, axis);
  track.lift(row.front());
}

void grasp(Track& first, Track& second, const std::array<TouchPlace, 2>& places) {
  second.wait(first.elapsed() - second.elapsed());
  const std::array<Track*, 2> tracks{&first, &second};
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i]->travel(tracks[i]->above(places[i]), -places[i].outward);
    tracks[i]->press_in(places[i]);
    tracks[i]->wait(1.0);
    tracks[i]->lift(places[i]);
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
  const bool wants_grasp = probes > 1 && (script == Script::grasp || script == Script::all);
  const auto pair = wants_grasp ? opposing_places(surface, probe.radius) : std::nullopt;
  if (script == Script::grasp && !pair) {
    throw std::runtime_error(
        "--script grasp: there are no two probes, or no two places that they could hold; use press");
  }
  std::vector<Track> tracks(1, Track(surface, probe));
  tracks[0].begin_above(places.front());
  if (script == Script::press || script == Script::all) press(tracks[0], places);
  if (script == Script::slide || script == Script::all) {
    slide(tracks[0], sliding_row(surface, probe.radius, 0.15 * surface.diagonal, places));
  }
  if (pair) {
    tracks.emplace_back(surface, probe).begin_above((*pair)[1]);
    grasp(tracks[0], tracks[1], *pair);
  }
  press_beside(tracks, surface, probe, probes);
  return finish(std::move(tracks), seconds);
}

}  // namespace greenloop
