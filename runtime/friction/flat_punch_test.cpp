#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "runtime/testing/half_space.hpp"

namespace greenloop {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double edge = 2e-3;  // m, of the punch
constexpr double depth = 1e-5;
constexpr HalfSpace half_space{1e5, 0.5};

// The potential of a charged plate is the displacement under a punch: F = pi C E* d, with the capacity C of a square of
// edge 1 in units of 4 pi epsilon (Read 1997, Hwang & Mascagni 2004). King's fit of 1987 for a square punch is 0.9 %
// less.
double exact_force() {
  constexpr double capacity = 0.36679;
  return std::numbers::pi * capacity * 2 * half_space.shear / (1 - half_space.poisson) * edge * depth;
}

// where cells end, from side to side of the punch
std::vector<double> even_lines(std::uint32_t across) {
  std::vector<double> lines;
  for (std::uint32_t i = 0; i <= across; ++i) lines.push_back(edge * (static_cast<double>(i) / across - 0.5));
  return lines;
}

// the same, denser towards its edges, where the pressure is singular
std::vector<double> graded_lines(std::uint32_t across) {
  std::vector<double> lines = even_lines(across);
  for (double& line : lines) line = edge / 2 * std::sin(std::numbers::pi * line / edge);
  return lines;
}

// within each cell a force spreads evenly, and displacements are the means over a cell, so that compliances are
// symmetric: between unequal cells those of their middles would not be
class PressedCells {
 public:
  explicit PressedCells(const std::vector<double>& lines) : across_(lines.size() - 1), bench_(count()) {
    for (std::size_t k = 0; k < across_; ++k) {
      middle_.push_back((lines[k] + lines[k + 1]) / 2);
      width_.push_back(lines[k + 1] - lines[k]);
    }
    for (std::uint32_t j = 0; j < count(); ++j) {
      for (std::uint32_t i = 0; i <= j; ++i) bench_.set_block(i, j, mean_influence(i, j));
      bench_.candidates[j].normal = {0, 0, 1};
    }
  }

  // of the punch's force
  double error() {
    MovingTool tool(bench_);
    const ContactAnswer answer = tool.step(std::vector<double>(count(), -depth), Vector3d::Zero());
    CHECK(answer.residual <= 1e-3F);
    return bench_.total().z() / exact_force() - 1;
  }

 private:
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(across_ * across_); }
  [[nodiscard]] Vector2d edges(std::uint32_t i) const { return {width_[i / across_], width_[i % across_]}; }
  [[nodiscard]] Vector2d middle(std::uint32_t i) const { return {middle_[i / across_], middle_[i % across_]}; }

  // of what a force on cell j moves cell i by, by Gauss' rule
  [[nodiscard]] Matrix3d mean_influence(std::uint32_t i, std::uint32_t j) const {
    constexpr double place[4] = {-0.43056815579702629, -0.16999052179242813, 0.16999052179242813, 0.43056815579702629};
    constexpr double weight[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
    Matrix3d sum = Matrix3d::Zero();
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const Vector2d at = middle(i) + edges(i).cwiseProduct(Vector2d(place[a], place[b]));
        sum += weight[a] * weight[b] * half_space.influence(at - middle(j), edges(j));
      }
    }
    return sum;
  }

  std::size_t across_;
  ContactBench bench_;
  std::vector<double> middle_, width_;
};

std::vector<double> errors(std::vector<double> (*lines)(std::uint32_t), const std::string& name) {
  std::vector<double> error;
  for (const std::uint32_t across : {4U, 8U, 16U}) {
    error.push_back(PressedCells(lines(across)).error());
    MESSAGE(name << " cells, " << across << " across: " << 100 * error.back() << " % of the punch's force");
  }
  return error;
}

TEST_CASE("a square punch has the stiffness of theory, to second order in cells that are denser at its edges") {
  const std::vector<double> error = errors(graded_lines, "graded");
  CHECK(std::abs(error[1]) <= 0.03);
  CHECK(std::abs(error[2]) <= 0.01);
  CHECK(error[1] / error[0] <= 0.3);
  CHECK(error[2] / error[1] <= 0.3);
}

TEST_CASE("a square punch has the stiffness of theory, to first order in even cells") {
  const std::vector<double> error = errors(even_lines, "even");
  CHECK(std::abs(error[2]) <= 0.03);
  CHECK(std::abs(2 * error[2] - error[1]) <= 0.01);
  CHECK(error[1] / error[0] <= 0.6);
  CHECK(error[2] / error[1] <= 0.6);
}

}  // namespace
}  // namespace greenloop
