#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::bench {

/// `sets` contact sets of `contacts` nodes each: a touchable node drawn at random and its nearest touchable
/// neighbours, pressed as a whole by a thousandth of the body's diagonal. At most as many contacts as there are
/// touchable nodes. The same seed gives the same sets on every machine.
[[nodiscard]] std::vector<std::vector<Constraint>> patch_contacts(const ModelView& model, std::size_t sets,
                                                                  std::size_t contacts, std::uint64_t seed);

}  // namespace greenloop::bench
