#include "rt_tests/fuzz/byte_mutator.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string>

namespace greenloop {
namespace {

constexpr std::array<std::uint64_t, 14> telling_words{
    0, 1, 2, 0x7f, 0x80, 0xff, 0x10000, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000, ~0ULL, ~0ULL >> 1};

constexpr std::array telling_numbers{"0",    "-1",    "1e155", "1e-320", "1e16",  "nan",        "inf",
                                     "1e12", "1e308", "12",    "11",     "1e-12", "3000000",    "18446744073709551615",
                                     "",     " ",     "x",     "0.1",    "-0",    "4294967296", "9007199254740993"};

void mutate_once(Random& random, std::size_t head, Bytes& bytes) {
  const auto place = [&] { return below(random, below(random, 2) == 0 ? std::min(bytes.size(), head) : bytes.size()); };
  const std::size_t at = place(), width = std::size_t{1} << below(random, 4), word = std::min(at, bytes.size() - width);
  switch (below(random, 8)) {
    case 0:
    case 1:
      bytes[at] ^= std::byte{1} << below(random, 8);
      break;
    case 2:
      bytes[at] = static_cast<std::byte>(random());
      break;
    case 3:
    case 4:
    case 5:
      std::memcpy(bytes.data() + word, &one_of(random, telling_words), width);
      break;
    case 6:
      std::memmove(bytes.data() + word, bytes.data() + std::min(place(), bytes.size() - width), width);
      break;
    default:
      if (below(random, 8) == 0) bytes.resize(std::max<std::size_t>(8, at));
      break;
  }
}

// begin and end of the cell or line that place `at` is in
std::pair<std::size_t, std::size_t> part_at(const std::string& text, std::size_t at, const char* ends) {
  const std::size_t before = at == 0 ? std::string::npos : text.find_last_of(ends, at - 1);
  return {before == std::string::npos ? 0 : before + 1, std::min(text.find_first_of(ends, at), text.size())};
}

}  // namespace

void mutate_bytes(Random& random, std::size_t head, Bytes& bytes) {
  for (std::size_t change = 1 + below(random, 3); change > 0; --change) mutate_once(random, head, bytes);
}

void mutate_text(Random& random, std::string& text) {
  for (std::size_t change = 1 + below(random, 3); change > 0 && !text.empty(); --change) {
    const std::size_t at = below(random, text.size());
    const auto [cell, cell_end] = part_at(text, at, " ,:[]{}<>=\"\n");
    const auto [line, line_end] = part_at(text, at, "\n");
    switch (below(random, 6)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.insert(at, text, line, std::min<std::size_t>(line_end - line + 1, 4096));
        break;
      case 2:
        text.erase(line, line_end - line + below(random, 2));
        break;
      case 3:
        text.insert(at, 1 + below(random, 100), "[{\",\n0"[below(random, 6)]);
        break;
      default:
        text.replace(cell, cell_end - cell, one_of(random, telling_numbers));
        break;
    }
  }
}

}  // namespace greenloop
