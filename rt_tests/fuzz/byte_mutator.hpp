#pragma once

#include <cstddef>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace greenloop {

using Bytes = std::vector<std::byte>;
using Random = std::mt19937_64;

/// A number below `limit`, which is positive.
[[nodiscard]] inline std::size_t below(Random& random, std::size_t limit) {
  return static_cast<std::size_t>(random() % limit);
}

/// One of `choices`, which is not empty.
template <class Choices>
[[nodiscard]] const auto& one_of(Random& random, const Choices& choices) {
  return choices[below(random, std::size(choices))];
}

/// Changes one to three places of at least 8 bytes: bits, words to telling numbers, parts copied over others, or the
/// end cut off. Half of the changes meet the first `head` bytes.
void mutate_bytes(Random& random, std::size_t head, Bytes& bytes);

/// The same of a text: numbers to telling ones, letters, and lines repeated or left out.
void mutate_text(Random& random, std::string& text);

}  // namespace greenloop
