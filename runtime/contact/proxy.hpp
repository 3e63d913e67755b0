#pragma once

#include "runtime/contact/deformed_surface.hpp"

namespace greenloop {

/// A point of a tool and where it touches a body: a *god object* (Zilles & Salisbury 1995), the *surface contact point*
/// of James & Pai 2003, section 6.4. Outside of the body it is the surface's point that is nearest to the tool's. Where
/// the tool's point enters, even if in the same step it leaves again on the other side, it is *held* on the side from
/// which the tool came, and slides there to the place that is nearest, until the tool's point is outside of it. It is
/// kept in the surface's own coordinates and so moves along with the body.
class Proxy {
 public:
  static constexpr std::uint32_t most_slides = 64;  ///< triangles that it crosses in one move, at most

  /// A step: the tool's point goes straight from where it was in the last one to `to` (m, finite), against the surface
  /// as it is now displaced. Without a last one, it is placed: if inside, it is held where the surface is nearest. A
  /// free one that is more than `margin` m beside the box around the surface has no point of the surface. For the loop;
  /// work: what was looked at is added to `work`, at most move_work(). If that does not suffice to stay below `most`,
  /// the step is left out: a held one stays where it is held, a free one has no height, and the next step goes on from
  /// where this one began, so that nothing is passed through. Then `work` is below `most` or rises by surround_work().
  void move(const DeformedSurface& surface, const Double3& to, double margin, std::uint64_t& work,
            std::uint64_t most = all_work) noexcept;
  [[nodiscard]] static std::uint64_t move_work(const DeformedSurface& surface) noexcept;

  /// How much below `most` queries end, for what follows them.
  [[nodiscard]] static std::uint64_t reserve(const SurfaceSizes& surface) noexcept {
    return DeformedSurface::patch_work + 5 * surface.surround_work();
  }

  /// The next move places it anew.
  void forget() noexcept { *this = {}; }

  /// Whether the tool's point is behind the surface.
  [[nodiscard]] bool is_held() const noexcept { return is_held_; }
  /// Whether the last move was left out, for there was too little work for it.
  [[nodiscard]] bool is_left_out() const noexcept { return is_left_out_; }
  /// On the surface; triangle none: it is far away.
  [[nodiscard]] const TrianglePoint& point() const noexcept { return point_; }
  // As of the last move, of use only if there is a point:
  [[nodiscard]] const Double3& position() const noexcept { return position_; }  ///< m, of the point of the surface
  /// Out of the body: between that and the tool's point, or of the surface there where these are not apart.
  [[nodiscard]] const Double3& normal() const noexcept { return normal_; }
  /// m, of the tool's point over the surface: negative if it is held.
  [[nodiscard]] double height() const noexcept { return height_; }

 private:
  static constexpr int most_landings = 3;  ///< in one move, of a way that leaves one fold of the surface for another

  /// What a move may do with the surface, and the work of that.
  struct Query {
    const DeformedSurface& surface;
    std::uint64_t& work;
    std::uint64_t most;  ///< above it queries are cut
    [[nodiscard]] bool is_cut() const noexcept { return work > most; }
  };

  /// Each: false if a query was cut, so that nothing is known.
  [[nodiscard]] bool go(const Query& query, const Double3& to, double margin) noexcept;
  [[nodiscard]] bool enter(const Query& query, const Double3& to) noexcept;
  [[nodiscard]] bool follow(const Query& query, const Double3& to) noexcept;
  [[nodiscard]] bool settle(const Query& query, const Double3& to, double margin) noexcept;

  [[nodiscard]] bool was_overtaken(const Query& query) noexcept;
  [[nodiscard]] bool slide(const Query& query, const Double3& to) noexcept;
  void measure(const DeformedSurface& surface, const Double3& to, std::uint64_t& work) noexcept;
  [[nodiscard]] double side(const DeformedSurface& surface, const Double3& of, std::uint64_t& work) const noexcept;

  bool is_placed_ = false, is_held_ = false;
  bool is_nearest_ = false;  ///< of the places around it
  bool is_left_out_ = false;
  Double3 last_;  ///< m, of the tool's point
  TrianglePoint point_;
  Double3 position_, normal_;
  double height_ = 0;
};

}  // namespace greenloop
