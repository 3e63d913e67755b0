#pragma once

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

/// By decreasing size, what lies between the sections last; their sum is the file's length.
[[nodiscard]] std::vector<KindBytes> bytes_by_kind(const ModelView& model);

/// Bytes of the finest constraint level's columns as dense 3 x 3 blocks of float32.
[[nodiscard]] std::uint64_t dense_bytes(const ModelView& model);

/// Body, material, compression and what the scene asked of the loop.
[[nodiscard]] std::vector<FactGroup> model_facts(const ModelView& model, const ModelSurface& surface);

/// One row per constraint level that has columns: errors, costs, and its share of the answered cycles if there is a
/// trace.
[[nodiscard]] Table level_table(const ModelView& model, const std::optional<TraceSummary>& trace);

}  // namespace greenloop::offline
