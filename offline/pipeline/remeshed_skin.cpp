#include "offline/pipeline/remeshed_skin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/shells.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

/// Radii of rounding, in edges of a finest triangle, in the order in which they are tried.
constexpr std::array roundings{0.0, 1.0, 2.0, 4.0};
/// Attempts that a rung may take before the next one is.
constexpr double most_work = 6;

RemeshOptions options_of(const Scene& scene) {
  RemeshOptions options;
  options.base_vertices = scene.remesh.base_vertices;
  options.levels = scene.remesh.levels;
  return options;
}

/// "2 repairs: ...; ..."
std::string repairs_text(const std::vector<std::string>& repairs) {
  return fmt::format("{} repair{}{}{}", repairs.size(), repairs.size() == 1 ? "" : "s", repairs.empty() ? "" : ": ",
                     fmt::join(repairs, "; "));
}

/// ", 2 cavities of 0.0012 m3"
std::string cavities_text(const PreparedSurface& surface) {
  if (surface.cavities.empty()) return "";
  return fmt::format(", {} {} of {:.3g} m3", surface.cavities.size(),
                     surface.cavities.size() == 1 ? "cavity" : "cavities", volume_of_all(surface.cavities));
}

std::string surface_text(const PreparedSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const auto& v : surface.mesh.vertices) box.extend(v);
  const Eigen::Vector3d sides = box.sizes();
  return fmt::format("{} vertices, {} triangles, {:.3g} x {:.3g} x {:.3g} m, {}{}", surface.report.vertex_count,
                     surface.report.triangle_count, sides.x(), sides.y(), sides.z(), repairs_text(surface.repairs),
                     cavities_text(surface));
}

std::string quality_text(const Remeshed& remeshed) {
  const auto& quality = remeshed.quality;
  return fmt::format(
      "{} vertices on {} levels over {}, smallest angle {:.1f} degrees, Hausdorff {:.2f} % of the diagonal, "
      "{:.3g} mm off the surface, the surface {:.3g} mm off it, volume {:+.2f} %",
      remeshed.mesh.positions.size(), quality.levels + 1, quality.base_vertices, quality.smallest_angle_degrees,
      100 * quality.hausdorff_relative, 1e3 * quality.farthest_of_mesh, 1e3 * quality.farthest_of_input,
      100 * quality.volume_change);
}

/// What the best of all bases came to, in a line.
std::string refusal_text(const RemeshQuality& best) {
  return fmt::format(
      "refused: {} base vertices leave an angle of {:.2g} degrees, {:.2g} % of the diagonal, {} flipped triangles and "
      "{} self-intersections",
      best.base_vertices, best.smallest_angle_degrees, 100 * best.hausdorff_relative, best.flipped,
      best.self_intersections);
}

Remeshed remesh_surface(const PreparedSurface& surface, const RemeshOptions& options, ProgressBar& progress) {
  progress.begin("remesh");
  auto remeshed =
      remesh(surface.mesh, options, [&](double fraction, std::string_view stage) { progress.update(fraction, stage); });
  progress.end(quality_text(remeshed));
  return remeshed;
}

/// Of cavities, in triangles as large as the finest of the skin.
TriangleMesh even_walls(const std::vector<TriangleMesh>& cavities, const SemiRegularMesh& skin) {
  if (cavities.empty()) return {};
  const TriangleMesh finest = finest_surface(skin);
  const double area = surface_area(finest) / static_cast<double>(finest.triangles.size());
  const double edge = std::sqrt(4 / std::numbers::sqrt3 * area);
  std::vector<TriangleMesh> even;
  for (const auto& cavity : cavities) even.push_back(even_surface(cavity, edge));
  return walls_of(even);
}

/// A wrap, checked as its own reader's would be.
RemeshedSkin skin_of(const Wrapped& wrapped, const MeshNotes& notes, ProgressBar& progress) {
  RemeshedSkin skin{prepare_surface(wrapped.mesh), wrapped.report, {}, {}};
  auto& repairs = skin.surface.repairs;
  const auto changes = describe_wrap(wrapped.report, "m");
  repairs.insert(repairs.begin(), changes.begin(), changes.end());
  repairs.insert(repairs.begin(), notes.begin(), notes.end());
  progress.end(surface_text(skin.surface));
  return skin;
}

/// Wraps that are rounder and rounder, until one will do.
class Ladder {
 public:
  Ladder(const TriangleMesh& faces, const MeshNotes& notes, const RemeshOptions& options, bool largest_piece,
         ProgressBar& progress)
      : faces_(faces), notes_(notes), options_(options), progress_(progress), area_(surface_area(faces)) {
    wrapping_.largest_piece = largest_piece;
    options_.most_base_vertices = most_growth_of_wraps * options.base_vertices;
    options_.most_work = most_work;
  }

  RemeshedSkin climb() {
    for (std::size_t rung = 0; rung + 1 < roundings.size(); ++rung) {
      try {
        return attempt(roundings[rung]);
      } catch (const RemeshError& error) {
        refuse(refusal_text(error.best()));
      } catch (const SurfaceError& error) {
        refuse("refused: " + error.defects().front());
      } catch (const NothingLeft& error) {
        refuse(std::string("refused: ") + error.what());
      }
    }
    return attempt(roundings.back());
  }

 private:
  RemeshedSkin attempt(double rounding) {
    wrapping_.rounding = rounding * finest_edge(area_, options_);
    const Wrapped wrapped = wrap(faces_, wrapping_);
    area_ = surface_area(wrapped.mesh);
    auto skin = skin_of(wrapped, notes_, progress_);
    skin.remeshed = remesh_surface(skin.surface, options_, progress_);
    auto& repairs = skin.surface.repairs;
    repairs.insert(repairs.end(), refused_.begin(), refused_.end());
    return skin;
  }

  void refuse(const std::string& why) {
    const double radius = wrapping_.rounding;
    refused_.push_back((radius > 0 ? fmt::format("rounded by {:.2g} m ", radius) : "not rounded ") + why);
    progress_.end(why);
    progress_.begin("surface");
  }

  const TriangleMesh& faces_;
  const MeshNotes& notes_;
  RemeshOptions options_;
  ProgressBar& progress_;
  WrapOptions wrapping_;
  double area_;  ///< of the last wrap
  std::vector<std::string> refused_;
};

}  // namespace

RemeshedSkin remesh_skin(const Scene& scene, PreparedSurface surface, ProgressBar& progress) {
  progress.end(surface_text(surface));
  RemeshedSkin skin{std::move(surface), {}, {}, {}};
  skin.remeshed = remesh_surface(skin.surface, options_of(scene), progress);
  skin.walls = even_walls(skin.surface.cavities, skin.remeshed.mesh);
  return skin;
}

RemeshedSkin wrap_and_remesh(const Scene& scene, const TriangleMesh& faces, const MeshNotes& notes,
                             ProgressBar& progress) {
  const auto& [length, largest_piece] = *scene.mesh.wrap;
  if (!length) return Ladder(faces, notes, options_of(scene), largest_piece, progress).climb();
  auto skin = skin_of(wrap(faces, {.length = length, .largest_piece = largest_piece}), notes, progress);
  skin.remeshed = remesh_surface(skin.surface, options_of(scene), progress);
  return skin;
}

}  // namespace greenloop::offline
