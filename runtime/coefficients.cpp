#include "runtime/coefficients.hpp"

#include "runtime/domain.hpp"

namespace greenloop {

Coefficients number_coefficients(const ModelView& view) noexcept {
  Coefficients coefficients;
  coefficients.last_averages = view.levels > 3 ? view.levels - 3 : 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    coefficients.group[Coefficients::details(q)] = {q == 0 ? level.averages : level.details, level.domain_begin,
                                                    level.counts->domain_count, q};
  }
  coefficients.count = view.domain_count;
  for (std::uint32_t m = 1; m <= coefficients.last_averages; ++m) {
    coefficients.group[Coefficients::averages(m)] = {view.level[m].averages, coefficients.count, domain_up_to(view, m),
                                                     m};
    coefficients.count += domain_up_to(view, m);
  }
  return coefficients;
}

}  // namespace greenloop
