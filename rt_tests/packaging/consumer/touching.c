/* Runs the C example of docs/touching.md on the model named on the command line, as touching.cpp does that of C++;
 * prints what is felt. */
#include "read_model.h"

int c_press_and_drag(const greenloop_model* model, int (*sense)(double*),
                     void (*actuate)(const double*, const double*));

enum { pressed = 20, all = 60 };
static int steps = 0;

static int sense(double* position) {
  const int down = steps < pressed ? steps : pressed;
  position[0] = 2e-4 * (steps - down);
  position[1] = 0;
  position[2] = 0.131 - 2e-4 * down;
  return steps++ < all;
}

static void actuate(const double* force, const double* torque) {
  printf("%a %a %a %a %a %a\n", force[0], force[1], force[2], torque[0], torque[1], torque[2]);
}

int main(int argc, char** argv) {
  static greenloop_model model;
  if (argc != 2) return 64;
  size_t size = 0;
  void* const file = read_model(argv[1], &size);
  if (greenloop_open(file, size, &model).rule != GREENLOOP_RULE_OK) return 65;
  const int status = c_press_and_drag(&model, sense, actuate);
  free(file);
  return status == 0 && steps == all + 1 ? 0 : 1;
}
