#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "sim_hw/body/body_surface.hpp"
#include "sim_hw/device/motion_script.hpp"

namespace greenloop {

enum class Script { press, slide, grasp, all, pinch, roll, drop, flap, tilt, lose_messages, random };

inline constexpr std::string_view script_names[] = {"press", "slide", "grasp", "all",           "pinch", "roll",
                                                    "drop",  "flap",  "tilt",  "lose-messages", "random"};

/// What the scripts move: spheres, and how deep the person tries to push them in.
struct ProbeSize {
  double radius = 0;  ///< m
  double depth = 0;   ///< m, that the target goes beyond the first touch
};

/// 6 % of the body's diagonal, but never so small that it slips between the nodes; half as deep as wide.
[[nodiscard]] ProbeSize probe_size(const BodySurface& surface);

/// Scripted motions of at most `probes` (at least 1) probes around and into the body; one round takes `seconds`.
/// press: into up to three places, one after the other. slide: press, and to and fro along the surface.
/// grasp: two probes from opposite sides, which then pull the body to the side by friction. all: press, slide, grasp;
/// without grasp where no two places exist, or probes. pinch: the same two squeeze, again and again. roll: as slide,
/// but the probe rolls. drop: falls on the places. flap: comes and goes quickly. tilt and lose-messages: press. random:
/// all of these mixed, at random places, depths and speeds, the same in every run, about a round of 2 s after the
/// other. Each probe beyond the second presses a place of its own, as far from those of the others as there is one.
/// Throws std::runtime_error if the body offers no place, or `grasp` or `pinch` is asked for and there are no two.
[[nodiscard]] std::vector<MotionScript> make_script(Script script, const BodySurface& surface, const ProbeSize& probe,
                                                    double seconds, std::size_t probes = 2);

}  // namespace greenloop
