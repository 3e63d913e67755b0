/* Runs the C example of docs/surface.md along a line through the model named on the command line; prints what it
 * touches. */
#include "read_model.h"

int c_follow_tip(const greenloop_model* model, int (*sense)(float*), void (*touch)(uint32_t, double));

static int steps = 0;

static int sense(float* tip) {
  tip[0] = 0.002F * (float)(steps - 50);
  tip[1] = 0.001F;
  tip[2] = 0.001F * (float)(steps - 50);
  return steps++ < 100;
}

static void touch(uint32_t node, double squared_distance) { printf("%u %a\n", (unsigned)node, squared_distance); }

int main(int argc, char** argv) {
  static greenloop_model model;
  if (argc != 2) return 64;
  size_t size = 0;
  void* const file = read_model(argv[1], &size);
  if (greenloop_open(file, size, &model).rule != GREENLOOP_RULE_OK) return 65;
  const int status = c_follow_tip(&model, sense, touch);
  free(file);
  return status == 0 && steps == 101 ? 0 : 1;
}
