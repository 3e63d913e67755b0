#include "offline/figures/rate_curve.hpp"

#include <cmath>
#include <stdexcept>

namespace greenloop::offline {
namespace {

bool drawable(double value) { return value > 0 && std::isfinite(value); }

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

std::optional<double> interpolate(const std::vector<RatePoint>& points, RateQuantity given, double value,
                                  RateQuantity wanted) {
  const RatePoint* last = nullptr;
  for (const RatePoint& point : points) {
    if (!drawable(point.*given) || !drawable(point.*wanted)) continue;
    if (last != nullptr && (last->*given - value) * (point.*given - value) <= 0 && last->*given != point.*given) {
      const double share = std::log(value / (last->*given)) / std::log(point.*given / (last->*given));
      return last->*wanted * std::pow(point.*wanted / (last->*wanted), share);
    }
    last = &point;
  }
  return std::nullopt;
}

LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() != y.size() || x.size() < 2) throw std::invalid_argument("line fit: needs at least two points");
  const double x0 = mean(x), y0 = mean(y);
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - x0) * (x[i] - x0);
    xy += (x[i] - x0) * (y[i] - y0);
    yy += (y[i] - y0) * (y[i] - y0);
  }
  if (!(xx > 0)) throw std::invalid_argument("line fit: all points have the same x");
  const double slope = xy / xx;
  return {.intercept = y0 - slope * x0, .slope = slope, .r_squared = yy > 0 ? slope * xy / yy : 1};
}

}  // namespace greenloop::offline
