#include "runtime/testing/half_space.hpp"

#include <cmath>
#include <numbers>

namespace greenloop {
namespace {

Eigen::Vector3d vector(const Vec4& v) { return {v.x, v.y, v.z}; }
Vec4 stored(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// Integrals over a rectangle around `offset` of 1 / r^3 times x^2, y^2 and x y, and of x / r^2.
struct Integrals {
  double xx = 0, yy = 0, xy = 0, x = 0;
};

Integrals integrals(const Eigen::Vector2d& offset, const Eigen::Vector2d& edges) {
  Integrals sum;
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      const double sign = sx * sy > 0 ? 1 : -1;
      const double x = offset.x() + sx * edges.x();
      const double y = offset.y() + sy * edges.y();
      const double r = std::hypot(x, y);
      sum.xx += sign * y * std::log(x + r);
      sum.yy += sign * x * std::log(y + r);
      sum.xy -= sign * r;
      sum.x += sign * (y * std::log(r) + x * std::atan(y / x));
    }
  }
  return sum;
}

}  // namespace

Eigen::Matrix3d HalfSpace::influence(const Eigen::Vector2d& offset, const Eigen::Vector2d& edges) const {
  const Integrals of = integrals(offset, edges);
  const Integrals turned = integrals({offset.y(), offset.x()}, {edges.y(), edges.x()});
  const double inverse = of.xx + of.yy;
  const double coupling = (1 - 2 * poisson) / 2;
  Eigen::Matrix3d block;
  block << (1 - poisson) * inverse + poisson * of.xx, poisson * of.xy, -coupling * of.x,  //
      poisson * of.xy, (1 - poisson) * inverse + poisson * of.yy, -coupling * turned.x,   //
      coupling * of.x, coupling * turned.x, (1 - poisson) * inverse;
  return block / (2 * std::numbers::pi * shear * edges.prod());
}

Eigen::Vector2d HalfSpacePatch::place(std::uint32_t i) const {
  const double middle = (across - 1) / 2.0;
  const std::uint32_t row = i / across;
  return cell * Eigen::Vector2d(row - middle, i % across - middle);
}

Eigen::Matrix3d HalfSpacePatch::influence(const Eigen::Vector2d& offset) const {
  return HalfSpace{shear, poisson}.influence(offset, {cell, cell});
}

ContactBench::ContactBench(std::uint32_t candidate_count)
    : candidates(candidate_count),
      force(candidate_count),
      displacement(candidate_count),
      state(candidate_count),
      block_(ContactCompliance::size(candidate_count)),
      problem_(candidate_count) {}

ContactBench::ContactBench(const HalfSpacePatch& patch) : ContactBench(patch.count()) {
  for (std::uint32_t j = 0; j < patch.count(); ++j) {
    for (std::uint32_t i = 0; i <= j; ++i) set_block(i, j, patch.influence(patch.place(i) - patch.place(j)));
    candidates[j].normal = {0, 0, 1};
  }
}

void ContactBench::set_block(std::uint32_t i, std::uint32_t j, const Eigen::Matrix3d& block) {
  const Eigen::Matrix3d upper = i <= j ? block : block.transpose();
  Block<3>& to = ContactCompliance{block_.data()}.at(std::min(i, j), std::max(i, j));
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3f column = upper.col(c).cast<float>();
    to.column[c] = Float4{column.x(), column.y(), column.z(), 0};
  }
}

Eigen::MatrixXd ContactBench::compliance() const {
  const auto count = static_cast<Eigen::Index>(candidates.size());
  Eigen::MatrixXd all(3 * count, 3 * count);
  ContactBench& self = const_cast<ContactBench&>(*this);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      const Block<3>& of = ContactCompliance{self.block_.data()}.at(i, j);
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) all(3 * i + r, 3 * j + c) = all(3 * j + c, 3 * i + r) = of.column[c][r];
      }
    }
  }
  return all;
}

ContactAnswer ContactBench::solve(const ContactAccuracy& accuracy, std::uint64_t work) {
  return problem_->solve(candidates, {block_.data()}, accuracy, work, force, state, displacement);
}

Eigen::Vector3d ContactBench::total() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Vec4& f : force) sum += vector(f);
  return sum;
}

ContactAnswer MovingTool::step(const std::vector<double>& gap, const Eigen::Vector3d& way,
                               const ContactAccuracy& accuracy) {
  for (std::size_t i = 0; i < shift_.size(); ++i) {
    ContactCandidate& candidate = bench_.candidates[i];
    const Eigen::Vector3d normal = vector(candidate.normal);
    const Eigen::Vector3d moved = -shift_[i] - way;
    candidate.gap = stored(gap[i] * normal + moved - normal.dot(moved) * normal);
  }
  const ContactAnswer answer = bench_.solve(accuracy);
  for (std::size_t i = 0; i < shift_.size(); ++i) {
    shift_[i] = vector(bench_.displacement[i]) - vector(bench_.candidates[i].gap);
  }
  return answer;
}

}  // namespace greenloop
