#include "offline/report/trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "formats/layout.hpp"
#include "offline/report/csv_table.hpp"

namespace greenloop::offline {
namespace {

void check_time(const std::vector<TraceCycle>& trace, const std::filesystem::path& path) {
  if (trace.empty()) throw std::runtime_error(path.string() + ": a trace without a single cycle");
  for (std::size_t i = 1; i < trace.size(); ++i) {
    if (trace[i].time > trace[i - 1].time) continue;
    throw std::runtime_error(fmt::format("{}: column 'time': cycle {} at {} s follows {} s; time must increase",
                                         path.string(), i, trace[i].time, trace[i - 1].time));
  }
}

void append_probe(const CsvTable& table, int probe, std::vector<TraceCycle>& trace) {
  const auto column = [&](const char* name) { return table.numbers(fmt::format("{}{}", name, probe)); };
  const auto x = column("x"), y = column("y"), z = column("z");
  const auto force_x = column("force_x"), force_y = column("force_y"), force_z = column("force_z");
  for (std::size_t i = 0; i < trace.size(); ++i) {
    trace[i].probes.push_back({{x[i], y[i], z[i]}, {force_x[i], force_y[i], force_z[i]}});
  }
}

}  // namespace

std::vector<TraceCycle> load_trace(const std::filesystem::path& path) {
  const CsvTable table = CsvTable::load(path);
  const auto time = table.numbers("time"), force = table.numbers("force");
  const auto contacts = table.counts("contacts"), level = table.counts("level", layout::max_levels - 1);
  const auto field_level = table.counts("field_level", layout::max_levels - 1), work = table.counts("work"),
             budget = table.counts("budget");
  const auto status = table.texts("status");
  std::vector<TraceCycle> trace(table.rows());
  for (std::size_t i = 0; i < trace.size(); ++i) {
    trace[i] = {.time = time[i],
                .force = force[i],
                .contacts = contacts[i],
                .level = level[i],
                .field_level = field_level[i],
                .work = work[i],
                .budget = budget[i],
                .status = status[i]};
  }
  for (int probe = 0; probe == 0 || table.has(fmt::format("force_x{}", probe)); ++probe) {
    append_probe(table, probe, trace);
  }
  check_time(trace, path);
  return trace;
}

TraceSummary summarise(const std::vector<TraceCycle>& trace) {
  TraceSummary summary{.cycles = trace.size(), .duration = trace.back().time - trace.front().time};
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const TraceCycle& cycle = trace[i];
    summary.misses += cycle.missed() ? 1 : 0;
    summary.held += cycle.held() ? 1 : 0;
    summary.most_contacts = std::max(summary.most_contacts, cycle.contacts);
    summary.worst_work = std::max(summary.worst_work, cycle.work);
    if (cycle.budget > 0) {
      summary.worst_share =
          std::max(summary.worst_share, static_cast<double>(cycle.work) / static_cast<double>(cycle.budget));
    }
    if (cycle.force > trace[summary.strongest].force) summary.strongest = i;
    if (cycle.contacts == 0) continue;
    ++summary.in_contact;
    if (cycle.held()) continue;
    if (cycle.level >= summary.cycles_at_level.size()) summary.cycles_at_level.resize(cycle.level + 1);
    ++summary.cycles_at_level[cycle.level];
  }
  return summary;
}

std::vector<Eigen::Vector3d> load_snapshot(const std::filesystem::path& path, std::size_t node_count) {
  const CsvTable table = CsvTable::load(path);
  const auto node = table.counts("node");
  const auto x = table.numbers("x"), y = table.numbers("y"), z = table.numbers("z");
  std::vector<Eigen::Vector3d> displacement(node_count, Eigen::Vector3d::Zero());
  std::vector<char> seen(node_count, 0);
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (node[i] >= node_count) {
      throw std::runtime_error(fmt::format("{}: column 'node': {} in a model of {} nodes; is it of another model?",
                                           path.string(), node[i], node_count));
    }
    if (seen[node[i]])
      throw std::runtime_error(fmt::format("{}: column 'node': {} stands there twice", path.string(), node[i]));
    seen[node[i]] = 1;
    displacement[node[i]] = {x[i], y[i], z[i]};
  }
  return displacement;
}

}  // namespace greenloop::offline
