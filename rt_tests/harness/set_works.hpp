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

/// Work units of a step that answers a set at one level, by a fresh factor and with the whole field.
struct Works {
  std::uint64_t needed = 0;  ///< that a budget has to hold
  std::uint64_t spent = 0;   ///< of those, but for blocks that are passed over in further batches of rows
  std::uint64_t field = 0;   ///< in either
};

/// The works of a set of contacts at a level, while nodes come and go.
class SetWorks {
 public:
  /// Body and neighbours must outlive it.
  SetWorks(Body& body, const BlockNeighbours& neighbours, std::uint32_t level);

  /// Work: linear in the coefficients that the node reaches, and in the blocks of those that no other of the set does.
  void add(std::uint32_t node);
  /// One that was added. Work: the same.
  void remove(std::uint32_t node);

  /// Of so many contacts on the nodes, of which there is one at least. Work: that of touch and count_factor.
  Works works(std::uint64_t contacts);
  /// About what the calls so far took.
  [[nodiscard]] std::uint64_t effort() const { return effort_; }

 private:
  std::uint32_t column(std::uint32_t node) const;
  const std::vector<std::uint32_t>& functional(std::uint32_t column);
  void add_dependent(std::uint32_t coefficient);
  void remove_dependent(std::uint32_t coefficient);
  [[nodiscard]] std::uint64_t unmet_work(const SetCounts& set) const;

  Body* body_;
  const BlockNeighbours* neighbours_;
  std::uint32_t level_;
  std::vector<std::vector<std::uint32_t>> functional_;  // [place of a column] coefficients; filled when asked for
  std::vector<std::uint32_t> nodes_;                    // [place of a column] of the set, that it stands for
  std::vector<std::uint32_t> columns_;                  // of the set, sorted
  std::vector<std::uint32_t> dependents_;               // [coefficient] columns of the set that depend on it
  std::vector<std::uint32_t> met_;                      // [coefficient] blocks with others that the set depends on
  std::uint64_t blocks_ = 0;                            // between coefficients that the set depends on
  std::uint64_t meetings_ = 0;                          // of such a block and a column, on either side
  std::uint64_t effort_ = 0;
};

}  // namespace greenloop
