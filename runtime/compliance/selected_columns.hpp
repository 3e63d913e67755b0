#pragma once

#include <cstdint>

#include "runtime/algebra/block.hpp"
#include "runtime/prices.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

// Selected answers (James & Pai 2001, section 4.3): what forces do to some columns, without a field. With the force
// coefficients T^-T f it is E^T T^-1 S T^-T f, of which S is read between the coefficients that the forces reach and
// those that the columns depend on: in the columns of both, in the file.

/// x += S times force coefficients, on the coefficients that `moved` lists. force: [domain] on those of `forced`, N;
/// each is multiplied with its scale; x: [domain], m, 0 before. Both of elastostatic models. Returns the blocks between
/// the two, at most those that are stored in the columns of both. For the loop; work: couple_work.
std::uint64_t couple_coefficients(const Refinement& refinement, const Touched& forced, Float4* force,
                                  const Touched& moved, Float4* x) noexcept;

/// T^-1 in place, on the coefficients that columns of one level depend on: x is the displacement at the places of these
/// columns. moved: by them. For the loop; work: force_visit_price per visit.
void displace_columns(const Refinement& refinement, const Touched& moved, Float4* x) noexcept;

/// What couple_coefficients goes over.
struct CoupledCounts {
  std::uint64_t coefficients = 0;  ///< of both
  std::uint64_t stored = 0;        ///< blocks in their columns
};

/// Work units of couple_coefficients that finds so many blocks.
constexpr std::uint64_t couple_work(const Prices& prices, const CoupledCounts& counts, std::uint64_t between) {
  return priced(counts.coefficients, prices.panel_row) + priced(counts.stored, prices.stored_block) +
         priced(between, prices.meeting);
}

}  // namespace greenloop
