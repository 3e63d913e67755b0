// Runs the C++ example of docs/surface.md along a line through the model named on the command line; prints what it
// touches.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <runtime/surface.hpp>
#include <vector>

int follow_tip(const greenloop::Model& model, bool (*sense)(greenloop::Vec3&), void (*touch)(std::uint32_t, double));

namespace {

int steps = 0;

bool sense(greenloop::Vec3& tip) {
  tip = {0.002F * static_cast<float>(steps - 50), 0.001F, 0.001F * static_cast<float>(steps - 50)};
  return steps++ < 100;
}

void touch(std::uint32_t node, double squared_distance) { std::printf("%u %a\n", node, squared_distance); }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  std::ifstream stream(argv[1], std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  auto* const file = static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64));
  std::memcpy(file, bytes.data(), bytes.size());
  const auto opened = greenloop::Model::open({file, bytes.size()});
  if (!opened) return 65;
  const int status = follow_tip(opened.model, sense, touch);
  std::free(file);
  return status == 0 && steps == 101 ? 0 : 1;
}
