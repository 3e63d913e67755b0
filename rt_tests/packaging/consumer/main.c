/* Runs the C example of docs/loop.md for a few cycles on the model named on the command line and prints every force. */
#include <string.h>

#include "read_model.h"

int c_control_loop(const void* file, size_t size, int (*sense)(greenloop_constraint*), void (*actuate)(const float*));

static int cycles = 0;
static uint32_t touched_node = 0;
static double total_force = 0;

/* NaN and infinity come between, and have to be refused; of bits, because this file is compiled with any flags */
static int sense(greenloop_constraint* contact) {
  const greenloop_constraint pressed = {touched_node, {0.0F, 0.0F, 1e-6F * (float)cycles}, GREENLOOP_HOLD};
  const uint32_t nan = 0x7fc00000, infinity = 0x7f800000;
  *contact = pressed;
  if (cycles == 50) memcpy(&contact->value[2], &nan, sizeof nan);
  if (cycles == 51) memcpy(&contact->value[2], &infinity, sizeof infinity);
  return cycles++ < 102;
}

static double magnitude(float value) { return value < 0 ? -(double)value : (double)value; }

static void actuate(const float* force) {
  printf("%a %a %a\n", (double)force[0], (double)force[1], (double)force[2]);
  total_force += magnitude(force[0]) + magnitude(force[1]) + magnitude(force[2]);
}

int main(int argc, char** argv) {
  static greenloop_model model;
  size_t size = 0;
  int status;
  if (argc != 2) return 64;
  void* const file = read_model(argv[1], &size);
  const greenloop_fault fault = greenloop_open(file, size, &model);
  if (fault.rule != GREENLOOP_RULE_OK) {
    fprintf(stderr, "%s: %s\n", fault.field, greenloop_rule_text(fault.rule));
    return 65;
  }
  touched_node = greenloop_node_count(&model) - 1;
  while (!greenloop_is_touchable(&model, touched_node)) --touched_node;
  status = c_control_loop(file, size, sense, actuate);
  fprintf(stderr, "status %d after %d cycles, total force %g N\n", status, cycles, total_force);
  free(file);
  return status == 0 && cycles == 103 && total_force > 0 ? 0 : 1;
}
