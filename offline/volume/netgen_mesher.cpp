#include "offline/volume/netgen_mesher.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

// The library's symbols live in this namespace, its header does not say so.
namespace nglib {
#include <netgen/nglib.h>
}

namespace greenloop::offline {
namespace {

/// Netgen reports to std::cout and std::cerr at length.
class MutedStreams {
 public:
  MutedStreams() : cout_(std::cout.rdbuf(nullptr)), cerr_(std::cerr.rdbuf(nullptr)) {}
  ~MutedStreams() {
    std::cout.rdbuf(cout_);
    std::cerr.rdbuf(cerr_);
    std::cout.clear();
    std::cerr.clear();
  }
  MutedStreams(const MutedStreams&) = delete;
  MutedStreams& operator=(const MutedStreams&) = delete;

 private:
  std::streambuf* cout_;
  std::streambuf* cerr_;
};

struct Session {
  Session() { nglib::Ng_Init(); }
  ~Session() { nglib::Ng_Exit(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

struct MeshDeleter {
  void operator()(nglib::Ng_Mesh* mesh) const { nglib::Ng_DeleteMesh(mesh); }
};
using MeshHandle = std::unique_ptr<nglib::Ng_Mesh, MeshDeleter>;

/// Coordinates centred, turned and of order one, as Netgen's absolute tolerances want them.
struct Frame {
  Eigen::Vector3d centre;
  Eigen::Matrix3d rotation;
  double scale;

  Frame(const TriangleMesh& surface, double turn)
      : rotation(Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 3).normalized())) {
    Eigen::AlignedBox3d box;
    for (const auto& x : surface.vertices) box.extend(x);
    centre = box.center();
    scale = std::exp2(2 - std::ilogb(box.diagonal().norm()));
  }
  [[nodiscard]] Eigen::Vector3d in(const Eigen::Vector3d& x) const { return rotation * (x - centre) * scale; }
  [[nodiscard]] Eigen::Vector3d out(const Eigen::Vector3d& x) const {
    return rotation.transpose() * x / scale + centre;
  }
};

double mean_edge_length(const TriangleMesh& surface) {
  double sum = 0.0;
  for (const auto& [a, b, c] : surface.triangles) {
    sum += (surface.vertices[a] - surface.vertices[b]).norm() + (surface.vertices[b] - surface.vertices[c]).norm() +
           (surface.vertices[c] - surface.vertices[a]).norm();
  }
  return sum / (3.0 * static_cast<double>(surface.triangles.size()));
}

void add_triangle(nglib::Ng_Mesh* mesh, const std::array<int, 3>& triangle, int first) {
  std::array<int, 3> one_based = {triangle[0] + first + 1, triangle[1] + first + 1, triangle[2] + first + 1};
  nglib::Ng_AddSurfaceElement(mesh, nglib::NG_TRIG, one_based.data());
}

/// A regular tetrahedron beside the body. Netgen bounds the size of interior elements by the longest edge of all its
/// input, whatever maxh says; this edge sets the bound, and its own elements are dropped afterwards.
TriangleMesh size_decoy(const TriangleMesh& body, double edge) {
  Eigen::AlignedBox3d box;
  for (const auto& x : body.vertices) box.extend(x);
  const double half = edge / std::sqrt(8.0);
  const Eigen::Vector3d centre(box.max().x() + 2.0 * edge, 0.0, 0.0);
  TriangleMesh decoy;
  decoy.vertices = {centre + half * Eigen::Vector3d(1, 1, 1), centre + half * Eigen::Vector3d(1, -1, -1),
                    centre + half * Eigen::Vector3d(-1, 1, -1), centre + half * Eigen::Vector3d(-1, -1, 1)};
  decoy.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return decoy;
}

void add_surface(nglib::Ng_Mesh* mesh, const TriangleMesh& surface, int first) {
  for (auto x : surface.vertices) nglib::Ng_AddPoint(mesh, x.data());
  for (const auto& triangle : surface.triangles) add_triangle(mesh, triangle, first);
}

void generate(nglib::Ng_Mesh* mesh, const TetrahedralizeOptions& options, double size) {
  nglib::Ng_Meshing_Parameters parameters;
  parameters.maxh = size;
  parameters.grading = options.grading;
  parameters.optvolmeshenable = options.optimization_steps > 0 ? 1 : 0;
  parameters.optsteps_3d = options.optimization_steps;
  parameters.check_overlap = 0;
  parameters.check_overlapping_boundary = 0;
  nglib::Ng_Result result = nglib::NG_ERROR;
  try {
    result = nglib::Ng_GenerateVolumeMesh(mesh, &parameters);
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("Netgen: ") + error.what());
  } catch (...) {
    throw std::runtime_error("Netgen stopped with an unknown error");
  }
  if (result != nglib::NG_OK) throw std::runtime_error("Netgen failed with code " + std::to_string(result));
}

/// Everything but the decoy: surface vertices as given, then Netgen's interior ones.
TetrahedralMesh collect(nglib::Ng_Mesh* mesh, const TriangleMesh& surface, const Frame& frame) {
  const int kept = static_cast<int>(surface.vertices.size());
  constexpr int kDecoyVertices = 4;
  const int points = nglib::Ng_GetNP(mesh);
  double decoy_min_x = 0.0;
  TetrahedralMesh volume;
  volume.vertices = surface.vertices;
  std::vector<int> number(points, -1);
  std::array<double, 3> x{};
  for (int p = 0; p < points; ++p) {
    nglib::Ng_GetPoint(mesh, p + 1, x.data());
    if (p < kept) {
      number[p] = p;
    } else if (p < kept + kDecoyVertices) {
      decoy_min_x = p == kept ? x[0] : std::min(decoy_min_x, x[0]);
    } else if (x[0] < decoy_min_x) {
      number[p] = static_cast<int>(volume.vertices.size());
      volume.vertices.push_back(frame.out({x[0], x[1], x[2]}));
    }
  }
  for (int e = 1; e <= nglib::Ng_GetNE(mesh); ++e) {
    std::array<int, NG_VOLUME_ELEMENT_MAXPOINTS> p{};
    if (nglib::Ng_GetVolumeElement(mesh, e, p.data()) != nglib::NG_TET) {
      throw std::runtime_error("Netgen made an element that is not a tetrahedron");
    }
    // Netgen's orientation is the opposite of ours
    const std::array<int, 4> t = {number[p[0] - 1], number[p[2] - 1], number[p[1] - 1], number[p[3] - 1]};
    if (*std::min_element(t.begin(), t.end()) >= 0) volume.tetrahedra.push_back(t);
  }
  return volume;
}

}  // namespace

TetrahedralMesh mesh_with_netgen(const TriangleMesh& surface, const TetrahedralizeOptions& options, double turn) {
  const Frame frame(surface, turn);
  TriangleMesh framed = surface;
  for (auto& x : framed.vertices) x = frame.in(x);
  const double size = options.interior_growth * mean_edge_length(framed);

  const MutedStreams muted;
  const Session session;
  const MeshHandle mesh(nglib::Ng_NewMesh());
  add_surface(mesh.get(), framed, 0);
  add_surface(mesh.get(), size_decoy(framed, size), static_cast<int>(surface.vertices.size()));
  generate(mesh.get(), options, size);
  return collect(mesh.get(), surface, frame);
}

}  // namespace greenloop::offline
