#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/store/elements.hpp"

namespace greenloop::offline {

/// A body's columns are not solved unasked if their store or the memory of the build takes more bytes.
inline constexpr double most_bytes_unasked = 5e9;

/// What a build will take; estimates but for the counts and the store.
struct BodySizes {
  std::size_t nodes = 0;         ///< of the surface
  std::size_t moving = 0;        ///< of them, not fixed
  std::size_t columns = 0;       ///< of the domain: what touched and read nodes need
  double store_bytes = 0;        ///< of all columns
  double factor_bytes = 0;       ///< RAM to factorise the stiffness and to solve
  double compression_bytes = 0;  ///< RAM to compress
  double seconds = 0;            ///< to solve and to compress, mostly within a factor of three

  [[nodiscard]] double memory_bytes() const;
  [[nodiscard]] bool large() const;
};

/// `flags`: layout::NodeFlag per node, domain marked. `volume_vertices`: of the tetrahedra; 0: half as many again as
/// nodes, which is what filling mostly makes.
[[nodiscard]] BodySizes estimate_sizes(std::span<const std::uint32_t> flags, std::size_t volume_vertices,
                                       Elements elements = Elements::linear);

/// The finest level below the finest whose nodes do: what `does` says of its number and the flags of its nodes.
template <class Does>
[[nodiscard]] std::optional<int> finest_level_that(const SemiRegularMesh& mesh, std::span<const std::uint32_t> flags,
                                                   const Does& does) {
  for (int level = mesh.finest_level() - 1; level >= 0; --level) {
    if (does(level, flags.first(mesh.vertex_end[static_cast<std::size_t>(level)]))) return level;
  }
  return std::nullopt;
}

/// "remesh.levels = 2 would do", or that none does.
[[nodiscard]] std::string levels_text(const std::optional<int>& level);

/// For people, in a line.
[[nodiscard]] std::string sizes_text(const BodySizes& sizes);
[[nodiscard]] nlohmann::json sizes_record(const BodySizes& sizes);

/// "3.2 GB"
[[nodiscard]] std::string bytes_text(double bytes);

/// Throws SceneError, naming the scene, sizes and how many levels would do, if the body is large; and
/// `else_would_do`, a clause.
void require_moderate(const BodySizes& sizes, const std::filesystem::path& scene, Elements elements,
                      const SemiRegularMesh& mesh, std::span<const std::uint32_t> flags,
                      const std::string& else_would_do = "");

}  // namespace greenloop::offline
