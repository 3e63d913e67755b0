#pragma once

#include <functional>

#include "formats/store/green_store.hpp"
#include "offline/sources/column_source.hpp"

namespace greenloop::offline {

struct FillProgress {
  double fraction = 0.0;           ///< of all columns in the store, 0..1
  double seconds_remaining = 0.0;  ///< estimated from the columns written in this run
};
using FillProgressCallback = std::function<void(const FillProgress&)>;

struct FillReport {
  int columns = 0;       ///< written in this run
  double seconds = 0.0;  ///< wall time, writing included
};

/// Reads every column that the store lacks and writes it, in blocks of consecutive columns, so that a killed run is
/// resumed by calling this again. Throws std::runtime_error if the source's blocks, unit, rows or columns are not the
/// store's, and what reading and writing throw. Memory: one block.
FillReport fill_store(GreenStore& store, ColumnSource& source, const FillProgressCallback& progress = {});

}  // namespace greenloop::offline
