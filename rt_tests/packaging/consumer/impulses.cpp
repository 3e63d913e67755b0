// Runs the C++ example of docs/impulses.md on the model named on the command line: a push now and then. Prints where
// the last vertex is.
#include <cstdio>
#include <runtime/impulse_response.hpp>

#include "read_model.hpp"

int show(const greenloop::Model& model, bool (*sense)(std::uint32_t&), void (*draw)(std::span<const greenloop::Vec3>));

namespace {

constexpr int all = 200, steps_per_impulse = 50;
int steps = 0;
bool moved = false;

bool sense(std::uint32_t& impulse) {
  const bool pushed = steps % steps_per_impulse == 0;
  impulse = pushed ? static_cast<std::uint32_t>(steps / steps_per_impulse % 2) : greenloop::ImpulseResponse::no_impulse;
  return steps++ < all;
}

void draw(std::span<const greenloop::Vec3> vertices) {
  const greenloop::Vec3& u = vertices.back();
  moved = moved || u.x != 0;
  std::printf("%a %a %a\n", static_cast<double>(u.x), static_cast<double>(u.y), static_cast<double>(u.z));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const auto opened = greenloop::Model::open(read_model(argv[1]));
  if (!opened) return 65;
  const int status = show(opened.model, sense, draw);
  return status == 0 && steps == all + 1 && moved ? 0 : 1;
}
