/* Runs the C example of docs/impulses.md on the model named on the command line, as impulses.cpp does that of C++;
 * prints where the last vertex is. */
#include <runtime/greenloop_impulse.h>
#include <stdio.h>
#include <stdlib.h>

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
  FILE* stream = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (stream == NULL || fseek(stream, 0, SEEK_END) != 0) return 64;
  const size_t size = (size_t)ftell(stream); /* a multiple of 64, as aligned_alloc asks */
  void* const file = aligned_alloc(GREENLOOP_ALIGNMENT, size);
  rewind(stream);
  if (file == NULL || fread(file, 1, size, stream) != size) return 66;
  fclose(stream);
  if (greenloop_open(file, size, &model).rule != GREENLOOP_RULE_OK) return 65;
  const int status = c_show(&model, sense, draw);
  free(file);
  return status == 0 && steps == all + 1 ? 0 : 1;
}
