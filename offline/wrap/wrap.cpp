#include "offline/wrap/wrap.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "offline/remesh/triangle_tree.hpp"
#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/coincident_vertices.hpp"
#include "offline/surface/surface_edges.hpp"
#include "offline/surface/surface_report.hpp"
#include "offline/surface/triangle_intersection.hpp"
#include "offline/wrap/crossings.hpp"
#include "offline/wrap/deviation.hpp"
#include "offline/wrap/lattice.hpp"
#include "offline/wrap/level_set.hpp"
#include "offline/wrap/rooms.hpp"
#include "offline/wrap/rounding.hpp"
#include "offline/wrap/sharp_surface.hpp"
#include "offline/wrap/solid.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double plate_offset = 1.5;  // lengths to either side of a sheet

double triangle_quality(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

/// The faces that have an area, each once, with one vertex for each place.
TriangleMesh usable_faces(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices, {}};
  const auto first = first_coincident_vertex(mesh.vertices);
  std::set<std::array<int, 3>> seen;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<int, 3> triangle{first[a], first[b], first[c]};
    auto corners = triangle;
    std::sort(corners.begin(), corners.end());
    if (triangle_quality(mesh, triangle) > smallest_quality && seen.insert(corners).second) {
      result.triangles.push_back(triangle);
    }
  }
  if (result.triangles.empty()) throw std::runtime_error("wrap: no face has an area; there is nothing to wrap");
  return result;
}

Eigen::AlignedBox3d box_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const int v : triangle) box.extend(mesh.vertices[v]);
  }
  return box;
}

double median_edge(const TriangleMesh& mesh) {
  std::vector<double> lengths;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) lengths.push_back((mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).norm());
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

double automatic_length(const TriangleMesh& mesh, const Vector3d& sides) {
  const double longest = sides.maxCoeff();
  const double flattest = sides.minCoeff() > 0 ? sides.minCoeff() / 4 : longest;
  const double coarsest = longest / 64;
  const double finest = std::max(longest / 160, std::sqrt(surface_area(mesh) / 25'000));  // some 70,000 triangles
  return std::clamp(std::min(median_edge(mesh) / 2, flattest), std::min(finest, coarsest), coarsest);
}

/// A lattice around the body, and where its origin lies.
struct Frame {
  double length;
  Vector3d origin;
  Lattice lattice;

  [[nodiscard]] TriangleMesh to_lattice(TriangleMesh mesh) const {
    for (auto& v : mesh.vertices) v = (v - origin) / length;
    return mesh;
  }
  void from_lattice(TriangleMesh& mesh) const {
    for (auto& v : mesh.vertices) v = origin + length * v;
  }
};

constexpr double margin = 5;  // free points around the body

double points_at(const Vector3d& sides, double length) {
  return ((sides / length).array() + 2 * margin + 1).ceil().prod();
}

/// The shortest length that most_lattice_points allow, rounded up.
double shortest_length(const Vector3d& sides) {
  double length = sides.maxCoeff();
  while (points_at(sides, length / 1.02) <= static_cast<double>(most_lattice_points)) length /= 1.02;
  return length;
}

Frame place_lattice(const TriangleMesh& mesh, const std::optional<double>& asked, double rounding) {
  auto box = box_of(mesh);
  Vector3d sides = box.sizes();
  double length = asked.value_or(automatic_length(mesh, sides));
  if (length > sides.maxCoeff() / 8) {
    throw std::runtime_error(fmt::format(
        "wrap: a length of {:.3g} is too long for a body of {:.3g}; it may be {:.3g}, an eighth of that, at most",
        length, sides.maxCoeff(), sides.maxCoeff() / 8));
  }
  if (points_at(sides, length) > static_cast<double>(most_lattice_points)) {
    throw std::runtime_error(
        fmt::format("wrap: a length of {:.3g} takes a lattice of {:.3g} points; there may be {}, which a length of "
                    "{:.3g} takes",
                    length, points_at(sides, length), most_lattice_points, shortest_length(sides)));
  }
  box.min().array() -= rounding;
  box.max().array() += rounding;
  sides = box.sizes();
  if (rounding > 0 && !asked) length = std::max(std::min(length, rounding / 2), shortest_length(sides));
  // off round numbers, where faces of CAD bodies lie
  const Vector3d shift(0.3819660113, 0.2360679775, 0.5278640450);
  Lattice lattice{};
  for (int a = 0; a < 3; ++a) lattice.size[a] = static_cast<int>(std::ceil(sides[a] / length + 2 * margin + 1));
  return {length, box.min() - length * (Vector3d::Constant(margin) + shift), lattice};
}

/// Loops of edges that only one face has.
std::size_t count_loops(const std::vector<std::array<int, 2>>& edges, std::size_t vertices) {
  DisjointSets loops(vertices);
  std::vector<int> ends;
  for (const auto& [a, b] : edges) {
    loops.unite(a, b);
    ends.push_back(a);
  }
  std::transform(ends.begin(), ends.end(), ends.begin(), [&](int v) { return loops.find(v); });
  std::sort(ends.begin(), ends.end());
  return static_cast<std::size_t>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

void describe_input(const TriangleMesh& mesh, WrapReport& report) {
  const SurfaceReport found = check_connectivity(mesh);
  report.boundary_loops = count_loops(found.boundary_edges, mesh.vertices.size());
  report.misoriented_edges = found.misoriented_edges.size();
  if (found.volume != 0) report.volume_before = std::abs(found.volume);
  try {
    report.crossing_pairs = self_intersections(mesh, std::vector<bool>(mesh.triangles.size(), false)).size();
  } catch (const std::runtime_error&) {
    report.crossing_pairs.reset();
  }
}

/// Negative inside.
std::vector<float> signed_distance(const std::vector<float>& distance, const Rooms& rooms) {
  constexpr float off_the_surface = 0.01F;
  std::vector<float> field(distance.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const float away = std::max(distance[i], off_the_surface);
    field[i] = rooms.inside(i) ? -away : away;
  }
  return field;
}

/// The faces themselves get a thickness; what they enclose stays inside.
void thicken(std::vector<float>& field) {
  constexpr auto offset = static_cast<float>(plate_offset);
  for (float& value : field) {
    value = value < 0 ? std::max(-band, value - offset) : value - offset;
  }
}

/// How much of the faces' area ...
struct Sides {
  double inner = 0;  ///< ... lies inside,
  double sheet = 0;  ///< ... has the outside on both sides,
  double thin = 0;   ///< ... lies so close to other faces that the lattice does not tell: shares
  std::size_t filled_shells = 0;
};

Sides measure_sides(const std::vector<float>& field, const TriangleMesh& mesh, const std::vector<Crossing>& crossings,
                    const Lattice& lattice) {
  const auto area = area_of_crossing(mesh);
  DisjointSets pieces(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    pieces.unite(a, b);
    pieces.unite(b, c);
  }
  enum Seen : std::uint8_t { nothing, inside, outside };
  std::vector<std::uint8_t> seen(mesh.vertices.size(), nothing);
  Sides sides;
  double total = 0;
  for (const auto& crossing : crossings) {
    const bool a = field[crossing.point] < 0, b = field[crossing.next_point(lattice)] < 0;
    const auto face = static_cast<std::size_t>(crossing.face);
    total += area[face];
    if (a == b) (!crossing.alone ? sides.thin : a ? sides.inner : sides.sheet) += area[face];
    auto& piece = seen[pieces.find(mesh.triangles[face][0])];
    piece = a && b && piece != outside ? inside : outside;
  }
  for (double* share : {&sides.inner, &sides.sheet, &sides.thin}) *share /= std::max(total, 1.0);
  sides.filled_shells = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), inside));
  return sides;
}

/// Parts that the lattice does not tell get a point inside.
void keep_thin_parts(std::vector<float>& field, const std::vector<Crossing>& crossings, const Lattice& lattice) {
  constexpr float just_inside = -0.05F;
  std::vector<std::size_t> points;
  for (const auto& crossing : crossings) {
    const bool outside = field[crossing.point] >= 0 && field[crossing.next_point(lattice)] >= 0;
    if (outside && !crossing.alone) points.push_back(crossing.point);
  }
  for (const std::size_t point : points) field[point] = just_inside;
}

void require_one_piece(const Pieces& pieces, bool largest_piece, double length) {
  if (pieces.empty()) {
    throw NothingLeft(fmt::format(
        "wrap: the body is thinner than a length of {:.3g} everywhere, so that nothing is left; choose a shorter one",
        length));
  }
  const auto large = static_cast<std::size_t>(
      std::count_if(pieces.begin(), pieces.end(), [&](std::size_t points) { return 20 * points >= pieces[0]; }));
  if (large > 1 && !largest_piece) {
    const double volume = length * length * length;
    throw std::runtime_error(
        fmt::format("wrap: {} separate pieces, of volumes {:.3g}, {:.3g}{}; a model is one body: keep the largest by "
                    "pieces = \"largest\", or join them by a length longer than the gap between them",
                    large, volume * static_cast<double>(pieces[0]), volume * static_cast<double>(pieces[1]),
                    large > 2 ? ", ..." : ""));
  }
}

}  // namespace

Wrapped wrap(const TriangleMesh& input, const WrapOptions& options) {
  Wrapped result;
  auto& report = result.report;
  TriangleMesh mesh = usable_faces(input);
  report.useless_faces = input.triangles.size() - mesh.triangles.size();
  const Frame frame = place_lattice(mesh, options.length, options.rounding);
  const Lattice& lattice = frame.lattice;
  report.length = frame.length;
  report.lattice_points = lattice.count();
  describe_input(mesh, report);

  mesh = frame.to_lattice(std::move(mesh));
  const auto crossings = find_crossings(mesh, lattice);
  const auto distance = unsigned_distance(mesh, lattice);
  auto field = signed_distance(distance, find_rooms(distance, mesh, crossings, lattice));
  const Sides sides = measure_sides(field, mesh, crossings, lattice);
  report.inner_share = sides.inner;
  report.sheet_share = sides.sheet;
  report.thin_share = sides.thin;
  report.filled_shells = sides.filled_shells;
  const bool plate = sides.sheet > 0.5;
  if (plate) thicken(field);
  double plate_half = plate_offset;
  const bool rounded = options.rounding > 0;
  if (rounded) {
    const double radius = options.rounding / frame.length;
    keep_thin_parts(field, crossings, lattice);
    round_solid(field, lattice, radius);
    report.rounding = options.rounding;
    plate_half = std::max(plate_half, radius);
  }
  const Pieces pieces = keep_largest_piece(field, lattice);
  require_one_piece(pieces, options.largest_piece || rounded, frame.length);
  std::size_t dropped = 0;
  for (std::size_t i = 1; i < pieces.size(); ++i) dropped += pieces[i];
  report.pieces_dropped = pieces.size() - 1;
  report.dropped_share = static_cast<double>(dropped) / static_cast<double>(dropped + pieces[0]);
  make_well_composed(field, lattice);

  const QuadSurface zero = zero_surface(field, lattice);
  const TriangleTree tree(mesh);
  SharpSurface sharp = plate || rounded ? split_quads(zero) : sharpen(zero, mesh, tree);
  result.mesh = std::move(sharp.mesh);
  report.held_back = sharp.held_back;
  report.triangles = result.mesh.triangles.size();
  const double offset = plate ? plate_half : 0;
  if (plate) report.plate_thickness = 2 * plate_half * frame.length;
  const TriangleTree wrapped(result.mesh);
  const auto in_unit = [&](Deviation d) { return Deviation{d.greatest * frame.length, d.rms * frame.length}; };
  report.from_original = in_unit(deviation(places_on_skin(mesh, crossings, field, lattice), wrapped, offset));
  report.to_original = in_unit(deviation(places_on(result.mesh, sharp.follows), tree, offset));
  frame.from_lattice(result.mesh);
  report.volume = enclosed_volume(result.mesh);
  return result;
}

}  // namespace greenloop::offline
