#include "offline/pipeline/before_solving.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/layout.hpp"
#include "offline/pipeline/body_problem.hpp"
#include "offline/pipeline/body_sizes.hpp"
#include "offline/pipeline/least_work.hpp"
#include "offline/pipeline/remeshed_skin.hpp"
#include "offline/pipeline/store_room.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/thickness.hpp"

namespace greenloop::offline {
namespace {

using Flags = std::span<const std::uint32_t>;

constexpr double enough_across = 3;

/// Says what a step needs at least, and refuses a budget that no model of this body could keep.
void require_possible_work(const Scene& scene, const std::filesystem::path& file, const SemiRegularMesh& mesh,
                           const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                           ProgressBar& progress) {
  progress.begin("budget");
  const auto coarsest = static_cast<std::uint32_t>(scene.coarsest_constraints);
  const std::uint64_t least =
      least_work_bound(mesh, flags, area, static_cast<std::uint32_t>(scene.budget.contacts), coarsest);
  const auto work = scene.budget.asked_work();
  progress.end(fmt::format("a step of {} contacts needs at least {} units, {:.3g} us at {} units per us{}",
                           scene.budget.contacts, least, static_cast<double>(least) / scene.budget.speed(),
                           scene.budget.speed(), work ? fmt::format("; {} are asked for", *work) : ""));
  const bool is_less = work && static_cast<std::uint64_t>(*work) < least;
  require_work(scene, file, least, LeastOf::any_wavelet,
               is_less ? what_would_do(scene.budget, mesh, flags, area, coarsest) : std::string());
}

std::vector<int> domain_nodes(Flags flags) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if ((flags[i] & layout::node_domain) != 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

/// Why the tetrahedra do not carry these nodes; empty if they do.
std::string why_not_carried(const Volume& volume, Flags flags) {
  try {
    require_independent(volume.interpolation, domain_nodes(flags), volume.fixed);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

void require_carried(const Scene& scene, const BodyGeometry& body) {
  if (!body.volume) return;
  const std::string why = why_not_carried(*body.volume, body.flags);
  if (why.empty()) return;
  const auto level = finest_level_that(
      body.surface, body.flags, [&](int, Flags coarser) { return why_not_carried(*body.volume, coarser).empty(); });
  throw std::runtime_error(
      fmt::format("{}: {}: {}; or name the file in [surface]: its boundary is filled with tetrahedra "
                  "fine enough",
                  scene.mesh.path.string(), why, levels_text(level)));
}

/// Of a store of a body's missing columns.
void require_room(const BuildRequest& request, std::size_t missing, const SemiRegularMesh& mesh, Flags flags) {
  const auto levels = [&](double bytes) {
    return levels_text(finest_level_that(
        mesh, flags, [&](int, Flags coarser) { return estimate_sizes(coarser, 0).store_bytes <= bytes; }));
  };
  require_store_room(request.store, domain_nodes(flags).size(), missing, levels);
}

/// The number of levels with enough tetrahedra across, if there are `across` at the scene's.
std::string levels_across(const Scene& scene, double across) {
  if (scene.mesh.tetrahedra) return "take a finer tetrahedral mesh there";
  const int levels =
      scene.remesh.levels + static_cast<int>(std::ceil(std::log2(enough_across / std::max(across, 0.1))));
  if (levels > most_levels) return "no number of remesh.levels would do; make it thicker";
  return fmt::format("remesh.levels = {} should do", levels);
}

struct ThinPart {
  double across = 0, metres = 0;
  Eigen::Vector3d at;

  [[nodiscard]] std::string text() const {
    return fmt::format("{:.3g} {} across the thinnest part, {:.3g} m at ({:.3g}, {:.3g}, {:.3g}) m", across,
                       across == 1 ? "tetrahedron" : "tetrahedra", metres, at.x(), at.y(), at.z());
  }
};

ThinPart thin_part(const SemiRegularMesh& surface, const std::vector<Chord>& chords,
                   const std::vector<double>& across) {
  const ThinnestPart thinnest = thinnest_part(surface, across);
  return {thinnest.elements, chords[thinnest.node].length, surface.positions[thinnest.node]};
}

/// Before the surface is filled.
ThinPart estimated_thin_part(const SemiRegularMesh& surface, const TriangleMesh& walls) {
  const std::vector<Chord> chords = inward_chords(surface, walls);
  std::vector<double> across(chords.size());
  std::transform(chords.begin(), chords.end(), across.begin(), [](const Chord& chord) { return chord.elements(); });
  return thin_part(surface, chords, across);
}

/// What else would make a large body smaller; empty if nothing would.
std::string coarser_base(const Scene& scene, const RemeshQuality& remesh) {
  if (scene.mesh.tetrahedra || scene.mesh.wrap ||
      remesh.base_vertices <= most_growth_of_wraps * scene.remesh.base_vertices) {
    return "";
  }
  return fmt::format(
      ", or [surface] wrap = \"auto\", which rounds what needs {} base vertices here until {} or twice as many will do",
      remesh.base_vertices, scene.remesh.base_vertices);
}

void say_sizes(const BodySizes& sizes, ProgressBar& progress) {
  progress.begin("sizes");
  progress.end(sizes_text(sizes));
}

}  // namespace

void require_buildable(const BuildRequest& request, const Scene& scene, const BodyGeometry& body,
                       ProgressBar& progress) {
  const BodySizes sizes =
      estimate_sizes(body.flags, body.volume ? body.volume->mesh.vertices.size() : 0, scene.elements);
  say_sizes(sizes, progress);
  if (!request.allow_large) {
    require_moderate(sizes, request.scene, scene.elements, body.surface, body.flags,
                     coarser_base(scene, body.report.remesh));
  }
  require_possible_work(scene, request.scene, body.surface, body.flags, body.area, progress);
  require_room(request, sizes.columns, body.surface, body.flags);
  require_carried(scene, body);
  if (body.volume) return;
  progress.begin("thickness");
  const ThinPart thin = estimated_thin_part(body.surface, body.walls);
  progress.end("about " + thin.text() + (thin.across < enough_across ? ", fewer than three" : ""));
}

void require_buildable(const BuildRequest& request, const Scene& scene, const GreenStore& store,
                       ProgressBar& progress) {
  const GreenStoreContents& body = store.contents();
  BodySizes sizes = estimate_sizes(body.flags, body.volume.vertices.size(), scene.elements);
  say_sizes(sizes, progress);
  const std::size_t missing = store.missing_columns().size();
  if (missing == 0) sizes.store_bytes = sizes.factor_bytes = 0;
  if (!request.allow_large) require_moderate(sizes, request.scene, scene.elements, body.surface, body.flags);
  require_possible_work(scene, request.scene, body.surface, body.flags, body.area, progress);
  require_room(request, missing, body.surface, body.flags);
}

nlohmann::json say_thickness(const Scene& scene, const GreenStoreContents& contents, ProgressBar& progress) {
  progress.begin("thickness");
  const TriangleMesh walls = cavity_walls(contents.volume);
  const std::vector<Chord> chords = inward_chords(contents.surface, walls);
  const ThinPart thin = thin_part(
      contents.surface, chords, layers_along(chords, contents.surface, walls, contents.volume, contents.interpolation));
  progress.end((thin.across < most_layers ? "" : "at least ") + thin.text());
  if (thin.across < enough_across) {
    progress.warn(fmt::format("thin part: {}; fewer than {:.0f} are too stiff: {}", thin.text(), enough_across,
                              levels_across(scene, thin.across)));
  }
  return {{"tetrahedra_across", thin.across}, {"metres", thin.metres}, {"at", {thin.at.x(), thin.at.y(), thin.at.z()}}};
}

nlohmann::json sizes_record(const GreenStoreContents& contents) {
  return sizes_record(estimate_sizes(contents.flags, contents.volume.vertices.size(), contents.elements));
}

}  // namespace greenloop::offline
