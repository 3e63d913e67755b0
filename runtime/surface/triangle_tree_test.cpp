#include "runtime/surface/triangle_tree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/test_files.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

// a tree over triangles of its own
class Built {
 public:
  explicit Built(const TriangleMesh& mesh) {
    for (const Eigen::Vector3d& x : mesh.vertices) {
      nodes.push_back(
          {{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])}, 0, layout::node_domain});
    }
    for (const auto& [a, b, c] : mesh.triangles) {
      triangles.push_back(
          {{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)}});
    }
    const auto count = static_cast<std::uint32_t>(triangles.size());
    Arena counting;
    tree.carve(counting, count);
    memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory_.data());
    tree.carve(arena, count);
    tree.build(nodes.data(), triangles.data());
  }

  // squared distance of one corner from a position
  [[nodiscard]] double distance(std::uint32_t triangle, const Double3& from) const {
    const float* x = nodes[triangles[triangle].node[0]].position;
    const Double3 offset = Double3{x[0], x[1], x[2]} - from;
    return dot(offset, offset);
  }

  std::vector<layout::NodeRecord> nodes;
  std::vector<Surface::Triangle> triangles;
  TriangleTree tree;

 private:
  AlignedBytes memory_;
};

TriangleMesh chain(int count) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const double x = i;
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST_CASE("triangle tree: without a shrinking reach every triangle is seen, once") {
  for (const int count : {1, 2, 3, 4, 5, 7, 8, 9, 31, 32, 33, 1000}) {
    const Built built(chain(count));
    std::vector<int> seen(static_cast<std::size_t>(count));
    built.tree.visit({3, 4, 5}, [&](std::uint32_t t, Reach&) { ++seen[t]; });
    CHECK(seen == std::vector<int>(static_cast<std::size_t>(count), 1));
  }
}

TEST_CASE("triangle tree: triangles that all coincide are told apart by their numbers") {
  TriangleMesh mesh = chain(1);
  mesh.triangles.resize(100, mesh.triangles[0]);
  const Built built(mesh);
  std::vector<int> seen(100);
  built.tree.visit({0.2, 0.2, 0}, [&](std::uint32_t t, Reach& reach) {
    ++seen[t];
    reach.shrink(0);
  });
  CHECK(seen == std::vector<int>(100, 1));
}

TEST_CASE("triangle tree: of real meshes the nearest is never missed, and few triangles are looked at") {
  for (const std::string name : {"bunny.obj", "meshes/bear_bis.off", "meshes/3torus.off"}) {
    CAPTURE(name);
    const Built built(read_surface(fetched(name)));
    const auto count = static_cast<std::uint32_t>(built.triangles.size());
    std::mt19937_64 random(8);
    std::normal_distribution<double> near(0, 1e-3);
    std::size_t looked_at = 0;
    for (int i = 0; i < 200; ++i) {
      const float* x = built.nodes[random() % built.nodes.size()].position;
      const Double3 from = Double3{x[0], x[1], x[2]} + Double3{near(random), near(random), near(random)};
      double expected = HUGE_VAL;
      for (std::uint32_t t = 0; t < count; ++t) expected = std::min(expected, built.distance(t, from));
      double found = HUGE_VAL;
      built.tree.visit(from, [&](std::uint32_t t, Reach& reach) {
        ++looked_at;
        found = std::min(found, built.distance(t, from));
        reach.shrink(found);
      });
      CHECK(found == expected);
    }
    CHECK(looked_at / 200 < 200);
  }
}

}  // namespace
}  // namespace greenloop
