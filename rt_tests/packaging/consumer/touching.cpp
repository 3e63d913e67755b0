// Runs the C++ example of docs/touching.md on the model named on the command line, a ball of 0.1 m: presses a sphere
// into it from above, then drags it. Prints what is felt and checks which way it points.
#include <cstdio>
#include <runtime/contact_body.hpp>

#include "read_model.hpp"

int press_and_drag(const greenloop::Model& model, bool (*sense)(greenloop::Pose&),
                   void (*actuate)(const greenloop::Double3&, const greenloop::Double3&));

namespace {

constexpr int pressed = 20, all = 60;
int steps = 0;
int wrong = 0;

bool sense(greenloop::Pose& pose) {
  const int down = steps < pressed ? steps : pressed;
  pose.position = {2e-4 * (steps - down), 0, 0.131 - 2e-4 * down};
  return steps++ < all;
}

void actuate(const greenloop::Double3& force, const greenloop::Double3& torque) {
  std::printf("%a %a %a %a %a %a\n", force.x, force.y, force.z, torque.x, torque.y, torque.z);
  const bool dragged = steps > pressed + 5;
  wrong += steps == pressed && !(force.z > 0) ? 1 : 0;
  wrong += dragged && !(force.z > 0 && force.x < -0.05 * force.z && torque.y > 0) ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  const auto opened = greenloop::Model::open(read_model(argv[1]));
  if (!opened) return 65;
  const int status = press_and_drag(opened.model, sense, actuate);
  if (wrong > 0) std::fprintf(stderr, "%d steps felt what they should not\n", wrong);
  return status == 0 && steps == all + 1 && wrong == 0 ? 0 : 1;
}
