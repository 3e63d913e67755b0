#include "offline/figures/summation.hpp"

#include <algorithm>
#include <stdexcept>

#include "offline/compress/encode/touchable_nodes.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/compress/search/encoding_search.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/hosted/thread_clock.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t sets = 8;  // take turns

// Sets that are pressed by a thousandth of the body's height.
struct SpreadContacts {
  std::vector<std::vector<Constraint>> sets;
  double blocks = 0;  // of their fields, mean
};

SpreadContacts spread_contacts(const ModelView& view, std::size_t contacts) {
  const auto nodes = touchable_nodes(view);
  if (nodes.size() < contacts * sets) throw std::runtime_error("summation: the body has too few touchable nodes");
  const float depth = 0.001F * (view.info->box_max[2] - view.info->box_min[2]);
  FieldCounter field(view);
  SpreadContacts all{.sets = std::vector<std::vector<Constraint>>(sets)};
  std::vector<std::vector<std::uint32_t>> rows(sets);
  for (std::size_t i = 0; i < contacts * sets; ++i) {
    const auto [node, row] = nodes[i * nodes.size() / (contacts * sets)];
    all.sets[i % sets].push_back({.node = node, .value = {0, 0, -depth}});
    rows[i % sets].push_back(row);
  }
  for (const auto& set : rows) all.blocks += static_cast<double>(field.blocks_of(set)) / sets;
  return all;
}

// The work of a step, which must be answered as finely as can be.
std::uint64_t step(Hosted<Elastostatic>& body, const std::vector<Constraint>& set) {
  const auto report = body.step(set);
  if (report.status != Status::ok) {
    throw std::runtime_error("summation: a step ends with status " + std::to_string(static_cast<int>(report.status)));
  }
  return report.work;
}

double mean_work(Hosted<Elastostatic>& body, const std::vector<std::vector<Constraint>>& all) {
  double work = 0;
  for (const auto& set : all) step(body, set);
  for (const auto& set : all) work += static_cast<double>(step(body, set));
  return work / static_cast<double>(all.size());
}

double median_seconds(Hosted<Elastostatic>& body, const std::vector<std::vector<Constraint>>& all, std::size_t rounds) {
  std::vector<double> times;
  for (std::size_t round = 0; round < rounds; ++round) {
    const std::int64_t start = thread_nanoseconds();
    for (const auto& set : all) step(body, set);
    times.push_back(1e-9 * static_cast<double>(thread_nanoseconds() - start) / static_cast<double>(all.size()));
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

}  // namespace

SummationPoint time_summation(const ModelData& model, std::size_t contacts, std::size_t rounds) {
  const ModelFile encoded = encoded_file(model);
  const auto opened = Model::open(encoded.bytes.span());
  if (!opened) throw std::runtime_error("summation: the model is refused");
  const SpreadContacts all = spread_contacts(encoded.view, contacts);
  Hosted<Elastostatic> body(opened.model,
                            {.max_contacts = static_cast<std::uint32_t>(contacts), .cached_factors = sets});
  const double work = mean_work(body, all.sets);
  return {.blocks = all.blocks, .work = work, .seconds = median_seconds(body, all.sets, rounds)};
}

SummationFit fit_summation(const std::vector<SummationPoint>& points) {
  std::vector<double> blocks, work, seconds;
  for (const SummationPoint& point : points) {
    blocks.push_back(point.blocks);
    work.push_back(point.work);
    seconds.push_back(point.seconds);
  }
  return {fit_line(blocks, work), fit_line(blocks, seconds)};
}

}  // namespace greenloop::offline
