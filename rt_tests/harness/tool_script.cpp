#include "rt_tests/harness/tool_script.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double usual_frictions[] = {0, 1e-6, 0.3, 1, 10, 100};
constexpr std::uint64_t stay = 32;  // cycles that a tool presses at a place

Double3 double3(const float* x) { return {x[0], x[1], x[2]}; }

// turns the tool's z axis against a direction, the shortest way
void face(const Double3& direction, Pose& pose) {
  const double w = 1 - direction.z, x = direction.y, y = -direction.x, length = std::sqrt(w * w + x * x + y * y);
  const double q[4] = {w, x, y, 0}, half_turn[4] = {0, 1, 0, 0};
  for (int k = 0; k < 4; ++k) pose.quaternion[k] = length > 1e-3 ? q[k] / length : half_turn[k];
}

}  // namespace

ToolScript::ToolScript(const Model& model, const ContactBody::Requirement& need, ToolScriptKind kind,
                       std::uint64_t seed)
    : kind_(kind), need_(need), random_(seed + 1000 * static_cast<std::uint64_t>(kind)) {
  if (kind == ToolScriptKind::wander) wander_.emplace(model, need, seed);
  read_surface(model);
  const double r = 2 * edge_;
  const Double3 corner[] = {{r, r, r}, {r, -r, -r}, {-r, r, -r}, {-r, -r, r}};
  const ConvexPolyhedron::Face face[] = {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 3, 1}}, {{1, 3, 2}}};
  solid_memory_ = AlignedBytes(ConvexPolyhedron::required(4, 4));
  solid_ = ConvexPolyhedron::create(corner, face, {solid_memory_.data(), solid_memory_.size()}).polyhedron;
}

void ToolScript::read_surface(const Model& model) {
  const std::uint32_t finest = model.level_count() - 1;
  AlignedBytes memory(Surface::required(model, finest).bytes);
  const auto created = Surface::create(model, finest, {memory.data(), memory.size()});
  if (!created) throw std::runtime_error("no surface of this model");
  const Surface& surface = created.surface;
  std::vector<Vec4> normals(surface.node_count(finest));
  surface.normals(finest, {}, normals);
  std::vector<Double3> positions(normals.size());
  Double3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  visit_nodes(model.view(), [&](std::uint32_t node, const layout::NodeRecord& record) {
    const Double3 x = positions[node] = double3(record.position);
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    const Vec4& n = normals[node];
    auto& places = (record.flags & layout::node_touchable) != 0 ? touchable_ : fixed_;
    places.push_back({x, {n.x, n.y, n.z}});
  });
  if (touchable_.empty()) throw std::runtime_error("no node of this model can be touched");
  if (fixed_.empty()) fixed_ = touchable_;
  double edges = 0;
  for (std::uint32_t t = 0; t < surface.triangle_count(finest); ++t) {
    const auto& [a, b, c] = surface.triangle(finest, t).node;
    const Double3 normal = unit(cross(positions[b] - positions[a], positions[c] - positions[a]));
    between_.push_back({0.5 * (positions[a] + positions[b]), normal});
    between_.push_back({1.0 / 3 * (positions[a] + positions[b] + positions[c]), normal});
    edges += norm(positions[b] - positions[a]);
  }
  edge_ = edges / surface.triangle_count(finest);
  size_ = std::min({high.x - low.x, high.y - low.y, high.z - low.z});
}

ToolScript::Cycle ToolScript::next(ContactBody& body) {
  Cycle cycle = wander_ ? wander_->next(body) : cycle_of(body);
  ++cycle_;
  return cycle;
}

ToolScript::Cycle ToolScript::cycle_of(ContactBody& body) {
  Cycle cycle;
  std::uint32_t count = most_tools;
  cycle.budget = {need_.worst_work};
  for (std::uint32_t t = 0; t < count; ++t) {
    const bool put_down = random_() % 64 == 0;
    switch (kind_) {
      case ToolScriptKind::wander:
      case ToolScriptKind::press:
      case ToolScriptKind::starve:
        press(t, usual_frictions);
        break;
      case ToolScriptKind::teleport:
        teleport(t);
        break;
      case ToolScriptKind::spin:
        spin(t);
        break;
      case ToolScriptKind::inside:
        go_inside(t);
        break;
      case ToolScriptKind::outside:
        go_outside(t);
        break;
      case ToolScriptKind::graze:
        graze(t);
        break;
      case ToolScriptKind::edges:
        meet_edges(t);
        break;
      case ToolScriptKind::fixed:
        touch_fixed(t);
        break;
      case ToolScriptKind::crowd:
        crowd(t);
        break;
      case ToolScriptKind::garbage:
        if (!place(tool_[t].tool.pose)) tool_[t].tool.pose = {};
        press(t, usual_frictions);
        cycle.is_sound = !spoil(t) && cycle.is_sound;
        break;
    }
    if (put_down) body.forget(t);
  }
  if (kind_ == ToolScriptKind::garbage && random_() % 16 == 0) {
    tool_[count++] = tool_[0];
    cycle.is_sound = false;
  }
  if (kind_ == ToolScriptKind::starve) {
    const std::uint64_t span = need_.worst_work - need_.least_work + 1;
    const std::uint64_t budgets[] = {need_.least_work - 1, need_.least_work, need_.least_work + random_() % span,
                                     need_.least_work + random_() % (span / 8 + 1)};
    cycle.budget = {budgets[random_() % 4]};
  }
  cycle.tools = {tool_, count};
  return cycle;
}

void ToolScript::put(std::uint32_t tool, const Shape& shape, const Double3& position, double friction) {
  ContactBody::ToolInput& input = tool_[tool];
  input.tool.shape = shape;
  input.tool.pose.position = position;
  input.friction = friction;
}

// the place that a tool has for some cycles, then another
const ToolScript::Place& ToolScript::stay_at(std::uint32_t tool, const std::vector<Place>& places) {
  if ((cycle_ + 7 * tool) % stay == 0) {
    at_[tool] = static_cast<std::size_t>(random_());
    shape_[tool] = any_shape(random_() % 2 == 0 ? edge_ : 0.2 * size_);
    turn(tool_[tool].tool.pose);
  }
  return places[at_[tool] % places.size()];
}

void ToolScript::press(std::uint32_t tool, std::span<const double> frictions) {
  const Place& place = stay_at(tool, touchable_);
  const auto phase = static_cast<double>((cycle_ + 7 * tool) % stay) / stay;
  const double depth = (phase - 0.3) * 0.1 * size_, along = std::max(0.0, phase - 0.5) * 0.1 * size_;
  const Double3 across = unit(cross(place.normal, {0.3, 0.5, 0.8}));
  const double reach = shape_[tool].kind() == Shape::Kind::plane ? 0 : shape_[tool].bounding_radius();
  if (shape_[tool].kind() == Shape::Kind::plane) face(place.normal, tool_[tool].tool.pose);
  put(tool, shape_[tool], place.position + (reach - depth) * place.normal + along * across,
      frictions[cycle_ / 5 % frictions.size()]);
}

void ToolScript::teleport(std::uint32_t tool) {
  put(tool, any_shape(random_() % 2 == 0 ? edge_ : 0.3 * size_), any(touchable_).position + vector(size_), 0.3);
  turn(tool_[tool].tool.pose);
}

void ToolScript::spin(std::uint32_t tool) {
  const Place& place = stay_at(tool, touchable_);
  put(tool, shape_[tool], place.position + between(-0.5, 0.5) * edge_ * place.normal, 0.5);
  turn(tool_[tool].tool.pose);
}

void ToolScript::go_inside(std::uint32_t tool) {
  const Place& place = stay_at(tool, touchable_);
  const double depth = random_() % 4 == 0 ? between(-0.2, 0.5) : 0.3 + 0.1 * between(-1, 1);
  put(tool, shape_[tool], place.position - depth * size_ * place.normal, 0.3);
}

void ToolScript::go_outside(std::uint32_t tool) {
  const Place& place = any(touchable_);
  const double distance = random_() % 8 == 0 ? 1e5 : random_() % 2 == 0 ? 0.3 * size_ + edge_ : 3 * size_;
  Shape shape = any_shape(edge_);
  while (shape.kind() == Shape::Kind::plane) shape = any_shape(edge_);  // half of space is nowhere outside
  put(tool, shape, place.position + distance * place.normal, 0.3);
}

void ToolScript::graze(std::uint32_t tool) {
  const Place& place = stay_at(tool, random_() % 2 == 0 ? touchable_ : between_);
  const double radius = shape_[tool].kind() == Shape::Kind::plane ? 0 : shape_[tool].bounding_radius();
  const double gaps[] = {0, 1e-16, 1e-12, 1e-9, 1e-7, 1e-5};
  const double gap = gaps[random_() % 6] * (random_() % 2 == 0 ? 1 : -1);
  put(tool, random_() % 2 == 0 ? shape_[tool] : Shape::sphere(std::max(radius, 1e-6)),
      place.position + (std::max(radius, 1e-6) + gap) * place.normal, 0.3);
}

void ToolScript::meet_edges(std::uint32_t tool) {
  const Place& place = any(random_() % 2 == 0 ? touchable_ : between_);
  const double half = edge_ * between(0.2, 2);
  const Double3 corners[] = {{0, 0, 0}, {half, half, half}, {half, 0, 0}, {0, half, half}};
  const Shape shapes[] = {Shape(), Shape::box({half, half, half}), Shape::capsule(0.1 * half, half),
                          Shape::sphere(half), Shape::plane()};
  tool_[tool].tool.pose = {};
  put(tool, shapes[random_() % 5], place.position + corners[random_() % 4], 0.3);
}

void ToolScript::touch_fixed(std::uint32_t tool) {
  const Place& place = stay_at(tool, fixed_);
  put(tool, shape_[tool], place.position + between(-1, 1) * 0.05 * size_ * place.normal, usual_frictions[cycle_ % 6]);
}

void ToolScript::crowd(std::uint32_t tool) {
  const Place& place = stay_at(0, touchable_);
  if (tool > 0 && cycle_ % stay == 0) shape_[tool] = any_shape(edge_ * between(0.5, 3));
  put(tool, shape_[tool], place.position + vector(0.2 * edge_), usual_frictions[tool]);
}

// whether something is wrong with it that must be refused or left out
bool ToolScript::spoil(std::uint32_t tool) {
  ContactBody::ToolInput& input = tool_[tool];
  Pose& pose = input.tool.pose;
  switch (random_() % 12) {
    case 0:
      pose.position.x = not_a_number;
      return true;
    case 1:
      pose.position.z = -infinity;
      return true;
    case 2:
      pose.position.y = 1.1e6;
      return true;
    case 3:
      pose = {pose.position, {0, 0, 0, 0}};
      return true;
    case 4:
      pose = {pose.position, {2, 0, 0, 0}};
      return true;
    case 5:
      pose = {pose.position, {not_a_number, 0, 0, 1}};
      return true;
    case 6:
      input.tool.shape = Shape::sphere(random_() % 2 == 0 ? not_a_number : -edge_);
      return true;
    case 7:
      input.tool.shape = Shape::box({edge_, infinity, edge_});
      return true;
    case 8:
      input.tool.shape = Shape::polyhedron({});
      return true;
    case 9:
      input.friction = random_() % 2 == 0 ? not_a_number : -1;
      return true;
    case 10:  // nearly a unit quaternion: it is made one
      pose = {pose.position, {1.009, 0, 0, 0}};
      return false;
    default:
      input.friction = 1e30;
      return true;
  }
}

Shape ToolScript::any_shape(double size) {
  switch (random_() % 6) {
    case 0:
      return {};
    case 1:
      return Shape::sphere(size * between(0.1, 1.5));
    case 2:
      return Shape::capsule(size * between(0.05, 0.5), size * between(0, 2));
    case 3:
      return Shape::box({size * between(0.1, 1), size * between(0.1, 1), size * between(0.1, 1)});
    case 4:
      return Shape::plane();
    default:
      return Shape::polyhedron(solid_);
  }
}

double ToolScript::between(double low, double high) {
  return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
}

Double3 ToolScript::vector(double most) {
  const double x = between(-most, most), y = between(-most, most), z = between(-most, most);
  return {x, y, z};
}

void ToolScript::turn(Pose& pose) {
  double sum = 0;
  for (double& part : pose.quaternion) {
    part = between(-1, 1);
    sum += part * part;
  }
  const double length = std::sqrt(sum);
  for (double& part : pose.quaternion) part = length > 1e-3 ? part / length : 0.5;
}

}  // namespace greenloop
