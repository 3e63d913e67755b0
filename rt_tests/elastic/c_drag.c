/* Runs the C example of docs/multigrid.md on the model named on the command line: leads its first vertex for 5 mm and
 * prints the force at the end. */
#include <runtime/greenloop_multigrid.h>
#include <stdio.h>
#include <stdlib.h>

int c_drag(const greenloop_model* model, uint32_t vertex, int (*sense)(float displacement[3]),
           void (*feel)(const float force[3]));

enum { all = 500 };
static int sensed = 0, felt = 0;
static float last[3];

static int sense(float displacement[3]) {
  displacement[0] = 1e-5F * (float)sensed;
  displacement[1] = displacement[2] = 0;
  return sensed++ < all;
}

static void feel(const float force[3]) {
  for (int i = 0; i < 3; ++i) last[i] = force[i];
  ++felt;
}

int main(int argc, char** argv) {
  static greenloop_model model;
  FILE* const file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) return 64;
  const size_t size = (size_t)ftell(file);
  void* const bytes =
      aligned_alloc(GREENLOOP_ALIGNMENT, (size + GREENLOOP_ALIGNMENT) / GREENLOOP_ALIGNMENT * GREENLOOP_ALIGNMENT);
  rewind(file);
  if (bytes == NULL || fread(bytes, 1, size, file) != size) return 65;
  (void)fclose(file);
  if (greenloop_open(bytes, size, &model).rule != GREENLOOP_RULE_OK) return 66;
  const int status = c_drag(&model, 0, sense, feel);
  printf("%g %g %g\n", (double)last[0], (double)last[1], (double)last[2]);
  free(bytes);
  return status == 0 && felt == all && last[0] > 0 ? 0 : 1;
}
