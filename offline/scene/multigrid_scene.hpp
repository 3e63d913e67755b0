#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "formats/store/material.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// Matter in a part of the body.
struct MatterPart {
  std::array<Eigen::Vector3d, 2> box;  ///< fractions of the bounding box, opposite corners
  Material material;
  double density = 0;  ///< kg/m^3
};

/// What scene.toml asks for where it has a [multigrid] section: a body that is simulated in the loop
/// (docs/multigrid.md). Mesh, remeshing, material and supports are those of every scene.
struct MultigridBody {
  Scene scene;
  enum class Strain : std::uint32_t { linear = 0, corotational = 1, green = 2 } strain = Strain::corotational;
  double time_step = 0;            ///< s; of budget.rate where the scene says none
  int level = 0;                   ///< of the remeshed surface: its vertices bound the tetrahedra; finer ones are shown
  double mass_damping = 0;         ///< 1/s
  double stiffness_damping = 0;    ///< s
  double numerical_damping = 0.1;  ///< 0..1
  Eigen::Vector3d gravity{0, 0, -9.81};  ///< m/s^2
  int coarsest = 300;                    ///< vertices of the coarsest grid, at most
  std::vector<MatterPart> parts;         ///< later ones over earlier ones
};

/// Reads and checks such a scene; none if it is a scene of another kind, without [multigrid]. Throws SceneError naming
/// every problem.
[[nodiscard]] std::optional<MultigridBody> read_multigrid_scene(const std::filesystem::path& file);

/// The same of a scene's text; `file` is for messages and paths beside it.
[[nodiscard]] std::optional<MultigridBody> parse_multigrid_scene(std::string_view text,
                                                                 const std::filesystem::path& file);

}  // namespace greenloop::offline
