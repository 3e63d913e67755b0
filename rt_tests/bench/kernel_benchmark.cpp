#include "rt_tests/bench/kernel_benchmark.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "formats/store/green_store.hpp"
#include "rt_tests/bench/contact_sets.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/median.hpp"
#include "rt_tests/bench/patch.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/hosted/hosted.hpp"

namespace greenloop::bench {
namespace {

constexpr std::uint64_t seed = Patch::seed;
constexpr std::size_t at_once = 20;  // calls between two looks at the clock, which costs as much as a small kernel

// factors of a matrix that nodes of three rows leave and enter again
class ChangingFactors {
 public:
  ChangingFactors(std::vector<Float4> matrix, std::uint32_t order, std::uint32_t stride)
      : matrix_(std::move(matrix)), order_(order), stride_(stride), border_(std::size_t{3} * stride / 4) {
    for (std::uint32_t node = 0; node < order / 3; ++node) {
      nodes_.push_back(node);
    }
  }

  void factor() {
    factors_ = matrix_;
    good_ = cholesky_factor_(order_, stride_, factors_.data());
  }

  void remove(std::size_t at) {
    out_ = nodes_[at];
    nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(at));
    cholesky_remove(order_, static_cast<std::uint32_t>(3 * at), 3, stride_, factors_.data(), border_.data());
  }

  void write_border() {
    nodes_.push_back(out_);
    auto* border = reinterpret_cast<float*>(border_.data());
    for (std::uint32_t r = 0; r < 3; ++r) {
      for (std::uint32_t k = 0; k <= order_ - 3 + r; ++k) {
        border[std::size_t{r} * stride_ + k] = exact(3 * out_ + r, 3 * nodes_[k / 3] + k % 3);
      }
    }
  }

  void insert() { good_ = good_ && cholesky_append(order_ - 3, 3, stride_, factors_.data(), border_.data()); }

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }

  [[nodiscard]] double error() const {
    const Eigen::Index n = order_;
    Eigen::MatrixXd lower = Eigen::MatrixXd::Identity(n, n), wanted(n, n);
    Eigen::VectorXd pivots(n);
    const auto* entry = reinterpret_cast<const float*>(factors_.data());
    for (std::uint32_t j = 0; j < order_; ++j) {
      pivots(j) = 1 / double{entry[std::size_t{j} * stride_ + j]};
      for (std::uint32_t i = 0; i < order_; ++i) {
        wanted(i, j) = double{exact(3 * nodes_[i / 3] + i % 3, 3 * nodes_[j / 3] + j % 3)};
        if (i > j) {
          lower(i, j) = double{entry[std::size_t{j} * stride_ + i]};
        }
      }
    }
    return (lower * pivots.asDiagonal() * lower.transpose() - wanted).norm() / wanted.norm();
  }

 private:
  [[nodiscard]] float exact(std::uint32_t i, std::uint32_t j) const {
    const auto* entry = reinterpret_cast<const float*>(matrix_.data());
    return entry[std::size_t{std::min(i, j)} * stride_ + std::max(i, j)];
  }

  std::vector<Float4> matrix_, factors_;
  CholeskyFactor cholesky_factor_ = fastest_cholesky_factor();
  std::uint32_t order_, stride_;
  std::vector<std::uint32_t> nodes_;
  std::uint32_t out_ = 0;
  std::vector<Float4> border_;
  bool good_ = true;
};

}  // namespace

TransformFigures measure_transform(const Model& model, const GreenStore& store, std::size_t rounds) {
  const ModelView& view = model.view();
  Patch patch(model, 64);
  const std::vector<std::vector<Constraint>> one = {{patch.set.front()}};
  const ExactColumns columns(store, one);
  const float unit[3] = {1, 0.5F, -0.25F};
  Eigen::VectorXf field(3 * static_cast<Eigen::Index>(store.contents().row_node.size()));
  std::vector<Float4> x(view.node_count);
  Body& body = patch.body;
  const std::vector<float> forces(patch.order(), 1e-3F);
  transform_forces<3>(body.refinement, {body.planned.columns, body.planned.column, forces.data()}, body.touched,
                      body.force);
  sum_couplings<3>(body.field_model(), body.touched, view.domain_count, body.force, body.field_sums);
  scale_sums<3>(view, view.domain_count, body.field_sums);
  const std::vector<Float4> sums(body.field_sums.of_blocks, body.field_sums.of_blocks + view.domain_count);
  std::vector<Float4> value(view.domain_count);
  std::vector<double> transform, dense, ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    dense.push_back(time_of(at_once, [&] { columns.sum(one.front(), unit, field); }));
    double sum = 0;
    for (std::size_t i = 0; i < at_once; ++i) {
      value = sums;
      sum += time_of(1, [&] {
        inverse_transform<3>(view, body.offsets, {patch.level, patch.level}, value.data(), x.data());
      });
    }
    transform.push_back(sum / static_cast<double>(at_once));
    ratio.push_back(transform.back() / dense.back());
  }
  return {median(transform), median(dense), median(ratio)};
}

CapacitanceFigures measure_capacitance(const Model& model, std::size_t contacts, std::size_t rounds,
                                       std::uint64_t updates) {
  Patch patch(model, contacts);
  std::vector<Float4> matrix(std::size_t{patch.stride()} * patch.stride() / 4);
  std::vector<double> extract, factor, insert, remove;
  for (std::size_t round = 0; round < rounds; ++round) {
    extract.push_back(time_of(1, [&] { patch.assemble(matrix); }));
  }
  ChangingFactors factors(matrix, patch.order(), patch.stride());
  std::mt19937_64 random(seed);
  for (std::size_t round = 0; round < rounds; ++round) {
    factor.push_back(time_of(1, [&] { factors.factor(); }));
  }
  CapacitanceFigures figures;
  figures.contacts = patch.set.size();
  const std::uint64_t timed = std::max<std::uint64_t>(rounds, 1);
  for (; figures.updates < std::max(updates, timed); ++figures.updates) {
    const std::size_t at = random() % factors.nodes();
    if (figures.updates < timed) {
      remove.push_back(time_of(1, [&] { factors.remove(at); }));
      factors.write_border();
      insert.push_back(time_of(1, [&] { factors.insert(); }));
    } else {
      factors.remove(at);
      factors.write_border();
      factors.insert();
    }
  }
  if (!factors.good()) {
    throw std::runtime_error("a capacitance matrix of the model is not positive definite");
  }
  const std::uint32_t blocks = patch.body.planned.columns * (patch.body.planned.columns + 1) / 2;
  figures.extract_ns_per_block = 1e3 * median(extract) / blocks;
  figures.factor_us = median(factor);
  figures.insert_us = median(insert);
  figures.remove_us = median(remove);
  figures.drift = factors.error();
  return figures;
}

ForceFigures measure_forces(const Model& model, std::size_t contacts, std::size_t rounds) {
  const auto set = patch_contacts(model.view(), 1, contacts, seed).front();
  Hosted<Elastostatic> body(model, {.max_contacts = static_cast<std::uint32_t>(set.size()), .cached_factors = 2});
  body.step(set, any_budget, false);
  std::vector<double> time;
  for (std::size_t round = 0; round < rounds; ++round) {
    time.push_back(time_of(5 * at_once, [&] { body.step(set, any_budget, false); }));
  }
  return {set.size(), median(time)};
}

CreationFigures measure_creation(const Model& model, const Elastostatic::Limits& limits) {
  CreationFigures figures{limits, 0, Elastostatic::required(model, limits).bytes};
  AlignedBytes memory(figures.arena_bytes);
  std::fill_n(memory.data(), memory.size(), std::byte{1});
  bool good = false;
  figures.create_ms =
      time_of(1,
              [&] {
                good = static_cast<bool>(Elastostatic::create(model, limits, {memory.data(), memory.size()}));
              }) /
      1e3;
  if (!good) {
    throw std::runtime_error("a body of " + std::to_string(limits.max_contacts) + " contacts cannot be made");
  }
  return figures;
}

}  // namespace greenloop::bench
