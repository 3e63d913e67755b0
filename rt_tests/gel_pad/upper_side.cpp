#include "rt_tests/gel_pad/upper_side.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace greenloop::gel_pad {
namespace {

using Eigen::Index;

struct Cell {
  std::size_t index;
  double share;  // of it, below the point
};

Cell cell_of(const std::vector<double>& planes, double x) {
  const auto above = std::upper_bound(planes.begin() + 1, planes.end() - 1, x);
  const auto index = static_cast<std::size_t>(above - planes.begin()) - 1;
  return {index, (x - planes[index]) / (planes[index + 1] - planes[index])};
}

}  // namespace

double SideField::at(double x, double y) const {
  if (is_quarter) x = std::abs(x), y = std::abs(y);
  if (x < planes[0].front() || x > planes[0].back() || y < planes[1].front() || y > planes[1].back()) return 0;
  const Cell across = cell_of(planes[0], x), along = cell_of(planes[1], y);
  const auto side = static_cast<Index>(planes[0].size());
  const Index low = static_cast<Index>(across.index) + side * static_cast<Index>(along.index);
  const auto [less, more] = std::minmax(across.share, along.share);
  return (1 - more) * value[low] + (more - less) * value[across.share > along.share ? low + 1 : low + side] +
         less * value[low + side + 1];
}

Eigen::VectorXd crossing_areas(const SidePlanes& planes) {
  const auto& [across, along] = planes;
  const auto side = static_cast<Index>(across.size());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(side * static_cast<Index>(along.size()));
  for (std::size_t j = 0; j + 1 < along.size(); ++j) {
    for (std::size_t i = 0; i + 1 < across.size(); ++i) {
      const double sixth = (across[i + 1] - across[i]) * (along[j + 1] - along[j]) / 6;
      const Index low = static_cast<Index>(i) + side * static_cast<Index>(j);
      for (const Index of_one : {low + 1, low + side}) area[of_one] += sixth;
      for (const Index of_both : {low, low + side + 1}) area[of_both] += 2 * sixth;
    }
  }
  return area;
}

Difference difference(const Pressed& found, const Pressed& expected) {
  constexpr int across = 401;
  double reach = 0;
  for (const SideField* field : {&found.pressure, &expected.pressure}) {
    for (const std::vector<double>& planes : field->planes) reach = std::max(reach, planes.back());
  }
  double off = 0, all = 0;
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < across; ++i) {
      const double x = reach * ((2 * i + 1.0) / across - 1), y = reach * ((2 * j + 1.0) / across - 1);
      const double theirs = expected.pressure.at(x, y);
      off += std::pow(found.pressure.at(x, y) - theirs, 2);
      all += theirs * theirs;
    }
  }
  return {found.force / expected.force - 1, std::sqrt(off / all)};
}

}  // namespace greenloop::gel_pad
