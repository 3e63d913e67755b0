#include "sim_hw/control_loop/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

void RunTally::add(const CycleRecord& record) noexcept {
  if (record.missed() && misses++ == 0) first_miss = record.cycle;
  worst_work = std::max(worst_work, record.report.work);
  contact_cycles += record.contacts > 0;
  contacts_max = std::max(contacts_max, record.contacts);
  if (record.total_force() >= force_max) strongest = record;
  force_max = std::max(force_max, record.total_force());
  residual_max = std::max(residual_max, static_cast<double>(record.report.residual));
  worst_touching = std::max(worst_touching, record.report.touching_work);
  ++at_level[record.report.constraint_level];
  for (std::size_t p = 0; cycles > 0 && p < max_tools; ++p) {
    force_step_max = std::max(force_step_max, norm(record.hand_force[p] - last.hand_force[p]));
    fall_throughs += record.behind[p] && last.behind[p] && norm(last.hand_force[p]) == 0 ? 1 : 0;
  }
  handled += std::abs(record.energy.in - last.energy.in);
  last = record;
  ++cycles;
}

void MotionsGiven::add(const ControlLoop& loop) noexcept {
  const VibratingBody* const body = loop.setup().vibrating;
  if (body == nullptr) return;
  const Status status = loop.motion().status;
  illegal += status == Status::held_illegal_impulse ? 1 : 0;
  unknown += status == Status::held_out_of_range ? 1 : 0;
  followed += answered(status) && loop.impulse() != ImpulseResponse::no_impulse ? 1 : 0;
  coarser += status == Status::coarser ? 1 : 0;
  for (const Vec4& u : body->offset()) {
    offset = std::max(offset, norm({static_cast<double>(u.x), static_cast<double>(u.y), static_cast<double>(u.z)}));
  }
}

RunLog::RunLog(std::size_t cycles, std::size_t nodes, bool keep) : largest_field_(4 * nodes) {
  records_.reserve(keep ? cycles : 0);
  cpu_us_.reserve(cycles);
}

void RunLog::add(const ControlLoop& loop, std::int64_t cycle, double cpu_us) noexcept {
  if (cpu_us_.size() == cpu_us_.capacity()) return;
  CycleRecord record{.cycle = cycle,
                     .budget = loop.budget(),
                     .between = loop.between(),
                     .report = loop.report(),
                     .energy = loop.energy(),
                     .cpu_us = cpu_us};
  for (std::size_t p = 0; p < loop.tools().size(); ++p) record.centre[p] = loop.tools()[p].tool.pose.position;
  for (const ContactBody::Contact& contact : loop.contacts()) {
    if (contact.state == ContactState::open) continue;
    ++record.touching[contact.tool];
    ++record.contacts;
  }
  for (std::size_t p = 0; p < loop.answers().size(); ++p) {
    const ContactBody::ToolAnswer& answer = loop.answers()[p];
    record.hand_force[p] = loop.felt(p).force;
    record.hand_torque[p] = loop.felt(p).torque;
    record.behind[p] = answer.is_behind;
  }
  record.touching_bound = loop.touching_bound();
  tally_.add(record);
  tally_.motions.add(loop);
  compare(loop);
  cpu_us_.push_back(static_cast<float>(cpu_us));
  if (records_.size() < records_.capacity()) records_.push_back(record);
  if (loop.field_is_new() && record.total_force() > largest_force_) {
    largest_force_ = record.total_force();
    const auto* field = reinterpret_cast<const float*>(loop.field().data());
    std::copy_n(field, largest_field_.size(), largest_field_.begin());
  }
}

/// Of the local model with the reference body.
void RunLog::compare(const ControlLoop& loop) noexcept {
  FastLoop& fast = tally_.fast;
  fast.work_most = std::max(fast.work_most, loop.local_work());
  const ContactBody* const reference = loop.setup().reference;
  for (std::size_t p = 0; !loop.between() && p < loop.tools().size(); ++p) stepped_force_[p] = loop.felt(p).force;
  if (reference == nullptr) return;
  double largest = 0;
  for (std::size_t p = 0; p < reference->tools().size(); ++p) {
    const Double3 force = reference->tools()[p].force;
    const double error = norm(loop.felt(p).force - force), held = norm(stepped_force_[p] - force);
    (loop.between() ? fast.square : fast.step_square) += dot(force, force);
    (loop.between() ? fast.error_square : fast.step_error_square) += error * error;
    if (!loop.between()) continue;
    fast.held_square += held * held;
    fast.error_most = std::max(fast.error_most, error);
    fast.held_most = std::max(fast.held_most, held);
    largest = std::max(largest, norm(force));
  }
  fast.force_most = std::max(fast.force_most, largest);
  if (largest == 0 || !loop.between()) return;
  ++fast.cycles;
  fast.in_range += loop.in_range() ? 1 : 0;
}

void RunLog::write_trace(const std::filesystem::path& file, std::size_t probes, double period) const {
  OutputFile out(file);
  out.write(fmt::format("time,{}{}force,contacts,level,field_level,work,budget,status\n", vector_names("", probes),
                        vector_names("force_", probes)));
  for (const CycleRecord& r : records_) {
    out.write(fmt::format("{},{}{}{},{},{},{},{},{},{}\n", static_cast<double>(r.cycle) * period,
                          vector_columns(std::span(r.centre).first(probes)),
                          vector_columns(std::span(r.hand_force).first(probes)), r.total_force(), r.contacts,
                          r.report.constraint_level, r.report.field_level, r.report.work, r.budget.work,
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
