#include "runtime/algebra/fnv1a.hpp"

#include <doctest/doctest.h>

#include <span>
#include <string_view>

namespace greenloop {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

TEST_CASE("the digest is FNV-1a") {
  Fnv1a hash;
  CHECK(hash.value() == 0xcbf29ce484222325);
  hash.add(bytes_of("foobar"));
  CHECK(hash.value() == 0x85944171f73967e8);
}

TEST_CASE("a digest goes on from a value that it had") {
  Fnv1a begun;
  begun.add(bytes_of("foo"));
  Fnv1a rest(begun.value());
  rest.add(bytes_of("bar"));
  CHECK(rest.value() == 0x85944171f73967e8);
}

TEST_CASE("words are hashed as a whole") {
  Fnv1a of_byte, of_word, of_float, of_bits;
  of_byte.add(bytes_of("a"));
  of_word.add_word('a');
  CHECK(of_word.value() == of_byte.value());
  const float values[] = {-0.0F};
  of_float.add_words(values);
  of_bits.add_word(0x80000000);
  CHECK(of_float.value() == of_bits.value());
  CHECK(of_float.value() != Fnv1a{}.value());
}

}  // namespace
}  // namespace greenloop
