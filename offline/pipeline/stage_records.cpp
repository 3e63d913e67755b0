#include "offline/pipeline/stage_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "formats/write/describe.hpp"

namespace greenloop::offline {
namespace {

using nlohmann::json;

/// Enough digits for a picture; records stand in model files.
double rounded(double error) { return std::stod(fmt::format("{:.4g}", std::min(error, 1e9))); }

/// What `of` comes to: bytes, errors and work.
template <class Tried>
json trial_record(const Tried& of, std::uint64_t step_work) {
  return {{"bytes", of.bytes},
          {"kept_blocks", of.blocks},
          {"rms_error", rounded(of.rms)},
          {"worst_column_error", rounded(of.worst_column)},
          {"worst_patch_force_error", rounded(of.patch_force)},
          {"step_work", step_work}};
}

json deviation_record(const Deviation& deviation) { return {{"max", deviation.greatest}, {"rms", deviation.rms}}; }

json wrap_record(const WrapReport& report) {
  json record = {{"length", report.length},
                 {"lattice_points", report.lattice_points},
                 {"boundary_loops", report.boundary_loops},
                 {"misoriented_edges", report.misoriented_edges},
                 {"useless_faces", report.useless_faces},
                 {"pieces_dropped", report.pieces_dropped},
                 {"dropped_share", report.dropped_share},
                 {"inner_share", report.inner_share},
                 {"sheet_share", report.sheet_share},
                 {"thin_share", report.thin_share},
                 {"filled_shells", report.filled_shells},
                 {"from_original", deviation_record(report.from_original)},
                 {"to_original", deviation_record(report.to_original)},
                 {"volume", report.volume}};
  if (report.crossing_pairs) record["crossing_pairs"] = *report.crossing_pairs;
  if (report.volume_before) record["volume_before"] = *report.volume_before;
  if (report.rounding > 0) record["rounding"] = report.rounding;
  if (report.plate_thickness) record["plate_thickness"] = *report.plate_thickness;
  return record;
}

}  // namespace

json geometry_record(const GeometryReport& report) {
  const RemeshQuality& remesh = report.remesh;
  json record = {{"surface",
                  {{"file", report.file},
                   {"vertices", report.surface.vertex_count},
                   {"triangles", report.surface.triangle_count},
                   {"genus", report.surface.genus()},
                   {"repairs", report.repairs}}},
                 {"remesh",
                  {{"base_vertices", remesh.base_vertices},
                   {"levels", remesh.levels},
                   {"triangles", remesh.triangles},
                   {"kept_connectivity", remesh.kept_connectivity},
                   {"smallest_angle_degrees", remesh.smallest_angle_degrees},
                   {"hausdorff_metres", remesh.hausdorff},
                   {"hausdorff_relative", remesh.hausdorff_relative},
                   {"mesh_off_surface_metres", remesh.farthest_of_mesh},
                   {"surface_off_mesh_metres", remesh.farthest_of_input},
                   {"volume_change", remesh.volume_change},
                   {"flipped", remesh.flipped},
                   {"self_intersections", remesh.self_intersections}}}};
  if (report.wrap) record["surface"]["wrap"] = wrap_record(*report.wrap);
  if (report.cavities > 0)
    record["surface"]["cavities"] = {{"count", report.cavities}, {"volume", report.cavity_volume}};
  return record;
}

json volume_record(const FilledVolume& filled) {
  return {{"mesher", filled.mesher},
          {"vertices", filled.volume.mesh.vertices.size()},
          {"interior_vertices", filled.quality.interior_nodes},
          {"tetrahedra", filled.volume.mesh.tetrahedra.size()},
          {"smallest_mean_ratio", filled.quality.min_quality},
          {"slivers", filled.quality.slivers}};
}

json solve_record(const SolveReport& report, const GreenStore& store) {
  return {{"columns", store.column_count()},
          {"columns_solved", report.columns_solved},
          {"rows", store.row_count()},
          {"unknowns", report.unknowns},
          {"factor_entries", report.factor_entries},
          {"factor_seconds", report.factor_seconds},
          {"solve_seconds", report.solve_seconds},
          {"largest_asymmetry", report.largest_asymmetry}};
}

json mesh_error_record(const MeshError& error) {
  json patches = json::array();
  for (const PressedPatch& patch : error.patches) {
    patches.push_back({{"center", {patch.center.x(), patch.center.y(), patch.center.z()}},
                       {"axis", std::string(1, "xyz"[patch.axis])},
                       {"own", rounded(patch.own_force)},
                       {"linear", rounded(patch.linear_force)},
                       {"quadratic", rounded(patch.quadratic_force)},
                       {"limit", rounded(patch.limit_force)},
                       {"error", rounded(patch.error())}});
  }
  return {{"force", rounded(error.force())}, {"settled", error.settled}, {"patches", std::move(patches)}};
}

json frontier_record(const CompressionReport& report) {
  json points = json::array();
  for (const auto& trial : report.frontier) {
    json point = trial_record(trial, trial.levels.back().step_work);
    const bool chosen = trial.encoding.threshold == report.encoding.threshold;
    point.update({{"threshold", trial.encoding.threshold},
                  {"quantum", trial.encoding.quantum},
                  {"chosen", chosen},
                  {"sampled", !chosen}});
    for (const auto& level : trial.levels) {
      point["levels"].push_back(trial_record(level, level.step_work));
      point["levels"].back()["level"] = level.level;
    }
    points.push_back(std::move(point));
  }
  return points;
}

json wavelets_record(const CompressionReport& report) {
  json wavelets = json::array();
  for (const auto& [wavelet, nodes, trial] : report.wavelets) {
    json record = {
        {"wavelet", wavelet_name(static_cast<std::uint32_t>(wavelet))}, {"nodes", nodes}, {"meets", trial.bytes > 0}};
    if (trial.bytes > 0) record.update(trial_record(trial, trial.step_work));
    wavelets.push_back(record);
  }
  return wavelets;
}

json compression_record(const CompressionReport& report, std::uint32_t contacts) {
  json levels = json::array();
  for (const auto& level : report.levels) {
    levels.push_back({{"level", level.level},
                      {"columns", level.nodes},
                      {"kept_blocks", level.kept_blocks},
                      {"dense_blocks", level.dense_blocks},
                      {"rms_error", level.rms_error},
                      {"worst_column_error", level.worst_column_error},
                      {"worst_patch_force_error", std::min(level.patch_force_error, 1e9)},
                      {"field_rms_error", level.field_rms_error},
                      {"field_column_error", level.field_column_error},
                      {"field_blocks", level.field.blocks},
                      {"longest_field_column", level.field.longest}});
  }
  return {{"threshold", report.encoding.threshold},
          {"quantum", report.encoding.quantum},
          {"lambda_min", report.lambda_min},
          {"patches", report.patches},
          {"dense_bytes", report.dense_bytes},
          {"frontier", frontier_record(report)},
          {"frontier_contacts", contacts},
          {"wavelets", wavelets_record(report)},
          {"constraint_levels", levels}};
}

}  // namespace greenloop::offline
