#include "rt_tests/bench/roofline.hpp"

#include <algorithm>
#include <stdexcept>

#include "rt_tests/bench/median.hpp"
#include "rt_tests/bench/patch.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/compliance/field.hpp"

namespace greenloop::bench {
namespace {

constexpr std::size_t at_once = 20;  // calls of a small kernel between two looks at the clock

class RooflineRun {
 public:
  RooflineRun(const Model& model, std::size_t rounds)
      : view_(&model.view()), prediction_(prediction_of(model.view())), rounds_(rounds) {
    for (const std::size_t bytes : stream_bytes) {
      streams_.emplace_back(bytes);
    }
    std::vector<double> nothing;
    for (std::size_t round = 0; round < rounds; ++round) {
      nothing.push_back(time_of(1, [] {}));
    }
    clock_us_ = median(nothing);
  }

  void measure(Patch& patch) {
    measure_field(patch);
    if (patch.set.size() > 1) {
      measure_factor(patch);
    }
  }

  Roofline result() {
    std::vector<double> flops;
    for (std::size_t round = 0; round < rounds_; ++round) {
      flops.push_back(measure_flops());
    }
    roofline_.gflops = median(flops) / 1e3;
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      roofline_.gb_per_s[i] = median_stream(streams_[i]);
    }
    for (RooflinePoint& point : roofline_.points) {
      point.compute_us = point.flops / (1e3 * roofline_.gflops);
    }
    return roofline_;
  }

 private:
  double median_stream(ReadStream& stream) const {
    std::vector<double> speed;
    for (std::size_t round = 0; round < std::min<std::size_t>(rounds_, 9); ++round) {
      speed.push_back(stream.measure() / 1e3);
    }
    return median(speed);
  }

  // of one call, without the clock's own time
  template <class Work>
  double time_once(Work work) const {
    return std::max(time_of(1, work) - clock_us_, 0.0);
  }

  // microseconds(): of one call whose bytes are in the caches
  template <class Microseconds>
  void add(const RooflinePoint& point, Microseconds microseconds) {
    const auto fits = [&](const ReadStream& stream) { return static_cast<double>(stream.bytes()) >= point.bytes; };
    add(point, *std::find_if(streams_.begin(), streams_.end() - 1, fits), microseconds);
  }

  // the stream is measured just before each call
  template <class Microseconds>
  void add(RooflinePoint point, ReadStream& stream, Microseconds microseconds) {
    std::vector<double> us, speed, ratio;
    for (std::size_t round = 0; round < rounds_; ++round) {
      speed.push_back(stream.measure());
      us.push_back(microseconds());
      ratio.push_back(us.back() * speed.back() / point.bytes);
    }
    point.us = median(us);
    point.gb_per_s = median(speed) / 1e3;
    point.bound_us = point.bytes / median(speed);
    point.ratio = median(ratio);
    roofline_.points.push_back(point);
  }

  void measure_field(Patch& patch) {
    const Body& body = patch.body;
    std::vector<Float4> x(view_->node_count);
    const auto sum = [&] {
      sum_couplings<3>(body.field_model(), body.touched, view_->domain_count, body.force, body.field_sums);
    };
    const auto moved = static_cast<double>(view_->domain_count);
    RooflinePoint columns{.kernel = "field couplings",
                          .contacts = patch.set.size(),
                          .bytes = field_bytes(body) + moved * 2 * sizeof(Float4),
                          .flops = field_operations(body)};
    add(columns, [&] { return time_of(at_once, sum); });
    columns.kernel = "field couplings, cold";
    add(columns, streams_.back(), [&] { return time_once(sum); });

    const bool lifted = layout::is_lifted(static_cast<layout::Wavelet>(view_->info->wavelet));
    const auto odd = static_cast<double>(view_->domain_count - view_->level[0].counts->domain_count);
    add({.kernel = "inverse transform",
         .contacts = patch.set.size(),
         .bytes = view_->node_count * 2.0 * sizeof(Float4) + odd * prediction_bytes() +
                  moved * (2 * sizeof(Float4) + (lifted ? sizeof(layout::RefinementRecord) : 0)),
         .flops = odd * prediction_flops() + moved * (lifted ? 15 : 3)},
        [&] {
          double us = 0;
          for (std::size_t i = 0; i < at_once; ++i) {
            sum();
            us += time_once([&] {
              inverse_transform<3>(*view_, body.offsets, {patch.level, patch.level}, body.field_sums.of_blocks,
                                   x.data());
            });
          }
          return us / at_once;
        });
  }

  void measure_factor(Patch& patch) {
    const auto order = static_cast<double>(patch.order());
    const double triangle = sizeof(float) * order * (order + 1) / 2;
    std::vector<Float4> matrix(std::size_t{patch.stride()} * patch.stride() / 4);
    add({.kernel = "capacitance matrix",
         .contacts = patch.set.size(),
         .bytes = coupling_bytes(patch.body) + triangle,
         .flops = capacitance_flops(patch)},
        [&] { return time_once([&] { patch.assemble(matrix); }); });
    std::vector<Float4> factor;
    const CholeskyFactor make_factor = fastest_cholesky_factor();
    bool good = true;
    add({.kernel = "Cholesky", .contacts = patch.set.size(), .bytes = 2 * triangle, .flops = order * order * order / 3},
        [&] {
          factor = matrix;
          return time_once([&] { good = make_factor(patch.order(), patch.stride(), factor.data()) && good; });
        });
    if (!good) {
      throw std::runtime_error("a capacitance matrix of the model is not positive definite");
    }
    std::vector<Float4> held(padded_order(patch.order()) / 4);
    for (std::uint32_t i = 0; i < patch.order(); ++i) {
      held[i / 4][i % 4] = 1e-3F;
    }
    std::vector<Float4> solution = held;
    add({.kernel = "triangular solution",
         .contacts = patch.set.size(),
         .bytes = 2 * triangle + 4 * order * sizeof(float),
         .flops = 2 * order * order},
        [&] {
          return time_of(at_once, [&] {
            std::copy(held.begin(), held.end(), solution.begin());
            cholesky_solve(patch.order(), patch.stride(), factor.data(), solution.data());
          });
        });
  }

  // of predicting an odd node in the inverse transform, and what is read for it beside the field
  [[nodiscard]] double prediction_flops() const {
    return prediction_.blocks ? 18.0 * prediction_.length + 3 : prediction_.length > 2 ? 33 : 6;
  }
  [[nodiscard]] double prediction_bytes() const {
    constexpr double of_block = sizeof(std::uint32_t) + StoredBlock<3, 16>::bytes;
    return prediction_.blocks ? of_block * prediction_.length : double{sizeof(ParentOffsets)};
  }

  // of all couplings of touched coefficients, of tiles with what they lack
  double field_operations(const Body& body) const {
    std::size_t operations = 0;
    for (std::uint32_t q = 0; q <= body.touched.finest; ++q) {
      for (std::uint32_t k = 0; k < body.touched.count[q]; ++k) {
        const std::uint32_t coefficient = body.touched.list[q][k];
        operations += coefficient < body.base.columns ? 18 * std::size_t{BaseColumns::width} * body.base.tiles : 0;
        for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
          operations +=
              18 * column_length(view_->level[q].couplings[layer], coefficient - view_->level[q].domain_begin);
          operations += 18 * column_length(body.mirrored.layer[layer], coefficient);
        }
      }
    }
    return static_cast<double>(operations);
  }

  // of the same, with the indices of their rows, and of their scales
  double field_bytes(const Body& body) const {
    std::size_t bytes = 0;
    const auto add_column = [&](const CouplingsView& couplings, std::uint32_t layer, std::uint32_t column) {
      const std::size_t block = (9 * layout::value_bits[layer] + 7) / 8 + couplings.index_bytes;
      bytes += block * column_length(couplings, column);
    };
    for (std::uint32_t q = 0; q <= body.touched.finest; ++q) {
      for (std::uint32_t k = 0; k < body.touched.count[q]; ++k) {
        const std::uint32_t coefficient = body.touched.list[q][k];
        bytes += sizeof(layout::Scale<3>);
        bytes += coefficient < body.base.columns ? BaseColumns::tile_bytes<3> * body.base.tiles : 0;
        for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
          add_column(view_->level[q].couplings[layer], layer, coefficient - view_->level[q].domain_begin);
          add_column(body.mirrored.layer[layer], layer, coefficient);
        }
      }
    }
    return static_cast<double>(bytes);
  }

  // of the couplings between touched coefficients, as they lie in the file, of the indices of all blocks in their
  // columns, and of their scales
  double coupling_bytes(const Body& body) const {
    std::size_t bytes = 0;
    for (std::uint32_t q = 0; q <= body.touched.finest; ++q) {
      const LevelView& level = view_->level[q];
      for (std::uint32_t k = 0; k < body.touched.count[q]; ++k) {
        const std::uint32_t coefficient = body.touched.list[q][k];
        bytes += sizeof(layout::Scale<3>);
        for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
          const CouplingsView& couplings = level.couplings[layer];
          const std::uint32_t column = coefficient - level.domain_begin;
          bytes += std::size_t{couplings.index_bytes} * column_length(couplings, column);
          visit_rows(couplings, column, 0, coefficient, [&](std::uint32_t row, std::uint32_t) {
            bytes += body.touched.mark[row] ? (9 * layout::value_bits[layer] + 7) / 8 : 0;
          });
        }
      }
    }
    return static_cast<double>(bytes);
  }

  // of a block times a weight of T^-1
  [[nodiscard]] std::uint64_t weight_operations() const { return prediction_.blocks ? 27 : 9; }

  // of scaling a block between two slots and adding it in both directions
  [[nodiscard]] std::uint64_t block_operations(const PartialCapacitance& batch, const CapacitanceScratch<3>& scratch,
                                               std::uint32_t slot, std::uint32_t other) const {
    if (batch.panel) {
      return 54 + 18;
    }
    const std::uint32_t* begin = scratch.functionals.slot_begin;
    const auto rows = [&](std::uint32_t s) { return begin[s + 1] - begin[s]; };
    return std::min(slot, other) < batch.own ? 54 + weight_operations() * (rows(slot) + rows(other)) : 0;
  }

  std::uint64_t couplings_operations(const PartialCapacitance& batch, const CapacitanceScratch<3>& scratch,
                                     const Body& body) const {
    std::uint64_t operations = 0;
    for (std::uint32_t slot = 0; slot < batch.slots; ++slot) {
      const std::uint32_t coefficient = scratch.coefficient[slot];
      const LevelView& level = view_->level[body.refinement.level[coefficient]];
      for (const CouplingsView& couplings : level.couplings) {
        visit_rows(couplings, coefficient - level.domain_begin, 0, coefficient, [&](std::uint32_t row, std::uint32_t) {
          const std::uint32_t other = scratch.slot[row];
          operations += other == layout::none ? 0 : block_operations(batch, scratch, slot, other);
        });
      }
    }
    return operations;
  }

  // of scaling and adding blocks and of all steps of T^-1, batch by batch as assemble_capacitance does
  double capacitance_flops(Patch& patch) const {
    Body& body = patch.body;
    CapacitanceScratch<3>& scratch = body.capacitance;
    const std::uint64_t slots = body.touched.coefficients();
    const std::uint32_t columns = body.planned.columns;
    const bool panel = has_panel(scratch.room, slots, columns);
    const std::uint64_t width = panel ? columns : batch_width(scratch.room, slots);
    std::uint64_t operations = 0;
    for (std::uint64_t first = 0; first < columns; first += width) {
      PartialCapacitance batch;
      batch.panel = panel;
      batch.computed = static_cast<std::uint32_t>(std::min<std::uint64_t>(width, columns - first));
      batch.set = {static_cast<std::uint32_t>(first) + batch.computed, body.planned.column};
      begin_capacitance<3>(body.refinement, body.touched, scratch, body.force, batch);
      const SparseInverse& inverse = scratch.inverse;
      const std::uint64_t terms = inverse.steps > 0 ? inverse.step[inverse.steps - 1].end : 0;
      operations += couplings_operations(batch, scratch, body);
      operations += weight_operations() * terms * (batch.computed + (panel ? slots : 0));
      release_capacitance(batch, scratch);
    }
    return 2.0 * static_cast<double>(operations);
  }

  const ModelView* view_;
  Prediction prediction_;
  std::size_t rounds_;
  double clock_us_ = 0;
  std::vector<ReadStream> streams_;
  Roofline roofline_;
};

}  // namespace

Roofline measure_roofline(const Model& model, const std::vector<std::size_t>& contacts, std::size_t rounds) {
  RooflineRun run(model, rounds);
  for (const std::size_t count : contacts) {
    Patch patch(model, count);
    run.measure(patch);
  }
  return run.result();
}

}  // namespace greenloop::bench
