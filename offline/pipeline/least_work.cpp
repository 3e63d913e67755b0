#include "offline/pipeline/least_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "formats/mesh/coarse_mesh.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/pipeline/body_sizes.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

constexpr layout::Scale<3> unit_scale{{1, 0, 0, 1, 0, 1}, {1, 0, 0, 1, 0, 1}};

// of whatever material
layout::Info facts_of(std::uint32_t contacts, std::uint32_t coarsest_constraint_level) {
  layout::Info facts{};
  facts.young = 1;
  facts.rate = 1;
  facts.max_contacts = contacts;
  facts.coarsest_constraint_level = coarsest_constraint_level;
  return facts;
}

// every coefficient by itself
void leave_uncoupled(const std::vector<std::uint32_t>& flags, const SemiRegularMesh& mesh, ModelData& model) {
  std::size_t begin = 0;
  for (std::size_t q = 0; q < model.levels.size(); ++q) {
    const std::size_t end = mesh.vertex_end[q];
    const auto domain = std::count_if(flags.begin() + static_cast<std::ptrdiff_t>(begin),
                                      flags.begin() + static_cast<std::ptrdiff_t>(end),
                                      [](std::uint32_t flag) { return (flag & layout::node_domain) != 0; });
    for (std::ptrdiff_t i = 0; i < domain; ++i) model.levels[q].scales.push_back(unit_scale);
    for (CouplingsData& layer : model.levels[q].couplings) {
      layer.begin.assign(static_cast<std::size_t>(domain) + 1, 0);
    }
    begin = end;
  }
}

std::string mending(const StepBudget& budget) {
  if (budget.work) return "raise work or lower contacts";
  return "raise share, lower rate or contacts, or state with units_per_us how much faster the target is";
}

std::string asked(const StepBudget& budget) {
  if (budget.work) return fmt::format("budget.work: {} units a step", *budget.work);
  return fmt::format("budget.share: {} of a period of {} Hz is {:.4g} us, {} work units at {} units per us",
                     *budget.share, budget.rate, budget.step_us(), *budget.asked_work(), budget.speed());
}

}  // namespace

std::uint64_t least_work_bound(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                               const std::vector<double>& area, std::uint32_t contacts,
                               std::uint32_t coarsest_constraint_level) {
  const SurfaceWavelet wavelet(mesh, flags, area, layout::Wavelet::linear);
  ModelData model = describe_mesh(mesh, flags, area, wavelet, layout::Problem::elastostatic,
                                  facts_of(contacts, coarsest_constraint_level));
  add_representatives(mesh, flags, model);
  leave_uncoupled(flags, mesh, model);
  return least_work(encode(model));
}

std::string what_would_do(const StepBudget& budget, const SemiRegularMesh& mesh,
                          const std::vector<std::uint32_t>& flags, const std::vector<double>& area,
                          std::uint32_t coarsest_constraint_level) {
  const auto work = static_cast<std::uint64_t>(budget.asked_work().value_or(most_work));
  const auto contacts = static_cast<std::uint32_t>(budget.contacts);
  const auto level = finest_level_that(mesh, flags, [&](int coarser, std::span<const std::uint32_t> its_flags) {
    const auto nodes = static_cast<std::ptrdiff_t>(its_flags.size());
    const auto coarsest = std::min(coarsest_constraint_level, static_cast<std::uint32_t>(coarser));
    return least_work_bound(coarse_mesh(mesh, static_cast<std::size_t>(coarser)), {its_flags.begin(), its_flags.end()},
                            {area.begin(), area.begin() + nodes}, contacts, coarsest) <= work;
  });
  std::uint32_t fit = 0;
  for (std::uint32_t unfit = contacts; unfit - fit > 1;) {
    const std::uint32_t tried = std::midpoint(fit, unfit);
    const bool fits = least_work_bound(mesh, flags, area, tried, coarsest_constraint_level) <= work;
    (fits ? fit : unfit) = tried;
  }
  if (fit == 0 && !level) return "not even a single contact would fit, on whatever remesh.levels";
  if (fit == 0) return levels_text(level);
  const std::string fewer = fmt::format("contacts = {} would do", fit);
  return level ? fmt::format("remesh.levels = {} or {}", *level, fewer) : fewer;
}

std::uint64_t least_work(std::span<const std::byte> model) {
  const AlignedBytes bytes(model);
  const auto opened = Model::open(bytes.span());
  if (!opened) {
    throw std::runtime_error("the model just made does not verify; this is a defect of greenloop itself");
  }
  return Elastostatic::required(opened.model, Elastostatic::intended(opened.model).limits).least_work;
}

void require_work(const Scene& scene, const std::filesystem::path& file, std::uint64_t least, LeastOf models,
                  const std::string& instead) {
  const auto work = scene.budget.asked_work();
  if (!work || static_cast<std::uint64_t>(*work) >= least) {
    return;
  }
  const char* other = models == LeastOf::this_wavelet ? "; another [compression] wavelet may need less" : "";
  throw SceneError({fmt::format("{}: {}; {} contacts need at least {}, at the coarsest level; {}{}{}{}", file.string(),
                                asked(scene.budget), scene.budget.contacts, least, mending(scene.budget), other,
                                instead.empty() ? "" : ": ", instead)});
}

}  // namespace greenloop::offline
