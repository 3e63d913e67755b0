#include "offline/appearance/radiance_transfer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "runtime/light.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::Vector3f;

constexpr Index coefficients = Light::coefficients;

/// A vertex's own directions: its normal, and a tangent that goes with the surface.
struct Frame {
  Vector3f normal = Vector3f::Zero(), tangent = Vector3f::Zero();
};

std::vector<Frame> vertex_frames(const LitSurface& surface) {
  std::vector<Frame> frames(surface.positions.size());
  for (const auto& corner : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f& at = surface.positions[corner[k]];
      const Vector3f edge = surface.positions[corner[(k + 1) % 3]] - at;
      Frame& frame = frames[corner[k]];
      frame.normal += edge.cross(surface.positions[corner[(k + 2) % 3]] - at);
      if (frame.tangent.isZero(0)) frame.tangent = edge;
    }
  }
  for (Frame& frame : frames) {
    frame.normal.normalize();
    frame.tangent -= frame.normal * frame.normal.dot(frame.tangent);
    frame.tangent = frame.tangent.norm() > 0 ? frame.tangent.normalized() : frame.normal.unitOrthogonal();
  }
  return frames;
}

/// A number in 0..1 of each vertex, ray and dimension (SplitMix64).
float jitter(std::uint64_t seed, std::uint64_t vertex, std::uint64_t sample) {
  std::uint64_t x = (seed << 56U) ^ (vertex << 24U) ^ sample;
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<float>((x ^ (x >> 31U)) >> 40U) * 0x1p-24F;
}

/// Ray k of side^2 in the hemisphere, by the cosine law: its projection is uniform in the disc.
Vector3f direction_of(const Frame& frame, std::uint64_t seed, std::uint64_t vertex, std::uint32_t k,
                      std::uint32_t side) {
  const std::uint32_t row = k / side, column = k % side;
  const std::uint64_t sample = std::uint64_t{2} * k;
  const float u = (static_cast<float>(column) + jitter(seed, vertex, sample)) / static_cast<float>(side);
  const float v = (static_cast<float>(row) + jitter(seed, vertex, sample + 1)) / static_cast<float>(side);
  const float radius = std::sqrt(u), angle = 2 * std::numbers::pi_v<float> * v;
  const Vector3f across = frame.normal.cross(frame.tangent);
  return radius * (std::cos(angle) * frame.tangent + std::sin(angle) * across) + std::sqrt(1 - u) * frame.normal;
}

/// What a vertex sees of others, one entry for each ray that meets them.
struct SeenVertices {
  std::vector<std::size_t> end;  ///< of each vertex's entries
  std::vector<RayHit> hits;
};

using Coefficients = Eigen::Vector<float, coefficients>;

Coefficients harmonics_of(const Vector3f& direction) {
  float value[coefficients];
  light_harmonics({direction.x(), direction.y(), direction.z()}, value);
  return Eigen::Map<const Coefficients>(value);
}

/// The mean of the harmonics over all of a hemisphere, by the cosine law (Ramamoorthi & Hanrahan 2001).
Coefficients open_sky(const Vector3f& normal) {
  Coefficients mean = harmonics_of(normal);
  mean.segment<3>(1) *= 2.0F / 3;
  mean.segment<5>(4) *= 0.25F;
  mean.segment<7>(9).setZero();
  return mean;
}

/// What light brings, [16][vertices], before it is reflected; `seen` gets what is met instead. The whole sky is known:
/// what rays make of it corrects what they make of its open part (a control variate).
MatrixXf light_from_outside(const LitSurface& surface, const TransferGoal& goal, SeenVertices& seen) {
  const RayScene scene(surface);
  const auto frames = vertex_frames(surface);
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : surface.positions) box.extend(position);
  constexpr float above = 1e-5F;  // of the scene's size: where rays begin, off the surface
  const float near = above * box.diagonal().norm();
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(goal.rays))));
  MatrixXf direct = MatrixXf::Zero(coefficients, static_cast<Index>(surface.positions.size()));
  const float share = 1 / static_cast<float>(side * side);  // of a ray
  for (std::size_t v = 0; v < surface.positions.size(); ++v) {
    Coefficients open = Coefficients::Zero(), all = Coefficients::Zero();
    float open_share = 0;
    for (std::uint32_t k = 0; k < side * side && !frames[v].normal.isZero(0); ++k) {
      const Vector3f direction = direction_of(frames[v], goal.seed, v, k, side);
      const auto hit = scene.first_hit(surface.positions[v] + near * frames[v].normal, direction, near);
      const Coefficients harmonics = share * harmonics_of(direction);
      all += harmonics;
      if (!hit) {
        open += harmonics;
        open_share += share;
      } else if (hit->in_front) {
        seen.hits.push_back(*hit);
      }
    }
    seen.end.push_back(seen.hits.size());
    direct.col(static_cast<Index>(v)) = open + open_share * (open_sky(frames[v].normal) - all);
  }
  return direct;
}

using Transfer = Eigen::Vector<float, 3 * coefficients>;

/// Light from outside and what the surface sends with `transfer`, reflected once.
MatrixXf reflected(const LitSurface& surface, const MatrixXf& direct, const SeenVertices& seen, std::uint32_t rays,
                   const MatrixXf& transfer) {
  MatrixXf result(3 * coefficients, direct.cols());
  std::size_t k = 0;
  for (Index v = 0; v < direct.cols(); ++v) {
    Transfer sum = Transfer::Zero();
    for (; k < seen.end[static_cast<std::size_t>(v)]; ++k) {
      const RayHit& hit = seen.hits[k];
      const auto& corner = surface.triangles[hit.triangle];
      sum += (1 - hit.u - hit.v) * transfer.col(corner[0]) + hit.u * transfer.col(corner[1]) +
             hit.v * transfer.col(corner[2]);
    }
    sum /= static_cast<float>(rays);
    for (Index c = 0; c < 3; ++c) {
      result.col(v).segment<coefficients>(coefficients * c) =
          surface.reflectance[static_cast<std::size_t>(v)][c] *
          (direct.col(v) + sum.segment<coefficients>(coefficients * c));
    }
  }
  return result;
}

}  // namespace

MatrixXf radiance_transfer(const LitSurface& surface, const TransferGoal& goal) {
  SeenVertices seen;
  const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(goal.rays))));
  const MatrixXf direct = light_from_outside(surface, goal, seen);
  const MatrixXf nothing = MatrixXf::Zero(3 * coefficients, direct.cols());
  MatrixXf transfer =
      reflected(surface, direct, SeenVertices{std::vector<std::size_t>(seen.end.size()), {}}, side * side, nothing);
  for (std::uint32_t bounce = 0; bounce < goal.bounces; ++bounce) {
    MatrixXf next = reflected(surface, direct, seen, side * side, transfer);
    const double change = (next - transfer).norm();
    transfer = std::move(next);
    if (change <= goal.change * transfer.norm()) break;
  }
  return transfer;
}

}  // namespace greenloop::offline
