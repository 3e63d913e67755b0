#include "offline/compress/encode/ready_model.hpp"

#include <cstdint>
#include <stdexcept>

#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/ready_file.hpp"
#include "runtime/compliance/mirrored_couplings.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop::offline {
namespace {

// what a loop marks as read
std::vector<std::uint8_t> read_marks(const ModelView& view) {
  RefinementTables tables;
  Touched touched;
  const auto carve = [&](Arena& arena) {
    tables.carve(arena, view);
    touched.carve(arena, view);
  };
  Arena counting;
  carve(counting);
  AlignedBytes memory(static_cast<std::size_t>(counting.bytes()));
  Arena arena(memory.data());
  carve(arena);
  tables.fill(view);
  Lifting lifting;
  std::vector<std::uint8_t> read(view.domain_count);
  mark_read(tables.refinement(view, lifting), touched, read.data());
  return read;
}

}  // namespace

std::vector<std::byte> ready_model(std::span<const std::byte> model) {
  const AlignedBytes file(model);
  ModelView view;
  const VerifyResult result = verify(file.span(), view);
  if (!result.ok()) throw std::invalid_argument("model to be made ready: " + describe(result));
  return ready_file(model, read_marks(view));
}

}  // namespace greenloop::offline
