#include "offline/compress/measure/contact_patterns.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "offline/compress/measure/point_choice.hpp"

namespace greenloop::offline {
namespace {

using layout::PatternKind;
using Points = std::vector<std::size_t>;

constexpr double amplitude = 0.05;  // of the radius of a patch, or of what is pinched
constexpr double turn = 5 * std::numbers::pi / 180;
constexpr double gather = 0.05;
constexpr double sphere_radius = 2, sphere_depth = 0.25;  // over the radius of a patch
constexpr std::size_t most_shots = 512;
constexpr std::size_t least_sites = 4, site_overlap = 4;  // a point lies in about so many patches at most

// SplitMix64 (Steele, Lea & Flood 2014)
class Generator {
 public:
  explicit Generator(std::uint64_t seed) : state_(seed) {}

  // in [-1, 1)
  double number() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return std::ldexp(static_cast<double>((z ^ (z >> 31)) >> 11), -52) - 1;
  }

 private:
  std::uint64_t state_;
};

// Points that lie together.
class Patch {
 public:
  Patch(const TouchedSurface& surface, Points points) : surface_(surface), points_(std::move(points)) {
    double area = 0;
    for (const std::size_t i : points_) {
      centre_ += surface.positions()[i];
      normal_ += surface.normal(i);
      area += surface.area(i);
    }
    centre_ /= static_cast<double>(points_.size());
    // the two sides of a thin part cancel: then that of the place itself
    const bool clear = normal_.norm() > 0.1 * static_cast<double>(points_.size());
    normal_ = clear ? normal_.normalized() : surface.normal(points_.front());
    radius_ = std::sqrt(area / std::numbers::pi);
  }

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] const Eigen::Vector3d& normal() const { return normal_; }
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] const TouchedSurface& surface() const { return surface_; }

  [[nodiscard]] Eigen::Vector3d tangent() const {
    Eigen::Index least = 0;
    normal_.cwiseAbs().minCoeff(&least);
    return normal_.cross(Eigen::Vector3d::Unit(least)).normalized();
  }

  // one displacement a point, given its offset from the centre
  template <class Move>
  [[nodiscard]] Eigen::VectorXd displaced(Move move) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(3 * size()));
    for (std::size_t k = 0; k < size(); ++k) {
      const Eigen::Vector3d offset = surface_.positions()[points_[k]] - centre_;
      all.segment<3>(static_cast<Eigen::Index>(3 * k)) = move(k, offset);
    }
    return all;
  }

 private:
  const TouchedSurface& surface_;
  Points points_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(), normal_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

Eigen::VectorXd moved(const Patch& patch, const Eigen::Vector3d& by) {
  return patch.displaced([&](std::size_t, const Eigen::Vector3d&) { return by; });
}

Eigen::VectorXd turned(const Patch& patch, const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, axis).toRotationMatrix();
  return patch.displaced(
      [&](std::size_t, const Eigen::Vector3d& offset) -> Eigen::Vector3d { return rotation * offset - offset; });
}

Eigen::VectorXd gathered(const Patch& patch) {
  const Eigen::Vector3d& normal = patch.normal();
  return patch.displaced([&](std::size_t, const Eigen::Vector3d& offset) -> Eigen::Vector3d {
    return -gather * (offset - normal.dot(offset) * normal);
  });
}

// every point against the nearest of those before it
Eigen::VectorXd alternating(const Patch& patch) {
  const auto& surface = patch.surface();
  std::vector<double> sign(patch.size(), 1);
  return patch.displaced([&](std::size_t k, const Eigen::Vector3d&) -> Eigen::Vector3d {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < k; ++j) {
      const auto& positions = surface.positions();
      const double distance = (positions[patch.points()[k]] - positions[patch.points()[j]]).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      sign[k] = -sign[j];
    }
    return amplitude * patch.radius() * sign[k] * surface.normal(patch.points()[k]);
  });
}

Eigen::VectorXd random(const Patch& patch, std::uint64_t seed) {
  Generator generator(seed);
  return patch.displaced([&](std::size_t, const Eigen::Vector3d&) -> Eigen::Vector3d {
    const double x = generator.number(), y = generator.number(), z = generator.number();
    return amplitude * patch.radius() * Eigen::Vector3d(x, y, z);
  });
}

ContactSite site_of(const TouchedSurface& surface, const Points& points, std::uint32_t contacts) {
  ContactSite site{.contacts = contacts,
                   .rows = {},
                   .group = std::vector<std::uint32_t>(points.size(), 0),
                   .kinds = {},
                   .displacement = Eigen::MatrixXd(static_cast<Eigen::Index>(3 * points.size()), 0),
                   .sphere = {}};
  for (const std::size_t i : points) site.rows.push_back(surface.row(i));
  return site;
}

// nothing is held where it is
void add_sample(ContactSite& site, PatternKind kind, const Eigen::VectorXd& displacement, double size) {
  constexpr double least = 1e-9;
  if (!(displacement.cwiseAbs().maxCoeff() > least * size)) return;
  site.kinds.push_back(kind);
  site.displacement.conservativeResize(Eigen::NoChange, site.displacement.cols() + 1);
  site.displacement.rightCols<1>() = displacement;
}

// all that is done to one patch
ContactSite patch_site(const TouchedSurface& surface, std::size_t place, std::uint32_t contacts, std::uint64_t seed) {
  const Patch patch(surface, surface.nearest_facing(surface.positions()[place], Eigen::Vector3d::Zero(), contacts));
  ContactSite site = site_of(surface, patch.points(), contacts);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    add_sample(site, contacts == 1 ? PatternKind::node : PatternKind::patch,
               moved(patch, amplitude * patch.radius() * Eigen::Vector3d::Unit(axis)), patch.radius());
  }
  if (contacts == 1) return site;
  add_sample(site, PatternKind::turned, turned(patch, patch.normal()), patch.radius());
  add_sample(site, PatternKind::turned, turned(patch, patch.tangent()), patch.radius());
  add_sample(site, PatternKind::gathered, gathered(patch), patch.radius());
  add_sample(site, PatternKind::alternating, alternating(patch), patch.radius());
  add_sample(site, PatternKind::random, random(patch, seed), patch.radius());
  return site;
}

ContactSite sphere_site(const TouchedSurface& surface, std::size_t place, std::uint32_t contacts) {
  const Eigen::Vector3d& at = surface.positions()[place];
  const Eigen::Vector3d& normal = surface.normal(place);
  const Patch patch(surface, surface.nearest_facing(at, normal, contacts));
  const double radius = sphere_radius * patch.radius();
  const RigidSphere sphere{at + (radius - sphere_depth * patch.radius()) * normal, radius};
  ContactSite site = site_of(surface, patch.points(), contacts);
  add_sample(site, PatternKind::sphere, patch.displaced([&](std::size_t k, const Eigen::Vector3d&) {
    return sphere.displacement(surface.positions()[patch.points()[k]]);
  }),
             patch.radius());
  site.sphere = sphere;
  return site;
}

// two groups of points, moved by `a` and by `b`
std::optional<ContactSite> two_groups(const TouchedSurface& surface, PatternKind kind, std::uint32_t contacts,
                                      const Points& first, const Points& second, const Eigen::Vector3d& a,
                                      const Eigen::Vector3d& b) {
  Points all = first;
  for (const std::size_t i : second) {
    if (std::find(first.begin(), first.end(), i) != first.end()) return {};
    all.push_back(i);
  }
  if (all.size() != contacts) return {};
  ContactSite site = site_of(surface, all, contacts);
  Eigen::VectorXd displacement(static_cast<Eigen::Index>(3 * all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) {
    site.group[k] = k < first.size() ? 0 : 1;
    displacement.segment<3>(static_cast<Eigen::Index>(3 * k)) = k < first.size() ? a : b;
  }
  add_sample(site, kind, displacement, a.norm());
  return site;
}

// a place and how thick the body is there, m
struct ThinPlace {
  std::size_t point = 0;
  double thickness = 0;
};

// the thinnest third, the thinnest first
std::vector<ThinPlace> thin_places(const TouchedSurface& surface) {
  std::vector<ThinPlace> places;
  for (const std::size_t point : farthest_points(surface.positions(), most_shots)) {
    if (const auto thickness = surface.thickness(point)) places.push_back({point, *thickness});
  }
  std::sort(places.begin(), places.end(), [](const ThinPlace& a, const ThinPlace& b) {
    return std::pair(a.thickness, a.point) < std::pair(b.thickness, b.point);
  });
  places.resize((places.size() + 2) / 3);
  return places;
}

std::optional<ContactSite> pinch_site(const TouchedSurface& surface, const ThinPlace& place, std::uint32_t contacts) {
  const Eigen::Vector3d& at = surface.positions()[place.point];
  const Eigen::Vector3d normal = surface.normal(place.point), far = at - place.thickness * normal;
  const Points near_finger = surface.nearest_facing(at, normal, contacts - contacts / 2);
  const Points far_finger = surface.nearest_facing(far, -normal, contacts / 2);
  if (far_finger.empty()) return {};
  // the far side can be touched
  const double gap = (surface.positions()[far_finger.front()] - far).norm();
  if (gap > std::max(place.thickness, std::sqrt(surface.area(far_finger.front())))) return {};
  const Eigen::Vector3d press = amplitude * place.thickness * normal;
  return two_groups(surface, PatternKind::pinch, contacts, near_finger, far_finger, -press, press);
}

void add_pinches(const TouchedSurface& surface, const std::vector<ThinPlace>& thin, std::uint32_t contacts,
                 std::size_t sites, std::vector<ContactSite>& all) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(thin.size());
  for (const ThinPlace& place : thin) positions.push_back(surface.positions()[place.point]);
  for (const std::size_t i : farthest_points(positions, sites)) {
    if (auto site = pinch_site(surface, thin[i], contacts)) all.push_back(std::move(*site));
  }
}

// each place against the farthest of them, along one axis after the other
void add_opposed(const TouchedSurface& surface, const Points& places, std::uint32_t contacts,
                 std::vector<ContactSite>& all) {
  const auto& at = surface.positions();
  for (std::size_t s = 0; s < places.size(); ++s) {
    const auto distance = [&](std::size_t i) { return (at[i] - at[places[s]]).squaredNorm(); };
    const std::size_t partner = *std::max_element(
        places.begin(), places.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    const Points first = surface.nearest_facing(at[places[s]], Eigen::Vector3d::Zero(), contacts - contacts / 2);
    const Points second = surface.nearest_facing(at[partner], Eigen::Vector3d::Zero(), contacts / 2);
    const Eigen::Vector3d by =
        amplitude * Patch(surface, first).radius() * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(s % 3));
    auto site = two_groups(surface, PatternKind::opposed, contacts, first, second, by, -by);
    if (site) all.push_back(std::move(*site));
  }
}

}  // namespace

std::vector<std::uint32_t> pattern_sizes(std::uint32_t max_contacts, std::size_t points) {
  std::vector<std::uint32_t> sizes = {1, 4, 16, 64};
  if (max_contacts > 1 && max_contacts <= layout::most_pattern_contacts) sizes.push_back(max_contacts);
  std::sort(sizes.begin(), sizes.end());
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  std::erase_if(sizes, [&](std::uint32_t contacts) { return contacts > points; });
  return sizes;
}

std::vector<ContactSite> contact_patterns(const TouchedSurface& surface, std::uint32_t max_contacts,
                                          std::size_t sites) {
  const auto thin = thin_places(surface);
  std::vector<ContactSite> all;
  for (const std::uint32_t contacts : pattern_sizes(max_contacts, surface.size())) {
    const std::size_t most = std::max(least_sites, site_overlap * surface.size() / contacts);
    const Points places = farthest_points(surface.positions(), std::min(sites, most));
    for (std::size_t s = 0; s < places.size(); ++s) {
      all.push_back(patch_site(surface, places[s], contacts, 1000 * std::uint64_t{contacts} + s));
      all.push_back(sphere_site(surface, places[s], contacts));
    }
    if (contacts == 1) continue;
    add_pinches(surface, thin, contacts, places.size(), all);
    add_opposed(surface, places, contacts, all);
  }
  std::erase_if(all, [](const ContactSite& site) { return site.kinds.empty(); });
  return all;
}

}  // namespace greenloop::offline
