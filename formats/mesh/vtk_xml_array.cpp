#include "formats/mesh/vtk_xml_array.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/mesh/mesh_text.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t most_inflation = 1032;

int base64_digit(char c) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto at = digits.find(c);
  return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

/// Takes lengths and data from the front of an array's bytes.
class Bytes {
 public:
  Bytes(std::string_view bytes, const VtkEncoding& encoding, const std::string& place)
      : bytes_(bytes), encoding_(encoding), place_(place) {}

  std::uint64_t length() {
    const char* const at = take(size_of(encoding_.header)).data();
    return encoding_.header == Scalar::u64 ? decode_as<std::uint64_t>(at, encoding_.order)
                                           : decode_as<std::uint32_t>(at, encoding_.order);
  }

  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) {
      fail(std::to_string(bytes_.size()) + " bytes where " + std::to_string(count) + " are promised");
    }
    const auto taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

  [[nodiscard]] std::size_t left() const { return bytes_.size(); }

  [[noreturn]] void fail(const std::string& found) const {
    throw MeshFileError(place_ + ": found " + found + ", expected a whole array");
  }

 private:
  std::string_view bytes_;
  const VtkEncoding& encoding_;
  const std::string& place_;
};

/// "blocks, length of a block, length of the last if it is shorter, compressed length of each", then the blocks.
std::string inflate_blocks(Bytes bytes) {
  const auto blocks = bytes.length();
  const auto full = bytes.length();
  const auto last = bytes.length();
  if (blocks == 0) {
    return {};
  }
  if (blocks > bytes.left() || full > largest_mesh_file || last > full) {
    bytes.fail(std::to_string(blocks) + " blocks of " + std::to_string(full) + " bytes");
  }
  std::vector<std::uint64_t> lengths(blocks);
  std::generate(lengths.begin(), lengths.end(), [&] { return bytes.length(); });
  const auto total = (blocks - 1) * full + (last > 0 ? last : full);
  if (total > largest_mesh_file || total / most_inflation > bytes.left()) {
    bytes.fail(std::to_string(total) + " bytes packed into " + std::to_string(bytes.left()));
  }
  std::string result(total, '\0');
  std::uint64_t done = 0;
  for (const auto length : lengths) {
    const auto packed = bytes.take(length);
    const auto wanted = std::min(full, total - done);
    auto got = static_cast<uLongf>(wanted);
    const int status = uncompress(reinterpret_cast<Bytef*>(result.data() + done), &got,
                                  reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size()));
    if (status != Z_OK || got != wanted) {
      bytes.fail("a damaged compressed block");
    }
    done += wanted;
  }
  return result;
}

}  // namespace

std::string decode_base64(std::string_view text) {
  std::string result;
  result.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t group = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    const int digit = c == '=' ? 0 : base64_digit(c);
    if (is_space(c)) {
      continue;
    }
    if (digit < 0) {
      break;
    }
    group = group << 6 | static_cast<std::uint32_t>(digit);
    padding += c == '=' ? 1 : 0;
    if (++digits == 4) {
      for (int i = 0; i < 3 - std::min(padding, 2); ++i) {
        result += static_cast<char>(group >> (16 - 8 * i) & 0xff);
      }
      group = 0;
      digits = padding = 0;
    }
  }
  return result;
}

std::string unpack_array(std::string_view bytes, const VtkEncoding& encoding, const std::string& place) {
  Bytes all(bytes, encoding, place);
  if (encoding.compressed) {
    return inflate_blocks(all);
  }
  const auto length = all.length();
  return std::string(all.take(length));
}

}  // namespace greenloop
