#pragma once

#include <cstdint>
#include <vector>

#include "runtime/elastostatic/body.hpp"

namespace greenloop {

/// Which coefficients have blocks with each, one entry for each block of any layer.
class BlockNeighbours {
 public:
  explicit BlockNeighbours(const ModelView& view);
  [[nodiscard]] const std::vector<std::uint32_t>& of(std::uint32_t coefficient) const {
    return neighbours_[coefficient];
  }

 private:
  std::vector<std::vector<std::uint32_t>> neighbours_;
};

/// Work units that a budget has to hold for an answer at one level, by a fresh factor and with the whole field.
struct NeededWork {
  std::uint64_t whole = 0;
  std::uint64_t field = 0;  ///< of that
};

/// The work of a set of contacts at a level, while nodes come and go.
class SetWorks {
 public:
  /// Body and neighbours must outlive it.
  SetWorks(Body& body, const BlockNeighbours& neighbours, std::uint32_t level);

  /// Work: linear in the columns.
  void add(std::uint32_t node);
  /// One that was added.
  void remove(std::uint32_t node);

  /// Of so many contacts on the nodes, of which there is one at least. Work: that of touch and count_factor.
  NeededWork needed(std::uint64_t contacts);
  /// What of it is not spent, since the planner takes more blocks to be met; of those that are passed over in further
  /// batches of rows none count. Work: since the last call, linear in the coefficients that columns reach which came or
  /// went, and in the blocks of those that no other column does.
  std::uint64_t unmet();
  /// About what the calls so far took.
  [[nodiscard]] std::uint64_t effort() const { return effort_; }

 private:
  std::uint32_t column(std::uint32_t node) const;
  const std::vector<std::uint32_t>& functional(std::uint32_t column);
  void add_dependent(std::uint32_t coefficient);
  void remove_dependent(std::uint32_t coefficient);
  void follow_columns();

  Body* body_;
  const BlockNeighbours* neighbours_;
  std::uint32_t level_;
  std::vector<std::vector<std::uint32_t>> functional_;  // [place of a column] coefficients; filled when asked for
  std::vector<std::uint32_t> nodes_;                    // [place of a column] of the set, that it stands for
  std::vector<std::uint32_t> columns_;                  // of the set, sorted
  SetCounts counts_;                                    // of the set, when last asked for
  std::vector<std::uint32_t> followed_;                 // columns, sorted, that what follows is of
  std::vector<std::uint32_t> dependents_;               // [coefficient] columns that depend on it
  std::vector<std::uint32_t> met_;                      // [coefficient] blocks with others that columns depend on
  std::uint64_t blocks_ = 0;                            // between coefficients that columns depend on
  std::uint64_t meetings_ = 0;                          // of such a block and a column, on either side
  std::uint64_t effort_ = 0;
};

}  // namespace greenloop
