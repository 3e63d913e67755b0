#include "sim_hw/motion/motion_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/output/output_file.hpp"
#include "sim_hw/control_loop/status_name.hpp"

namespace greenloop {
namespace {

double square(std::span<const float> a) {
  double sum = 0;
  for (const float x : a) sum += static_cast<double>(x) * static_cast<double>(x);
  return sum;
}

double distance(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (std::size_t m = 0; m < a.size(); ++m) {
    const double difference = static_cast<double>(a[m]) - static_cast<double>(b[m]);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

}  // namespace

MotionLog::MotionLog(std::size_t cycles, std::size_t modes, float velocity_balance, bool keep)
    : balance_(static_cast<double>(velocity_balance)), coordinate_(modes), velocity_(modes) {
  if (keep) records_.reserve(cycles);
  cpu_us_.reserve(cycles);
}

void MotionLog::count(const MotionLoop& loop) noexcept {
  const ImpulseResponse::StepReport& report = loop.report();
  const bool over = report.work > loop.budget().work || report.status == Status::held_over_budget;
  if (over && tally_.misses++ == 0) tally_.first_miss = loop.state().cycle;
  tally_.worst_work = std::max(tally_.worst_work, report.work);
  tally_.illegal += report.status == Status::held_illegal_impulse ? 1 : 0;
  tally_.unknown += report.status == Status::held_out_of_range ? 1 : 0;
  if (!answered(report.status)) return;
  const bool entered = loop.state().impulse >= 0;
  tally_.entered += entered ? 1 : 0;
  tally_.blending += entered && blend_ > 0 ? 1 : 0;
  tally_.continued += !entered && report.distance > 0 ? 1 : 0;
  tally_.blend = std::max(tally_.blend, static_cast<double>(report.blend));
  blend_ = report.blend;
  if (!loop.displays()) return;
  ++tally_.frames;
  tally_.coarser += report.status == Status::coarser ? 1 : 0;
  tally_.least_rank = tally_.least_rank == 0 ? report.modes : std::min(tally_.least_rank, report.modes);
  tally_.truncation_error = std::max(tally_.truncation_error, static_cast<double>(report.truncation_error));
}

void MotionLog::compare(const MotionLoop& loop) noexcept {
  const double position = distance(loop.coordinate(), coordinate_), velocity = distance(loop.velocity(), velocity_);
  const bool is_answered = answered(loop.report().status);
  tally_.not_held += !is_answered && position + velocity > 0 ? 1 : 0;
  const bool first = !is_known_;  // before it nothing is known of the state
  is_known_ = is_known_ || is_answered;
  const bool switched = is_answered && (loop.state().impulse >= 0 || loop.report().distance > 0);
  double& most_position = switched ? tally_.position_jump : tally_.position_step;
  double& most_velocity = switched ? tally_.velocity_jump : tally_.velocity_step;
  most_position = std::max(most_position, first ? 0 : position);
  most_velocity = std::max(most_velocity, first ? 0 : velocity);
  const double energy = square(loop.coordinate()) + balance_ * balance_ * square(loop.velocity());
  tally_.energy = std::max(tally_.energy, energy);
  std::copy(loop.coordinate().begin(), loop.coordinate().end(), coordinate_.begin());
  std::copy(loop.velocity().begin(), loop.velocity().end(), velocity_.begin());
}

void MotionLog::add(const MotionLoop& loop, std::int64_t cycle, double cpu_us) noexcept {
  if (cpu_us_.size() == cpu_us_.capacity()) return;
  cpu_us_.push_back(static_cast<float>(cpu_us));
  ++tally_.cycles;
  count(loop);
  compare(loop);
  if (records_.size() == records_.capacity()) return;
  records_.push_back({cycle, loop.state().impulse, loop.report(), std::sqrt(square(loop.coordinate())),
                      std::sqrt(square(loop.velocity()))});
}

void MotionLog::write_trace(const std::filesystem::path& file, double period, std::uint64_t budget) const {
  OutputFile out(file);
  out.write("time,impulse,orbit,row,position,velocity,blend,distance,rank,truncation_error,work,budget,status\n");
  for (const MotionRecord& r : records_) {
    out.write(fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", static_cast<double>(r.cycle) * period, r.impulse,
                          r.report.orbit, r.report.row, r.position, r.velocity, r.report.blend, r.report.distance,
                          r.report.modes, r.report.truncation_error, r.report.work, budget, name(r.report.status)));
  }
  out.close();
}

}  // namespace greenloop
