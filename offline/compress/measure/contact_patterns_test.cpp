#include "offline/compress/measure/contact_patterns.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "formats/write/describe.hpp"
#include "offline/compress/measure/point_choice.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/compress/wavelet/node_order.hpp"

namespace greenloop::offline {
namespace {

using layout::PatternKind;

// every node of a closed surface may be touched but those left of the plane x = fixed_below
struct Surface {
  SemiRegularMesh mesh;
  std::vector<std::uint32_t> flags;
  std::vector<double> area;
  SurfaceWavelet wavelet;
  TouchedSurface touched;

  explicit Surface(SemiRegularMesh surface, double fixed_below = -0.85)
      : mesh(std::move(surface)),
        flags(flags_of(mesh, fixed_below)),
        area(test::nodal_area(mesh)),
        wavelet(mesh, flags, area, layout::Wavelet::lifted_linear),
        touched(mesh, flags, area, wavelet) {}

  static std::vector<std::uint32_t> flags_of(const SemiRegularMesh& mesh, double fixed_below) {
    std::vector<std::uint32_t> flags;
    for (const auto& x : mesh.positions) {
      flags.push_back(x.x() < fixed_below ? layout::node_fixed : layout::node_touchable | layout::node_read);
    }
    return mark_domain(mesh, flags);
  }

  [[nodiscard]] const Eigen::Vector3d& position(std::size_t row) const { return mesh.positions[wavelet.nodes()[row]]; }
};

const Surface& ball() {
  static const Surface value(test::icosphere(3));
  return value;
}

// a lens of radius 1, 0.12 thick in the middle
const Surface& lens() {
  static const Surface value = [] {
    auto mesh = test::octasphere(4);
    for (auto& x : mesh.positions) x.z() *= 0.06;
    return Surface(std::move(mesh));
  }();
  return value;
}

const std::vector<ContactSite>& sites_of(const Surface& surface) {
  static const auto of_ball = contact_patterns(ball().touched, 16, 6),
                    of_lens = contact_patterns(lens().touched, 16, 6);
  return &surface == &lens() ? of_lens : of_ball;
}

// calls visit(site, displacement of each contact) for every sample of a kind
template <class Visit>
std::size_t visit(const Surface& surface, PatternKind kind, Visit visit) {
  std::size_t count = 0;
  for (const auto& site : sites_of(surface)) {
    for (std::size_t k = 0; k < site.kinds.size(); ++k) {
      if (site.kinds[k] != kind) continue;
      ++count;
      const Eigen::Map<const Eigen::Matrix3Xd> moved(site.displacement.col(static_cast<Eigen::Index>(k)).data(), 3,
                                                     static_cast<Eigen::Index>(site.rows.size()));
      visit(site, Eigen::Matrix3Xd(moved));
    }
  }
  return count;
}

Eigen::Matrix3Xd positions_of(const Surface& surface, const ContactSite& site) {
  Eigen::Matrix3Xd at(3, static_cast<Eigen::Index>(site.rows.size()));
  for (std::size_t i = 0; i < site.rows.size(); ++i) {
    at.col(static_cast<Eigen::Index>(i)) = surface.position(site.rows[i]);
  }
  return at;
}

TEST_CASE("sizes of patterns: 1, 4, 16, 64 and the scene's, up to 256 and what the surface has") {
  using Sizes = std::vector<std::uint32_t>;
  CHECK(pattern_sizes(16, 1000) == Sizes{1, 4, 16, 64});
  CHECK(pattern_sizes(20, 1000) == Sizes{1, 4, 16, 20, 64});
  CHECK(pattern_sizes(256, 1000) == Sizes{1, 4, 16, 64, 256});
  CHECK(pattern_sizes(257, 1000) == Sizes{1, 4, 16, 64});
  CHECK(pattern_sizes(1, 16) == Sizes{1, 4, 16});
}

TEST_CASE("farthest points: each farther from those before than any other is; nearest points by distance") {
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {10, 0, 0}, {5, 0, 0}};
  CHECK(farthest_points(line, 3) == std::vector<std::size_t>{0, 3, 4});
  CHECK(farthest_points(line, 9).size() == 5);
  CHECK(farthest_points({}, 3).empty());
  CHECK(nearest_points(line, {1.6, 0, 0}, 3) == std::vector<std::size_t>{2, 1, 0});
}

TEST_CASE("normals point outward, whichever way the triangles are turned") {
  auto turned = test::icosphere(2);
  for (auto& triangle : turned.base_triangles) std::swap(triangle[0], triangle[1]);
  for (const auto& mesh : {test::icosphere(2), turned}) {
    const Surface surface(mesh);
    for (std::size_t i = 0; i < surface.touched.size(); ++i) {
      CHECK(surface.touched.normal(i).dot(surface.touched.positions()[i]) > 0.99);
    }
  }
}

TEST_CASE("only touchable nodes are touched; thickness is measured along the inward normal") {
  for (std::size_t i = 0; i < ball().touched.size(); ++i) CHECK(ball().touched.positions()[i].x() >= -0.85);
  CHECK(*ball().touched.thickness(7) == doctest::Approx(2).epsilon(0.03));
  const auto middle = lens().touched.nearest_facing({0, 0, 1}, {0, 0, 1}, 1);
  CHECK(*lens().touched.thickness(middle[0]) == doctest::Approx(0.12).epsilon(0.02));
  const Surface flat(test::square(2), -1);  // it has no other side
  CHECK_FALSE(flat.touched.thickness(0));
}

TEST_CASE("every site has as many distinct touchable contacts as asked for, spheres at most") {
  for (const Surface* surface : {&ball(), &lens()}) {
    for (const auto& site : sites_of(*surface)) {
      const std::set<std::size_t> distinct(site.rows.begin(), site.rows.end());
      CHECK(distinct.size() == site.rows.size());
      CHECK((site.rows.size() == site.contacts || (site.sphere && site.rows.size() < site.contacts)));
      CHECK(site.group.size() == site.rows.size());
      CHECK(site.displacement.rows() == static_cast<Eigen::Index>(3 * site.rows.size()));
      CHECK(site.displacement.cols() == static_cast<Eigen::Index>(site.kinds.size()));
      CHECK(site.displacement.colwise().norm().minCoeff() > 0);
      for (const std::size_t row : site.rows) {
        CHECK((surface->flags[surface->wavelet.nodes()[row]] & layout::node_touchable) != 0);
      }
    }
  }
}

TEST_CASE("sites are spread: the far ends of the surface have patches, and every kind and number is there") {
  double right = -1, down = 1;
  for (const auto& site : sites_of(lens())) {
    if (site.contacts != 1) continue;
    right = std::max(right, lens().position(site.rows[0]).x());
    down = std::min(down, lens().position(site.rows[0]).y());
  }
  CHECK(right > 0.8);
  CHECK(down < -0.8);
  std::set<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const auto& site : sites_of(lens())) {
    for (const PatternKind kind : site.kinds) found.insert({static_cast<std::uint32_t>(kind), site.contacts});
  }
  for (std::uint32_t kind = 1; kind <= layout::pattern_kinds; ++kind) {
    for (const std::uint32_t contacts : {1U, 4U, 16U, 64U}) {
      CAPTURE(pattern_name(kind));
      CAPTURE(contacts);
      const bool node = static_cast<PatternKind>(kind) == PatternKind::node;
      const bool expected = contacts == 1 ? layout::least_contacts(static_cast<PatternKind>(kind)) == 1 : !node;
      CHECK(found.contains({kind, contacts}) == expected);
    }
  }
}

TEST_CASE("nodes and patches: the nearest ones, moved as a whole along x, y and z") {
  Eigen::Vector3d axes = Eigen::Vector3d::Zero();
  for (const PatternKind kind : {PatternKind::node, PatternKind::patch}) {
    visit(ball(), kind, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
      CHECK((moved.colwise() - moved.col(0)).norm() == 0);
      axes += moved.col(0).normalized();
      const Eigen::Matrix3Xd at = positions_of(ball(), site);
      const double radius = (at.colwise() - at.col(0)).colwise().norm().maxCoeff();
      std::size_t nearer = 0;
      for (const auto& x : ball().touched.positions()) nearer += (x - at.col(0)).norm() < radius - 1e-12 ? 1 : 0;
      CHECK(nearer < site.contacts);
    });
  }
  CHECK(axes.x() == axes.y());
  CHECK(axes.x() == axes.z());
  CHECK(axes.x() >= 4 * 4);
}

TEST_CASE("turned: a rotation by 5 degrees about the middle, about the normal and about a tangent") {
  std::size_t about_normal = 0;
  const std::size_t samples = visit(ball(), PatternKind::turned, [&](const auto& site, const Eigen::Matrix3Xd& moved) {
    const Eigen::Matrix3Xd at = positions_of(ball(), site);
    const Eigen::Vector3d middle = at.rowwise().mean();
    CHECK(moved.rowwise().sum().norm() < 1e-12);
    const Eigen::Matrix3Xd before = at.colwise() - middle, after = before + moved;
    CHECK((after.colwise().norm() - before.colwise().norm()).cwiseAbs().maxCoeff() < 1e-12);
    const double longest = (moved.colwise().norm().array() / before.colwise().norm().array()).maxCoeff();
    CHECK(longest <= 2 * std::sin(2.5 * std::numbers::pi / 180) + 1e-12);
    CHECK(longest > 0.05);
    const Eigen::Vector3d normal = middle.normalized();  // of a ball
    about_normal += (normal.transpose() * moved).norm() < 0.1 * moved.norm() ? 1 : 0;
  });
  CHECK(2 * about_normal == samples);
}

TEST_CASE("gathered: 5 % of the tangential offsets, towards the middle") {
  CHECK(visit(ball(), PatternKind::gathered, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
          const Eigen::Matrix3Xd at = positions_of(ball(), site);
          const Eigen::Vector3d middle = at.rowwise().mean(), normal = middle.normalized();
          const Eigen::Matrix3Xd offset = at.colwise() - middle;
          const Eigen::Matrix3Xd tangential = offset - normal * (normal.transpose() * offset);
          CHECK((moved + 0.05 * tangential).norm() < 0.1 * moved.norm());
        }) > 10);
}

TEST_CASE("sphere: every contact is put onto it, from the side it comes from; the place itself goes in deepest") {
  CHECK(visit(ball(), PatternKind::sphere, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
          REQUIRE(site.sphere);
          const Eigen::Matrix3Xd at = positions_of(ball(), site);
          CHECK(site.sphere->centre.norm() > 1);
          const Eigen::VectorXd distance = ((at + moved).colwise() - site.sphere->centre).colwise().norm();
          CHECK((distance.array() - site.sphere->radius).abs().maxCoeff() < 1e-12);
          CHECK(at.col(0).dot(moved.col(0)) < 0);
          const Eigen::VectorXd before = (at.colwise() - site.sphere->centre).colwise().norm();
          CHECK(before[0] == before.minCoeff());
          CHECK(site.sphere->radius - before[0] == doctest::Approx(site.sphere->radius / 8));
        }) > 10);
}

TEST_CASE("pinch: two fingers of equal size on opposite sides, pressed towards each other") {
  CHECK(visit(lens(), PatternKind::pinch, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
          const Eigen::Matrix3Xd at = positions_of(lens(), site);
          for (std::size_t i = 0; i < site.rows.size(); ++i) {
            const auto k = static_cast<Eigen::Index>(i);
            CHECK(site.group[i] == (2 * i < site.rows.size() ? 0 : 1));
            CHECK(at.col(k).z() * moved.col(k).z() <= 0);
            if (std::abs(at.col(k).z()) > 1e-9) CHECK(at.col(k).z() * moved.col(k).z() < 0);
          }
          CHECK(moved.rowwise().sum().norm() < 1e-12);
        }) > 6);
}

TEST_CASE("pinch: the thin end of a body rather than the thick one") {
  auto mesh = test::octasphere(4);
  for (auto& x : mesh.positions) x.z() *= x.x() > -0.5 ? 0.05 : 1.0;
  const Surface surface(std::move(mesh), -2);
  std::size_t pinches = 0;
  for (const auto& site : contact_patterns(surface.touched, 16, 6)) {
    if (site.kinds[0] != PatternKind::pinch || site.contacts != 4) continue;
    ++pinches;
    CHECK(surface.position(site.rows[0]).x() > -0.55);
  }
  CHECK(pinches >= 3);
}

TEST_CASE("opposed: two patches half a body apart, moved oppositely") {
  CHECK(visit(ball(), PatternKind::opposed, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
          const Eigen::Matrix3Xd at = positions_of(ball(), site);
          const Eigen::Index half = at.cols() / 2;
          CHECK((at.leftCols(half).rowwise().mean() - at.rightCols(half).rowwise().mean()).norm() > 1);
          CHECK((moved.leftCols(half) + moved.rightCols(half)).norm() == 0);
        }) > 6);
}

TEST_CASE("alternating: along the normal, against the nearest of those before") {
  CHECK(visit(ball(), PatternKind::alternating, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
          const Eigen::Matrix3Xd at = positions_of(ball(), site);
          const Eigen::VectorXd along = at.cwiseProduct(moved).colwise().sum();
          for (Eigen::Index k = 1; k < at.cols(); ++k) {
            CHECK(std::abs(along[k]) > 0.99 * moved.col(k).norm());
            Eigen::Index nearest = 0;
            (at.leftCols(k).colwise() - at.col(k)).colwise().norm().minCoeff(&nearest);
            CHECK(along[k] * along[nearest] < 0);
          }
        }) > 6);
}

TEST_CASE("random: the numbers of SplitMix64, the same on every machine") {
  const double expected[] = {0.8469951410923235, 0.6598708840229508, -0.1078791261417662};
  bool found = false;
  visit(ball(), PatternKind::random, [&](const ContactSite& site, const Eigen::Matrix3Xd& moved) {
    if (site.contacts != 4 || found) return;
    found = true;
    for (Eigen::Index k = 1; k < 3; ++k) {
      CHECK(moved(k, 0) / moved(0, 0) == doctest::Approx(expected[k] / expected[0]));
    }
  });
  CHECK(found);
}

}  // namespace
}  // namespace greenloop::offline
