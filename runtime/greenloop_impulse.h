/* Motions of a scene that was simulated, in C99: what runtime/impulse_response.hpp (docs/impulses.md) gives, the same
 * bits. Memory and threads: as greenloop.h says. */
#ifndef GREENLOOP_IMPULSE_H
#define GREENLOOP_IMPULSE_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include "runtime/greenloop.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GREENLOOP_NO_IMPULSE UINT32_C(0xffffffff)

#define GREENLOOP_LIGHT_COEFFICIENTS 16

/* Light from far around: runtime/light.hpp. */
typedef struct greenloop_light {
  float red[GREENLOOP_LIGHT_COEFFICIENTS], green[GREENLOOP_LIGHT_COEFFICIENTS], blue[GREENLOOP_LIGHT_COEFFICIENTS];
} greenloop_light;

/* The harmonics of a direction of unit length, GREENLOOP_LIGHT_COEFFICIENTS floats. For the loop. */
void greenloop_light_harmonics(const float direction[3], float* harmonics);

/* The light turned by a rotation, row by row. For the loop. */
greenloop_light greenloop_light_rotated(const greenloop_light* light, const float rotation[9]);

/* A body of greenloop_impulse_response_create; it lives in the caller's arena. */
typedef struct greenloop_impulse_response greenloop_impulse_response;

/* Zero: as the model has it. */
typedef struct greenloop_impulse_response_limits {
  float rate;       /* Hz, steps per second */
  float stretch;    /* 1/64..64, model seconds per second of the loop; 0: 1 */
  float blend_rate; /* 1/s, how fast differences die out */
} greenloop_impulse_response_limits;

typedef struct greenloop_impulse_response_requirement {
  size_t bytes;              /* of the arena, GREENLOOP_ALIGNMENT-aligned; 0: refused for another reason */
  uint64_t least_work;       /* units of a step without displacements: the smallest budget */
  uint64_t least_frame_work; /* with the displacement of all vertices by the fewest modes */
  uint64_t frame_work;       /* by all modes */
  uint64_t colour_work;      /* of the colours of all vertices by all modes; 0: the model has none */
  uint64_t worst_work;       /* of a frame with velocities and colours too */
} greenloop_impulse_response_requirement;

typedef struct greenloop_impulse_response_created {
  greenloop_create_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_impulse_response* body;     /* null on an error */
} greenloop_impulse_response_created;

/* What a step writes; null: not wanted. */
typedef struct greenloop_impulse_response_buffers {
  float* coordinate;        /* modes floats [m] */
  float* velocity;          /* modes floats [m/s] */
  float* displacement;      /* 3 * vertices floats [m], from the model's shape */
  float* displacement_rate; /* 3 * vertices floats [m/s] */
  const uint32_t* chosen;   /* vertices numbers; null: the first ones */
  uint32_t modes;           /* of the first two: greenloop_impulse_response_modes */
  uint32_t vertices;        /* of the others */
  float* colour;            /* 3 * vertices floats: radiance that leaves them, red, green, blue, in the light's unit */
  const greenloop_light* light; /* for colour */
} greenloop_impulse_response_buffers;

typedef struct greenloop_impulse_response_report {
  greenloop_status status;
  uint64_t work;           /* units spent */
  uint32_t orbit, row;     /* that are played; orbit 0: at rest */
  uint32_t impulse;        /* that began it, or GREENLOOP_NO_IMPULSE */
  uint32_t modes, planes;  /* in displacements */
  float truncation_error;  /* of these, relative */
  float distance;          /* m, between the states where this step went over to another orbit; 0: it did not */
  float blend;             /* m, what is left of such differences */
  int at_rest;             /* 1: the orbit has come to its end */
  uint32_t transfer_modes; /* in colours, beside the mean */
  float transfer_error;    /* of transfers by so many, relative to their variation */
} greenloop_impulse_response_report;

/* Modes, vertices and impulses of a model; 0 of one of another problem. */
uint32_t greenloop_impulse_response_modes(const greenloop_model* model);
uint32_t greenloop_impulse_response_vertices(const greenloop_model* model);
uint32_t greenloop_impulse_response_impulses(const greenloop_model* model);

/* Start-up. */
greenloop_impulse_response_requirement greenloop_impulse_response_required(const greenloop_model* model,
                                                                           greenloop_impulse_response_limits limits);

/* Start-up. */
greenloop_impulse_response_created greenloop_impulse_response_create(const greenloop_model* model,
                                                                     greenloop_impulse_response_limits limits,
                                                                     void* memory, size_t bytes);

/* 1: the impulse may follow the last one. For the loop. */
int greenloop_impulse_response_may_follow(const greenloop_impulse_response* body, uint32_t impulse);

/* One cycle: an impulse of the palette, or GREENLOOP_NO_IMPULSE, then a period passes. For the loop. */
greenloop_impulse_response_report greenloop_impulse_response_step(greenloop_impulse_response* body, uint32_t impulse,
                                                                  uint64_t work,
                                                                  greenloop_impulse_response_buffers buffers);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
