#include "rt_tests/harness/touching_script.hpp"

#include <limits>

#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

double least(double a, double b) { return a < b ? a : b; }

}  // namespace

TouchingScript::TouchingScript(const Model& model, const ContactBody::Requirement& need, std::uint64_t seed) noexcept
    : need_(need), state_(seed) {
  Double3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  visit_nodes(model.view(), [&](std::uint32_t, const layout::NodeRecord& record) {
    const float* x = record.position;
    low = {least(low.x, x[0]), least(low.y, x[1]), least(low.z, x[2])};
    high = {-least(-high.x, -x[0]), -least(-high.y, -x[1]), -least(-high.z, -x[2])};
  });
  middle_ = 0.5 * (low + high);
  reach_ = 0.5 * least(high.x - low.x, least(high.y - low.y, high.z - low.z));
  const double r = 0.3 * reach_;
  const Double3 corner[corners] = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  const ConvexPolyhedron::Face face[faces] = {{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}}, {{3, 0, 4}},
                                              {{2, 0, 5}}, {{1, 2, 5}}, {{3, 1, 5}}, {{0, 3, 5}}};
  solid_ = ConvexPolyhedron::create(corner, face, solid_memory_).polyhedron;
  for (Path& path : path_) put_down(path);
}

TouchingScript::Cycle TouchingScript::next(ContactBody& body) noexcept {
  Cycle cycle;
  std::uint32_t count = below(10) == 0 ? below(most_tools + 1) : most_tools;
  if (below(50) == 0) count = most_tools + 1;
  cycle.is_sound = count <= most_tools;
  for (std::uint32_t t = 0; t < count; ++t) {
    Path& path = path_[t];
    if (below(100) == 0) {
      put_down(path);
      if (below(2) == 0) body.forget(t);
    }
    wander(path);
    ContactBody::ToolInput& tool = tool_[t];
    tool = {{shape_of(path.shape), {middle_ + path.distance * path.way, {}}}, path.friction};
    for (int k = 0; k < 4; ++k) tool.tool.pose.quaternion[k] = path.quaternion[k];
    if (below(60) == 0) cycle.is_sound = !spoil(tool) && cycle.is_sound;
  }
  cycle.tools = {tool_, count};
  cycle.budget = draw_budget();
  return cycle;
}

Shape TouchingScript::shape_of(std::uint32_t number) const noexcept {
  switch (number) {
    case 0:
      return {};
    case 1:
      return Shape::sphere(0.3 * reach_);
    case 2:
      return Shape::capsule(0.1 * reach_, 0.3 * reach_);
    case 3:
      return Shape::box({0.2 * reach_, 0.3 * reach_, 0.1 * reach_});
    case 4:
      return Shape::plane();
    default:
      return Shape::polyhedron(solid_);
  }
}

void TouchingScript::put_down(Path& path) noexcept {
  path.way = unit(Double3{uniform(), uniform(), uniform() + 0x1p-20});
  path.distance = (1.2 + 0.4 * uniform()) * reach_;
  path.shape = below(6);
  path.friction = below(4) == 0 ? 0 : 0.5 + 0.5 * uniform();
  turn(path, 1);
}

void TouchingScript::wander(Path& path) noexcept {
  path.way = unit(path.way + 0.02 * Double3{uniform(), uniform(), uniform()});
  path.speed = 0.95 * path.speed + 2e-3 * reach_ * uniform();
  path.distance += path.speed;
  if (path.distance > 1.6 * reach_ || path.distance < 0.7 * reach_) path.speed = -path.speed;
  turn(path, 0.02);
}

void TouchingScript::turn(Path& path, double much) noexcept {
  double sum = 0;
  for (double& part : path.quaternion) {
    part += much * uniform();
    sum += part * part;
  }
  const double length = std::sqrt(sum);
  for (double& part : path.quaternion) part /= length;
}

// whether something is wrong with it that must be refused
bool TouchingScript::spoil(ContactBody::ToolInput& tool) noexcept {
  Pose& pose = tool.tool.pose;
  switch (below(9)) {
    case 0:
      pose.position.y = not_a_number;
      break;
    case 1:
      pose.position.x = -infinity;
      break;
    case 2:
      pose.position.z = 1e7;
      break;
    case 3:
      pose.quaternion[below(4)] += 0.5;
      break;
    case 4:
      pose.quaternion[2] = not_a_number;
      break;
    case 5:
      tool.tool.shape = Shape::sphere(uniform() > 0 ? not_a_number : -1);
      break;
    case 6:
      tool.friction = uniform() > 0 ? not_a_number : -0.5;
      break;
    case 7:
      tool.friction = 1e30;
      break;
    default:  // far, but not too far
      pose.position = 1e5 * Double3{uniform(), uniform(), uniform()};
      return false;
  }
  return true;
}

Budget TouchingScript::draw_budget() noexcept {
  const std::uint64_t least_work = need_.least_work;
  const std::uint64_t most = need_.worst_work;
  switch (below(8)) {
    case 0:
      return {random() % least_work};
    case 1:
      return {least_work};
    case 2:
    case 3:
      return {least_work + random() % (most - least_work + 1)};
    default:
      return {most};
  }
}

std::uint64_t TouchingScript::random() noexcept {  // splitmix64 (Steele, Lea & Flood 2014)
  state_ += 0x9e3779b97f4a7c15;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

std::uint32_t TouchingScript::below(std::uint32_t bound) noexcept {
  return static_cast<std::uint32_t>((random() >> 32) * bound >> 32);
}

double TouchingScript::uniform() noexcept { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; }

}  // namespace greenloop
