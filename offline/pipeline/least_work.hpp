#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// Work units below which no model of a body answers every step: the least work of one with unlifted Linear wavelets,
/// whose forces reach fewest coefficients, and without any coupling. Known before a column is. mesh, flags, area: as
/// for CompressionInput. Work: linear in the nodes times levels.
[[nodiscard]] std::uint64_t least_work_bound(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                             const std::vector<double>& area, std::uint32_t contacts,
                                             std::uint32_t coarsest_constraint_level);

/// How many levels, or else contacts, the work that `budget` asks for would hold by least_work_bound, in words.
[[nodiscard]] std::string what_would_do(const StepBudget& budget, const SemiRegularMesh& mesh,
                                        const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                                        std::uint32_t coarsest_constraint_level);

/// Least work of a body of the verified model's limits, as its scene intends them.
[[nodiscard]] std::uint64_t least_work(std::span<const std::byte> model);

/// Which models a least work holds for.
enum class LeastOf { any_wavelet, this_wavelet };

/// Throws SceneError, naming the file, the key, the work and how to mend it, if the work that the scene asks for is
/// less than `least`, which its contacts need. `instead`: what would do, in words.
void require_work(const Scene& scene, const std::filesystem::path& file, std::uint64_t least, LeastOf models,
                  const std::string& instead = {});

}  // namespace greenloop::offline
