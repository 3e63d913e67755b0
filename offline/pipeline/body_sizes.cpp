#include "offline/pipeline/body_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/layout.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {
namespace {

// fitted to what docs/solving.md has measured
constexpr double entries_per_vertex = 2.7e6 / 4059, entries_exponent = 1.37, entries_at = 4059;
constexpr double points_per_vertex = 6;  // that move, of quadratic elements
constexpr double bytes_per_entry = 16;   // the factor, and as much again while it is made
constexpr double solve_flops = 1e10;     // a second
constexpr double base_bytes = 2e8;       // of the program, its libraries and what does not grow

std::size_t count(std::span<const std::uint32_t> flags, std::uint32_t flag, bool set) {
  return static_cast<std::size_t>(
      std::count_if(flags.begin(), flags.end(), [&](std::uint32_t f) { return ((f & flag) != 0) == set; }));
}

// numbers in the Cholesky factor of a body of so many vertices, or vertices and edges
double factor_entries(double points) {
  return entries_per_vertex * entries_at * std::pow(points / entries_at, entries_exponent);
}

std::string duration_text(double seconds) {
  return seconds < 60 ? "less than a minute" : fmt::format("about {:.0f} minutes", std::ceil(seconds / 60));
}

}  // namespace

double BodySizes::memory_bytes() const { return std::max(factor_bytes, compression_bytes); }

bool BodySizes::large() const { return store_bytes > most_bytes_unasked || memory_bytes() > most_bytes_unasked; }

BodySizes estimate_sizes(std::span<const std::uint32_t> flags, std::size_t volume_vertices, Elements elements) {
  BodySizes sizes{.nodes = flags.size(),
                  .moving = count(flags, layout::node_fixed, false),
                  .columns = count(flags, layout::node_domain, true)};
  const auto columns = static_cast<double>(sizes.columns);
  const double vertices =
      volume_vertices > 0 ? static_cast<double>(volume_vertices) : 1.5 * static_cast<double>(flags.size());
  const double entries = factor_entries(elements == Elements::linear ? vertices : points_per_vertex * vertices);
  sizes.store_bytes = 9 * sizeof(double) * columns * columns;
  sizes.factor_bytes = base_bytes + bytes_per_entry * entries;
  sizes.compression_bytes = base_bytes + 15 * columns * columns;
  sizes.seconds = 12 * entries * columns / solve_flops + 0.03 * columns;
  return sizes;
}

std::string levels_text(const std::optional<int>& level) {
  return level ? fmt::format("remesh.levels = {} would do", *level) : "no smaller number of remesh.levels would do";
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.1f} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

std::string sizes_text(const BodySizes& sizes) {
  return fmt::format(
      "{} nodes, {} of them move, {} columns: {} of store; estimated: {} of RAM to factorise, {} to compress, {}",
      sizes.nodes, sizes.moving, sizes.columns, bytes_text(sizes.store_bytes), bytes_text(sizes.factor_bytes),
      bytes_text(sizes.compression_bytes), duration_text(sizes.seconds));
}

nlohmann::json sizes_record(const BodySizes& sizes) {
  return {{"nodes", sizes.nodes},
          {"moving_nodes", sizes.moving},
          {"columns", sizes.columns},
          {"store_bytes", sizes.store_bytes},
          {"estimated",
           {{"factor_bytes", std::round(sizes.factor_bytes)},
            {"compression_bytes", std::round(sizes.compression_bytes)},
            {"seconds", std::round(sizes.seconds)}}}};
}

void require_moderate(const BodySizes& sizes, const std::filesystem::path& scene, Elements elements,
                      const SemiRegularMesh& mesh, std::span<const std::uint32_t> flags,
                      const std::string& else_would_do) {
  if (!sizes.large()) return;
  const auto level = finest_level_that(mesh, flags, [elements](int, std::span<const std::uint32_t> coarser) {
    return !estimate_sizes(coarser, 0, elements).large();
  });
  throw SceneError(
      {fmt::format("{}: remesh.levels: {} columns make a store of {} and take about {} of RAM, above {} "
                   "only on request: pass --allow-large; {}, or smaller [[touched]] and [[read]] regions{}",
                   scene.string(), sizes.columns, bytes_text(sizes.store_bytes), bytes_text(sizes.memory_bytes()),
                   bytes_text(most_bytes_unasked), levels_text(level), else_would_do)});
}

}  // namespace greenloop::offline
