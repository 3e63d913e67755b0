#pragma once

#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/simulate/sheet_elasticity.hpp"

namespace greenloop::offline {

/// m/s, at which what is nearer than the thickness is moved apart.
inline constexpr double parting_speed = 0.2;

/// Contacts of sheets with each other and with themselves: vertices stay `thickness` away from triangles, on the side
/// where they were.
class SheetContacts {
 public:
  /// Vertices that are nearer than 5/2 of the thickness to a triangle as sewn are no contact. Masses in kg, 0: held.
  SheetContacts(const TriangleMesh& sewn, double thickness, double friction, const std::vector<double>& masses);

  /// Finds vertices within 3/2 of the thickness of triangles. Work: linear where few are near.
  void find(const Places& places);

  /// Pushes pairs that were found apart; `before`: where all was at the beginning of the time step. Friction holds back
  /// what moved along.
  void relax(double time_step, const Places& before, Places& places) const;

 private:
  struct Pair {
    int vertex = 0, triangle = 0;
  };
  [[nodiscard]] bool meet_as_sewn(int vertex, const std::array<int, 3>& t) const;
  void relax(const Pair& pair, double parting, const Places& before, Places& places) const;

  TriangleMesh sewn_;
  double thickness_, friction_;
  std::vector<double> mobilities_;
  std::vector<Pair> pairs_;
  // vertices by cells of a grid, in a table of hashes
  std::vector<int> cell_begin_, cell_vertices_;
};

}  // namespace greenloop::offline
