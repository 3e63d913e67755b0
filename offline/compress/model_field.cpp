#include "offline/compress/model_field.hpp"

#include <bit>
#include <stdexcept>

namespace greenloop::offline {

void ModelField::Tables::carve(Arena& arena, const ModelView& view) {
  refinement.carve(arena, view);
  maker.carve(arena, view);
  touched.carve(arena, view);
  force = arena.take_zeroed<Float4>(view.domain_count);
}

ModelField::ModelField(const ModelView& view) : view_(view) {
  Arena counting;
  Tables sized;
  sized.carve(counting, view);
  tables_memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
  Arena arena(tables_memory_.data());
  Tables tables;
  tables.carve(arena, view);
  tables.refinement.fill(view);
  Lifting lifting;
  const Refinement refinement = tables.refinement.refinement(view, lifting);
  counts_ = tables.maker.make(refinement, tables.touched, tables.force, {});
  if (!counts_.finite) throw std::runtime_error("compression: a field column is not finite");
  blocks_memory_ = AlignedBytes(static_cast<std::size_t>(counts_.blocks) * sizeof(ColumnBlock));
  auto* blocks = reinterpret_cast<ColumnBlock*>(blocks_memory_.data());
  (void)tables.maker.make(refinement, tables.touched, tables.force, {blocks, counts_.blocks, counts_.longest});
  columns_ = tables.maker.columns();
}

std::vector<double> ModelField::column(const SurfaceWavelet& wavelet, std::size_t level, std::size_t j) const {
  std::vector<double> x(9 * wavelet.rows(), 0.0);
  const std::uint32_t* begin = columns_.begin[level] + j * columns_.levels;
  for (std::uint32_t b = begin[0]; b < begin[columns_.levels]; ++b) {
    const ColumnBlock& block = columns_.block[b];
    double* to = x.data() + 9 * (block.byte_offset / sizeof(Float4));
    for (std::size_t k = 0; k < 9; ++k) {
      to[k] += static_cast<double>(std::bit_cast<float>(std::uint32_t{block.value[k]} << 16));
    }
  }
  for (std::size_t l = 1; l <= wavelet.finest(); ++l) wavelet.merge(l, 9, x.data());
  return x;
}

}  // namespace greenloop::offline
