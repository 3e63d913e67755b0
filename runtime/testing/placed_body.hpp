#pragma once

#include "formats/write/aligned_bytes.hpp"
#include "runtime/elastostatic/body.hpp"

namespace greenloop {

/// What a body keeps in its arena, in memory of its own.
class PlacedBody {
 public:
  explicit PlacedBody(const ModelView& view, std::uint32_t max_contacts = 1) {
    Elastostatic::Requirement requirement;
    measure_body(view, {.max_contacts = max_contacts, .cached_factors = 1}, sizes_, requirement);
    Arena counting;
    place_body(counting, view, sizes_);
    memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory_.data());
    body = place_body(arena, view, sizes_);
  }
  Body* body = nullptr;

 private:
  BodySizes sizes_;
  AlignedBytes memory_;
};

}  // namespace greenloop
