#include "offline/report/png_image.hpp"

#include <doctest/doctest.h>
#include <png.h>

#include <stdexcept>
#include <string_view>

namespace greenloop::offline {

TEST_CASE("a PNG decodes to the pixels it was made of") {
  Image image(5, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      image.at(x, y) = {static_cast<std::uint8_t>(50 * x), static_cast<std::uint8_t>(80 * y), 7,
                        static_cast<std::uint8_t>(255 - 10 * x)};
    }
  }
  const auto bytes = encode_png(image);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) != 0);
  CHECK(png.width == 5);
  CHECK(png.height == 3);
  png.format = PNG_FORMAT_RGBA;
  Image decoded(5, 3);
  REQUIRE(png_image_finish_read(&png, nullptr, decoded.pixels.data(), 0, nullptr) != 0);
  CHECK(decoded.pixels == image.pixels);
}

TEST_CASE("an empty picture is refused") { CHECK_THROWS_AS((void)encode_png(Image{}), std::runtime_error); }

TEST_CASE("base64 pads as RFC 4648 section 10 shows") {
  const auto encoded = [](std::string_view text) { return base64(std::as_bytes(std::span(text))); };
  CHECK(encoded("").empty());
  CHECK(encoded("f") == "Zg==");
  CHECK(encoded("fo") == "Zm8=");
  CHECK(encoded("foo") == "Zm9v");
  CHECK(encoded("foobar") == "Zm9vYmFy");
}

}  // namespace greenloop::offline
