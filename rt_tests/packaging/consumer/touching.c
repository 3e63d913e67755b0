/* Runs the C example of docs/touching.md on the model named on the command line, as touching.cpp does that of C++;
 * prints what is felt. */
#include <runtime/greenloop.h>
#include <stdio.h>
#include <stdlib.h>

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
  FILE* stream = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (stream == NULL || fseek(stream, 0, SEEK_END) != 0) return 64;
  const size_t size = (size_t)ftell(stream); /* a multiple of 64, as aligned_alloc asks */
  void* const file = aligned_alloc(GREENLOOP_ALIGNMENT, size);
  rewind(stream);
  if (file == NULL || fread(file, 1, size, stream) != size) return 66;
  fclose(stream);
  if (greenloop_open(file, size, &model).rule != GREENLOOP_RULE_OK) return 65;
  const int status = c_press_and_drag(&model, sense, actuate);
  free(file);
  return status == 0 && steps == all + 1 ? 0 : 1;
}
