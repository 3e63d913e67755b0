// Runs the C++ example of docs/surface.md along a line through the model named on the command line; prints what it
// touches.
#include <cstdio>
#include <runtime/surface.hpp>

#include "read_model.hpp"

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
  const auto opened = greenloop::Model::open(read_model(argv[1]));
  if (!opened) return 65;
  const int status = follow_tip(opened.model, sense, touch);
  return status == 0 && steps == 101 ? 0 : 1;
}
