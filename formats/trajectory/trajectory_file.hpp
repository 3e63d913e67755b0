#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace greenloop {

// Simulated motions of a scene in HDF5, from any program (docs/trajectories.md). Frames are positions of all vertices.
// An *orbit* is a sequence of frames that an impulse began: its first frame is the state that the impulse met, the second
// the first that shows what it does.

/// An impulse of the palette, as the scene means it (James & Fatahalian 2003, section 3.3).
struct Impulse {
  std::string name;
  std::array<double, 4> initial{};     ///< alpha^I, in the first step
  std::array<double, 4> persistent{};  ///< alpha^F, in all others
};

struct TrajectoryOrbit {
  std::uint64_t first_frame = 0;
  std::uint64_t frames = 0;         ///< >= 2
  std::uint32_t impulse = 0;        ///< of the palette
  bool at_rest = false;             ///< whether it has come to rest in its last frame
  std::int64_t previous_frame = -1;  ///< the frame before its first one, in the orbit that it interrupts; -1: it was at rest
};

/// All that a file says but for the frames themselves.
struct TrajectoryScene {
  double time_step = 0;                  ///< s, between two frames
  std::vector<float> rest;               ///< m, [vertices][3]: the scene at rest, where every motion begins and ends
  std::vector<std::uint32_t> triangles;  ///< [triangles][3], of what is shown
  std::vector<Impulse> impulses;
  std::vector<std::uint8_t> successions;  ///< [impulses + 1][impulses]: 1 if the second may follow the first; last: at rest
  std::vector<TrajectoryOrbit> orbits;
  std::string provenance;  ///< JSON

  [[nodiscard]] std::size_t vertices() const { return rest.size() / 3; }
};

}  // namespace greenloop
