#include "offline/compress/model_field.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

namespace greenloop::offline {

namespace {

// what makes field columns, in memory of its own
struct Maker {
  explicit Maker(const ModelView& view) {
    Arena counting;
    carve(counting, view);
    memory = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory.data());
    carve(arena, view);
    tables.fill(view);
    refinement = tables.refinement(view, lifting);
  }
  Maker(const Maker&) = delete;  // the refinement points into it
  Maker& operator=(const Maker&) = delete;

  FieldColumnMaker::Counts make(const FieldColumnMaker::Room& room) {
    const auto counts = columns.make(refinement, touched, force, room);
    if (!counts.finite) throw std::runtime_error("compression: a field column is not finite");
    return counts;
  }

  AlignedBytes memory;
  RefinementTables tables;
  FieldColumnMaker columns;
  Touched touched;
  Float4* force = nullptr;
  Lifting lifting;
  Refinement refinement;

 private:
  void carve(Arena& arena, const ModelView& view) {
    tables.carve(arena, view);
    columns.carve(arena, view);
    touched.carve(arena, view);
    force = arena.take_zeroed<Float4>(view.domain_count);
  }
};

}  // namespace

FieldColumnMaker::Counts count_field_columns(const ModelView& view) { return Maker(view).make({}); }

FieldRows read_rows(const ModelView& view) {
  FieldRows read{{}, std::vector<std::uint8_t>(view.domain_count, 0)};
  Maker maker(view);
  maker.columns.mark_read(maker.refinement, maker.touched);
  std::copy_n(maker.columns.read(), view.domain_count, read.coefficients.begin());
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      read.nodes.push_back((level.nodes[i].flags & layout::node_read) != 0 ? 1 : 0);
    }
  }
  return read;
}

ModelField::ModelField(const ModelView& view) {
  Maker maker(view);
  counts_ = maker.make({});
  blocks_memory_ = AlignedBytes(static_cast<std::size_t>(counts_.blocks) * sizeof(ColumnBlock));
  auto* blocks = reinterpret_cast<ColumnBlock*>(blocks_memory_.data());
  (void)maker.make({blocks, counts_.blocks, counts_.longest});
  columns_ = maker.columns.columns();
  tables_memory_ = std::move(maker.memory);
}

std::vector<double> ModelField::column(const SurfaceWavelet& wavelet, std::size_t level, std::size_t j) const {
  std::vector<double> x(9 * wavelet.rows(), 0.0);
  const std::uint32_t* begin = columns_.begin[level] + j * columns_.levels;
  for (std::uint32_t b = begin[0]; b < begin[columns_.levels]; ++b) {
    const ColumnBlock& block = columns_.block[b];
    double* to = x.data() + 9 * std::size_t{moved_place(block)};
    for (std::size_t k = 0; k < 9; ++k) {
      to[k] += static_cast<double>(std::bit_cast<float>(std::uint32_t{block.value[k]} << 16));
    }
  }
  for (std::size_t l = 1; l <= wavelet.finest(); ++l) wavelet.merge(l, 9, x.data());
  return x;
}

}  // namespace greenloop::offline
