// Runs the README's C++ example for a few cycles on the model named on the command line and prints every force.
#include <bit>
#include <cmath>
#include <cstdio>
#include <runtime/elastostatic.hpp>
#include <span>

#include "read_model.hpp"

int control_loop(std::span<const std::byte> file, bool (*sense)(greenloop::Constraint&),
                 void (*actuate)(const greenloop::Vec3&));

namespace {

int cycles = 0;
double total_force = 0;
std::uint32_t touched_node = 0;

// NaN and infinity come between, and have to be refused; of bits, because this file is compiled with any flags
bool sense(greenloop::Constraint& contact) {
  contact = {touched_node, {0.0F, 0.0F, 1e-6F * static_cast<float>(cycles)}};
  if (cycles == 50) contact.value[2] = std::bit_cast<float>(0x7fc00000);
  if (cycles == 51) contact.value[2] = std::bit_cast<float>(0x7f800000);
  return cycles++ < 102;
}

void actuate(const greenloop::Vec3& force) {
  std::printf("%a %a %a\n", double{force.x}, double{force.y}, double{force.z});
  total_force += std::hypot(force.x, force.y, force.z);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    return 64;
  }
  const auto file = read_model(argv[1]);
  const auto opened = greenloop::Model::open(file);
  if (!opened) {
    return 65;
  }
  const auto& finest = opened.model.view().level[opened.model.level_count() - 1];
  touched_node = finest.node_begin + finest.counts->node_count - 1;
  while ((finest.nodes[touched_node - finest.node_begin].flags & greenloop::layout::node_touchable) == 0) {
    --touched_node;
  }
  const int status = control_loop(file, sense, actuate);
  std::fprintf(stderr, "status %d after %d cycles, total force %g N\n", status, cycles, total_force);
  return status == 0 && cycles == 103 && total_force > 0 ? 0 : 1;
}
