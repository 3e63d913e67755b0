#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

struct WrapOptions {
  std::optional<double> length;  ///< spacing of the lattice, in the mesh's unit; none: chosen, see wrap
  bool largest_piece = false;    ///< keep the largest of several pieces, however large the others are
  double rounding = 0;           ///< radius, in the mesh's unit, of what is told apart (see round_solid); 0: none
};

/// As many lattice points, at most; 40 bytes each, 700 MB together.
inline constexpr std::size_t most_lattice_points = std::size_t{1} << 24;

/// Distances between two surfaces, in the mesh's unit.
struct Deviation {
  double greatest = 0, rms = 0;
};

/// What wrapping found and changed; lengths in the mesh's unit.
struct WrapReport {
  double length = 0;
  std::size_t lattice_points = 0;

  // what was given
  std::size_t boundary_loops = 0, misoriented_edges = 0;
  std::optional<std::size_t> crossing_pairs;  ///< none: too many to be counted
  std::size_t useless_faces = 0;              ///< without an area, or the same as another
  std::optional<double> volume_before;        ///< if closed and oriented; what several pieces enclose counts for each

  // what came of it
  std::size_t triangles = 0;
  double volume = 0;
  double rounding = 0;                    ///< radius, if it was rounded
  std::optional<double> plate_thickness;  ///< if it was an open sheet
  std::size_t pieces_dropped = 0;         ///< beside the one that was kept
  double dropped_share = 0;               ///< of the volume of all pieces
  double inner_share = 0;                 ///< of the faces' area: inside the body,
  double sheet_share = 0;                 ///< with nothing behind,
  double thin_share = 0;                  ///< of parts or gaps that are thinner than the length
  std::size_t filled_shells = 0;          ///< pieces of the surface that lie inside the body
  Deviation from_original, to_original;   ///< from what is seen of the original from outside, and to it
  std::size_t held_back = 0;              ///< vertices kept off the original so that no faces cross
};

struct Wrapped {
  TriangleMesh mesh;
  WrapReport report;
};

/// The body is thinner than the length everywhere.
class NothingLeft : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A closed, evenly meshed, outward oriented surface in one piece around the body that any faces stand for: they may
/// have holes, cross each other, look anywhere. Inside is what cannot be reached from outside but through holes half
/// as wide as what is behind them (see find_rooms). If more than half of the area has nothing behind it, it is a sheet
/// and becomes a plate three lengths thick. Sharp edges are kept where they pass (see sharpen). Hollows are filled.
///
/// The length is at most an eighth of the longest side of the bounding box. If none is given: half the median edge, or
/// a quarter of the shortest side if that is less, between 1/160 and 1/64 of the longest side, and no less than what
/// makes some 70,000 triangles.
///
/// With `rounding`, parts thinner than twice its radius are thickened to it, even those that the length does not tell,
/// narrower gaps closed, edges rounded, and the largest piece kept of what is left; the length is half of it at most,
/// if none is given.
///
/// Throws std::runtime_error, naming the number, if the length is too short for most_lattice_points or too long, if no
/// face has an area, NothingLeft if the length resolves nothing, and std::runtime_error if there is more than one piece
/// of at least a twentieth of the largest one's volume. The same bits on any number of processors. Work: linear in
/// lattice points and n log n in faces.
[[nodiscard]] Wrapped wrap(const TriangleMesh& mesh, const WrapOptions& options = {});

/// What was found and changed, one sentence each.
[[nodiscard]] std::vector<std::string> describe_wrap(const WrapReport& report, const std::string& unit);

}  // namespace greenloop::offline
