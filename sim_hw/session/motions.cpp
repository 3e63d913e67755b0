#include "sim_hw/session/motions.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop {

Motions::Motions(const std::filesystem::path& file, double rate)
    : file_(file),
      loaded_(load_model(file, layout::Problem::impulse_response)),
      limits_{.rate = static_cast<float>(rate)} {}

std::uint32_t Motions::impulses() const { return loaded_.model.view().impulse_response.info->impulses; }

Agreement Motions::agree(const SessionOptions& options, const Model& touched) const {
  SessionOptions whole = options;
  whole.starve = 1;
  Agreement agreement = greenloop::agree(whole, touched);
  const auto need = VibratingBody::required(touched, loaded_.model, {agreement.limits, limits_});
  std::uint64_t work = agreement.budget.work;
  if (options.budget == 0) work += need.worst_work - ContactBody::required(touched, agreement.limits).worst_work;
  agreement.budget.work = static_cast<std::uint64_t>(std::floor(static_cast<double>(work) * options.starve));
  agreement.least_work = need.least_work;
  if (agreement.budget.work < need.least_work) {
    throw std::runtime_error("budget: " + std::to_string(agreement.budget.work) +
                             " units per cycle cannot hold even the coarsest answer; the least budget of this body " +
                             "and its motions is " + std::to_string(need.least_work));
  }
  return agreement;
}

void Motions::create(const Model& touched, const ContactBody::Limits& limits) {
  memory_ = AlignedBytes(VibratingBody::required(touched, loaded_.model, {limits, limits_}).bytes);
  const auto created =
      VibratingBody::create(touched, loaded_.model, {limits, limits_}, {memory_.data(), memory_.size()});
  if (created.error == CreateError::mismatched_models) {
    throw std::runtime_error(file_.string() +
                             ": --motions: not of the same surface: a node of the body has no vertex " +
                             "of the motions at its place");
  }
  if (!created) {
    throw std::runtime_error(file_.string() + ": --motions: no body with them (error " +
                             std::to_string(static_cast<int>(created.error)) + ")");
  }
  body_ = created.body;
}

}  // namespace greenloop
