#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/mesh/binary_scalar.hpp"
#include "formats/mesh/mesh_text.hpp"

namespace greenloop {

/// Numbers of a file one after the other, written as text or as bytes. Every reading function throws MeshFileError with
/// what was found and what was expected.
class NumberArray {
 public:
  /// Tokens of a text, which is read on.
  explicit NumberArray(MeshText& text) : text_(&text) {}
  /// Values of one type; `name` is of the array, for messages.
  NumberArray(std::filesystem::path file, std::string name, std::string_view bytes, Scalar type, std::endian order)
      : file_(std::move(file)), name_(std::move(name)), bytes_(bytes), type_(type), order_(order) {}

  /// A finite number.
  [[nodiscard]] double real(std::string_view expected);
  /// A whole number in [low, high].
  [[nodiscard]] std::int64_t integer(std::string_view expected, std::int64_t low, std::int64_t high);
  [[nodiscard]] Eigen::Vector3d point();
  /// True if another number follows; in a text, one before the next tag.
  [[nodiscard]] bool more();
  /// Line of the number read last, 0 in bytes.
  [[nodiscard]] std::size_t line() const { return text_ != nullptr ? text_->line_number() : 0; }

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;

 private:
  double next(std::string_view expected);

  MeshText* text_ = nullptr;
  std::filesystem::path file_;
  std::string name_;
  std::string_view bytes_;
  Scalar type_ = Scalar::f64;
  std::endian order_ = std::endian::little;
};

}  // namespace greenloop
