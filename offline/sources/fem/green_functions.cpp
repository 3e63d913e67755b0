#include "offline/sources/fem/green_functions.hpp"

#include <chrono>
#include <stdexcept>
#include <string>

#include "offline/sources/fem/fem_source.hpp"
#include "offline/sources/fem/rigid_motion.hpp"
#include "offline/sources/reciprocity.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {
namespace {

/// Columns that this run solved blame the body, others the file.
std::string remedy(const GreenStore& store, const SolveReport& report) {
  return report.columns_solved == store.column_count()
             ? "the tetrahedra are too badly shaped, remesh the surface"
             : "columns that the store had are damaged; solve them again with --overwrite-store, or remesh the surface "
               "if that does not help";
}

void solve_missing(GreenStore& store, SolveReport& report, const FillProgressCallback& progress) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  FemSource source(fem_problem(store.contents()));
  report.factor_entries = source.factor_entries();
  report.factor_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const FillReport filled = fill_store(store, source, progress);
  report.columns_solved = filled.columns;
  report.solve_seconds = filled.seconds;
  if (store.has_body_force_room() && !store.is_body_force_done()) store.write_body_force(source.body_force());
}

void require_volume(const GreenStore& store) {
  store.require_components(3);
  if (!store.contents().volume.vertices.empty()) return;
  throw std::runtime_error(store.path().string() +
                           ": /volume: there is no volume to solve; only a store with tetrahedra can be completed");
}

}  // namespace

void require_solvable(const GreenStoreContents& contents) {
  require_no_rigid_motion(contents.volume, contents.volume_fixed);
  require_independent(contents.interpolation, contents.column_node, contents.volume_fixed);
}

SolveReport solve_green_functions(GreenStore& store, const FillProgressCallback& progress) {
  require_volume(store);
  require_solvable(store.contents());
  SolveReport report;
  report.unknowns = unknowns(fem_problem(store.contents()));
  if (!store.missing_columns().empty()) solve_missing(store, report, progress);
  report.largest_asymmetry = largest_asymmetry(store);
  if (!(report.largest_asymmetry <= most_asymmetry)) {
    throw std::runtime_error(store.path().string() + ": /green/displacement: reciprocity is violated by " +
                             std::to_string(report.largest_asymmetry) + "; " + remedy(store, report));
  }
  return report;
}

Eigen::MatrixXd body_force_displacement(GreenStore& store) {
  if (store.is_body_force_done()) return store.read_body_force();
  require_volume(store);
  Eigen::MatrixXd displacement = FemSource(fem_problem(store.contents())).body_force();
  if (store.has_body_force_room()) store.write_body_force(displacement);
  return displacement;
}

}  // namespace greenloop::offline
