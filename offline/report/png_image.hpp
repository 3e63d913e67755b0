#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace greenloop::offline {

/// One sRGB pixel with straight (not premultiplied) alpha.
struct Pixel {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  std::uint8_t alpha = 0;
  bool operator==(const Pixel&) const = default;
};

/// Rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Pixel> pixels;  ///< width * height

  Image() = default;
  Image(int width_, int height_)
      : width(width_), height(height_), pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}
  Pixel& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  [[nodiscard]] const Pixel& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// The image as a PNG file (RGBA, 8 bits, the same bytes for the same image). Throws std::runtime_error if it is empty.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image);

/// Base64 (RFC 4648 §4) with padding.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// "data:image/png;base64,...": the image inside a page.
[[nodiscard]] std::string png_data_uri(const Image& image);

}  // namespace greenloop::offline
