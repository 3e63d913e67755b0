#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "formats/layout.hpp"
#include "formats/store/elements.hpp"
#include "formats/store/material.hpp"
#include "offline/scene/region.hpp"
#include "offline/scene/simulation.hpp"

namespace greenloop::offline {

/// A scene that cannot be used. what() lists all problems found, one a line, each with file:line:column, key and
/// reason.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(std::vector<std::string> problems);

  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

/// A closed surface around whatever the file holds, in place of the file's own.
struct WrapSource {
  std::optional<double> length;  ///< what it resolves [m]; none: chosen
  bool largest_piece = false;    ///< keep the largest of several pieces
};

/// The mesh and the size of its unit: exactly one of `unit` and `size` is set.
struct MeshSource {
  bool tetrahedra = false;     ///< [volume] instead of [surface]
  std::string name;            ///< as the scene says
  std::filesystem::path path;  ///< seen from the working directory
  std::optional<double> unit;  ///< length of one mesh unit [m]
  std::optional<double> size;  ///< longest side of the bounding box after scaling [m]
  std::optional<double> weld;  ///< vertices of a surface within this become one [m]; none: as far as it takes
  std::optional<WrapSource> wrap;
  bool cavities = false;         ///< closed pieces inside the surface are cavities
  bool keep_vertex_map = false;  ///< tell in the model where the surface's vertices lie on it

  /// Metres per unit of a mesh with this bounding box. Throws SceneError if the box has no extent to scale.
  [[nodiscard]] double scale(const Eigen::AlignedBox3d& mesh_box) const;
};

struct Remesh {
  int base_vertices = 42;  ///< wanted size of the base mesh, 4..10000
  int levels = 3;          ///< midpoint splits, 0..7
};

struct AccuracyGoal {
  double rms = 0.02;          ///< ||error||_F / ||exact||_F over all columns, 0..1
  double worst_column = 0.1;  ///< largest block-wise relative error of any column, 0..1
  double patch_force = 0.05;  ///< largest relative error of the nodal forces that hold a 64-node patch, 0..10
  double field = 0.05;        ///< largest relative error of the field of any contact pattern, 0..10
  double field_rough = 0.2;   ///< `field` of alternating and random displacements, 0..10
  double field_peak = 0.1;    ///< largest error at a node over the largest displacement, of any pattern, 0..10
  /// Largest estimated error of the tetrahedra's forces of pressed patches, 0..10; none: said, but not judged.
  std::optional<double> mesh_error;

  /// A mesh error above this is warned of.
  [[nodiscard]] double tolerated_mesh_error() const { return mesh_error.value_or(patch_force); }
};

/// Work units per microsecond of the target if the scene does not say how fast that is: stated, not measured.
inline constexpr double nominal_units_per_us = 3000;

/// Most midpoint splits of a base mesh.
inline constexpr int most_levels = 7;

/// Most work units per step that a scene may ask for.
inline constexpr std::int64_t most_work = 1'000'000'000'000;

/// The loop that the model is for. Either `work` or `units_per_us` is set, or neither.
struct StepBudget {
  double rate = 1000;                  ///< steps per second [Hz]
  std::optional<double> share;         ///< of a period that a step may take, above 0 and at most 1
  std::optional<std::int64_t> work;    ///< work units per step, 1..most_work
  std::optional<double> units_per_us;  ///< work units per microsecond of the target; only with a share
  int contacts = 16;                   ///< most contacts at once, 1..4096

  /// What a step may take [us]: its share of a period, or all of it.
  [[nodiscard]] double step_us() const { return 1e6 / rate * share.value_or(1); }

  /// How fast the target is taken to be.
  [[nodiscard]] double speed() const { return units_per_us.value_or(nominal_units_per_us); }

  /// Work units per step: `work`, or what the share of a period holds; none: the build chooses.
  [[nodiscard]] std::optional<std::int64_t> asked_work() const;
};

/// A pressure on the part of the surface whose triangles have all their corners in a region, or that of a mask.
struct PressureLoad {
  std::string name;  ///< printable ASCII, 1 to longest_load_name letters, none twice
  Region region;
  std::optional<Eigen::Vector3d> direction;  ///< of any length but 0; none: inwards, along the normals
  bool mask = false;  ///< the region is a sphere: of the node nearest to its center (James & Pai 2001, section 6.1)
};

/// What a load of 1 Pa presses each node with [Pa]: 1 in its region, or the linear function of its mask, 1 at the node
/// and 0 from the radius on. Linear in the nodes.
[[nodiscard]] std::vector<double> node_pressures(const PressureLoad& load, std::span<const Eigen::Vector3d> positions,
                                                 const Eigen::AlignedBox3d& box);

/// Letters of a load's name, and pressures of a scene.
inline constexpr std::size_t longest_load_name = sizeof(layout::LoadRecord::name) - 1;
inline constexpr std::size_t most_pressures = layout::most_loads - layout::accelerations;

/// What scene.toml asks for, in SI units. docs/scene.md has the grammar.
struct Scene {
  MeshSource mesh;
  Remesh remesh;
  Material material;
  Elements elements = Elements::linear;  ///< of the tetrahedra
  std::vector<Region> fixed;             ///< at least one
  std::vector<Region> touched;           ///< none: everything that is not fixed
  std::vector<Region> read;              ///< none: everything that is not fixed
  std::optional<double> density;         ///< of the material [kg/m^3]
  bool gravity = false;                  ///< keep what accelerations of the whole body do; needs a density
  std::vector<PressureLoad> pressures;   ///< keep what these do
  int coarsest_constraints = 0;          ///< coarsest level offered for contacts, 0..remesh.levels
  AccuracyGoal accuracy;
  std::optional<layout::Wavelet> wavelet;  ///< none: the best, by measurement
  bool ready = false;                      ///< put what a loop would make at its start into the model
  StepBudget budget;
  std::optional<std::filesystem::path> store;  ///< HDF5 store, seen from the working directory
  std::string store_name;                      ///< as the scene says
  std::optional<Simulation> simulation;        ///< how the body moves, if it is to be simulated
};

/// Longest scene [bytes].
inline constexpr std::uintmax_t largest_scene_file = 1 << 20;

/// Reads and checks a scene, a regular file of at most largest_scene_file bytes. Files it names are looked for beside
/// it; none is opened. Throws SceneError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file);

/// The same for a scene already in memory; `file` is for messages and for paths relative to it.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::filesystem::path& file);

/// The part of canonical_text about mesh, levels, material and regions: all that exact columns follow from. A key that
/// changes them belongs here; any other does not, and leaves stores valid.
[[nodiscard]] std::string body_text(const Scene& scene);

/// The scene as TOML: every key in SI with defaults filled in, always in the same order, numbers that read back as the
/// same doubles. Scenes that mean the same have the same text; parsing it gives the same scene. For provenance, and
/// through fingerprint() to tell whether a stored result belongs to this scene.
[[nodiscard]] std::string canonical_text(const Scene& scene);

/// The nodes of a role.
struct NodeSet {
  std::vector<bool> holds;             ///< one flag per node
  std::vector<std::size_t> of_region;  ///< nodes in each of the scene's regions; none if it has no region

  [[nodiscard]] std::size_t count() const;
};

/// What the scene asks of the nodes; no fixed node is touched or read.
struct NodeSets {
  NodeSet fixed, touched, read;
};

/// Finds the nodes of each role among positions [m] of a body with this bounding box. Throws SceneError with counts and
/// box if everything is fixed, nothing is left to touch or to read, a region holds no node of its role, or a pressure
/// acts on nodes that can move but are neither touched nor read.
[[nodiscard]] NodeSets select_nodes(const Scene& scene, std::span<const Eigen::Vector3d> positions,
                                    const Eigen::AlignedBox3d& box);

}  // namespace greenloop::offline
