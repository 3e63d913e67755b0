#include "sim_hw/control_loop/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

#include "formats/output/output_file.hpp"
#include "sim_hw/control_loop/status_name.hpp"

namespace greenloop {
namespace {

/// "x0,y0,z0,x1,..." with `prefix` before each.
std::string vector_names(const char* prefix, std::size_t count) {
  std::string names;
  for (std::size_t i = 0; i < count; ++i) names += fmt::format("{0}x{1},{0}y{1},{0}z{1},", prefix, i);
  return names;
}

std::string vector_columns(std::span<const Double3> vectors) {
  std::string columns;
  for (const Double3& vector : vectors) columns += fmt::format("{},{},{},", vector.x, vector.y, vector.z);
  return columns;
}

}  // namespace

RunLog::RunLog(std::size_t cycles, std::size_t nodes) : largest_field_(4 * nodes) { records_.reserve(cycles); }

void RunLog::add(const ControlLoop& loop, std::int64_t cycle, double cpu_us) noexcept {
  if (records_.size() == records_.capacity()) return;
  CycleRecord record{.cycle = cycle, .report = loop.report(), .energy = loop.energy(), .cpu_us = cpu_us};
  for (std::size_t p = 0; p < loop.tools().size(); ++p) record.centre[p] = loop.tools()[p].tool.pose.position;
  for (const ContactBody::Contact& contact : loop.contacts()) {
    if (contact.state == ContactState::open) continue;
    ++record.touching[contact.tool];
    ++record.contacts;
  }
  for (std::size_t p = 0; p < loop.answers().size(); ++p) {
    const ContactBody::ToolAnswer& answer = loop.answers()[p];
    record.hand_force[p] = answer.force;
    record.hand_torque[p] = answer.torque;
    record.fell_through += answer.is_behind && norm(answer.force) == 0 ? 1 : 0;
  }
  record.touching_bound = loop.touching_bound();
  records_.push_back(record);
  if (loop.field_is_new() && record.total_force() > largest_force_) {
    largest_force_ = record.total_force();
    const auto* field = reinterpret_cast<const float*>(loop.field().data());
    std::copy_n(field, largest_field_.size(), largest_field_.begin());
  }
}

void RunLog::write_trace(const std::filesystem::path& file, std::size_t probes, double period,
                         const Budget& budget) const {
  OutputFile out(file);
  out.write(fmt::format("time,{}{}force,contacts,level,field_level,work,budget,status\n", vector_names("", probes),
                        vector_names("force_", probes)));
  for (const CycleRecord& r : records_) {
    out.write(fmt::format("{},{}{}{},{},{},{},{},{},{}\n", static_cast<double>(r.cycle) * period,
                          vector_columns(std::span(r.centre).first(probes)),
                          vector_columns(std::span(r.hand_force).first(probes)), r.total_force(), r.contacts,
                          r.report.constraint_level, r.report.field_level, r.report.work, budget.work,
                          name(r.report.status)));
  }
  out.close();
}

void RunLog::write_snapshot(const std::filesystem::path& file) const {
  OutputFile out(file);
  out.write("node,x,y,z\n");
  for (std::size_t i = 0; i < largest_field_.size(); i += 4) {
    out.write(fmt::format("{},{},{},{}\n", i / 4, largest_field_[i], largest_field_[i + 1], largest_field_[i + 2]));
  }
  out.close();
}

}  // namespace greenloop
