#pragma once

#include "runtime/contact/deformed_surface.hpp"

namespace greenloop {

/// Where a straight way from one finite position to another (m) first enters a body: the first triangle that it crosses
/// from its outer side; none if it enters none. Triangles that the point `left` lies in, if there is one, are passed
/// over: the way begins there. Watertight: between triangles that share an edge or a corner no way leads through (Woop,
/// Benthin & Wald 2013), and a way that begins less than a few 1e-7 of the body's extent inside counts as beginning
/// outside. For the loop; work: what was looked at is added to `work`, at most cast_work(). Once `work` is above `most`
/// the search is cut, what it returns of no use; then `work` is above `most` by no more than patch_work.
[[nodiscard]] TrianglePoint cast(const DeformedSurface& surface, const Double3& from, const Double3& to,
                                 const TrianglePoint& left, std::uint64_t& work,
                                 std::uint64_t most = all_work) noexcept;

[[nodiscard]] std::uint64_t cast_work(const DeformedSurface& surface) noexcept;

}  // namespace greenloop
