#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/view.hpp"
#include "offline/report/build_record.hpp"
#include "offline/report/model_surface.hpp"
#include "offline/report/trace.hpp"

namespace greenloop::offline {

/// A table of text; the first column is the rows' heading.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// Bytes of the sections of one kind.
struct KindBytes {
  std::string name;
  std::uint64_t bytes = 0;
};

/// The errors of one constraint level against the exact compliance, relative.
struct LevelErrors {
  std::uint32_t level = 0;
  double rms = 0;
  double worst_column = 0;
  double patch_force = 0;
};

/// Couplings by layer. By decreasing size, what lies between the sections last; their sum is the file's length.
[[nodiscard]] std::vector<KindBytes> bytes_by_kind(const ModelView& model);

/// Bytes of the compliance of the finest level present as dense blocks of float32.
[[nodiscard]] std::uint64_t dense_bytes(const ModelView& model);

/// Body, material, compression and what the scene asked of the loop.
[[nodiscard]] std::vector<FactGroup> model_facts(const ModelView& model, const ModelSurface& surface);

/// One row per constraint level: its nodes, the blocks and bytes of scales and couplings up to it, its errors, and its
/// share of the answered cycles if there is a trace.
[[nodiscard]] Table level_table(const ModelView& model, const std::optional<TraceSummary>& trace);

/// The patches that the build's mesh error was estimated on, as its provenance tells; no rows if it does not.
[[nodiscard]] Table mesh_error_table(const ModelView& model);

/// Of every constraint level in the file, coarse to fine.
[[nodiscard]] std::vector<LevelErrors> level_errors(const ModelView& model);

}  // namespace greenloop::offline
