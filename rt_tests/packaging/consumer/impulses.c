/* Runs the C example of docs/impulses.md on the model named on the command line, as impulses.cpp does that of C++;
 * prints where the last vertex is. */
#include <runtime/greenloop_impulse.h>

#include "read_model.h"

int c_show(const greenloop_model* model, int (*sense)(uint32_t*), void (*draw)(const float*, uint32_t));

enum { all = 200, steps_per_impulse = 50 };
static int steps = 0;

static int sense(uint32_t* impulse) {
  const int pushed = steps % steps_per_impulse == 0;
  *impulse = pushed ? (uint32_t)(steps / steps_per_impulse % 2) : GREENLOOP_NO_IMPULSE;
  return steps++ < all;
}

static void draw(const float* moved, uint32_t vertices) {
  const float* const u = moved + 3 * (size_t)(vertices - 1);
  printf("%a %a %a\n", (double)u[0], (double)u[1], (double)u[2]);
}

int main(int argc, char** argv) {
  static greenloop_model model;
  if (argc != 2) return 64;
  size_t size = 0;
  void* const file = read_model(argv[1], &size);
  if (greenloop_open(file, size, &model).rule != GREENLOOP_RULE_OK) return 65;
  const int status = c_show(&model, sense, draw);
  free(file);
  return status == 0 && steps == all + 1 ? 0 : 1;
}
