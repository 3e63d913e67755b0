/* Elastic bodies that move, stepped by multigrid, in C99: what runtime/multigrid.hpp (docs/multigrid.md) gives, the
 * same bits. Memory and threads: as greenloop.h says. */
#ifndef GREENLOOP_MULTIGRID_H
#define GREENLOOP_MULTIGRID_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include "runtime/greenloop.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A body of greenloop_multigrid_create; it lives in the caller's arena. */
typedef struct greenloop_multigrid greenloop_multigrid;

typedef struct greenloop_multigrid_limits {
  uint32_t max_loads; /* 0..65536 */
  uint32_t max_holds; /* 0..65536 */
  float tolerance;    /* 1e-6..0.5, of the residual; 0: 1e-4 */
} greenloop_multigrid_limits;

typedef struct greenloop_multigrid_requirement {
  size_t bytes;         /* of the arena, GREENLOOP_ALIGNMENT-aligned; 0: refused for another reason */
  uint64_t least_work;  /* units of a step with all loads and holds and one cycle */
  uint64_t cycle_work;  /* of a cycle more */
  uint64_t shown_work;  /* of the displacements of all shown vertices */
  uint64_t stress_work; /* of the stress of all vertices */
} greenloop_multigrid_requirement;

typedef struct greenloop_multigrid_created {
  greenloop_create_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_multigrid* body;            /* null on an error */
} greenloop_multigrid_created;

/* A force on a vertex, N. */
typedef struct greenloop_multigrid_load {
  uint32_t vertex;
  float force[3];
} greenloop_multigrid_load;

/* A vertex that is held at a displacement, m, in this step. */
typedef struct greenloop_multigrid_hold {
  uint32_t vertex;
  float displacement[3];
} greenloop_multigrid_hold;

/* What acts in a step. */
typedef struct greenloop_multigrid_inputs {
  const greenloop_multigrid_load* loads;
  size_t load_count;
  const greenloop_multigrid_hold* holds;
  size_t hold_count;
  const float* gravity; /* 3 floats [m/s^2]; null: the model's */
} greenloop_multigrid_inputs;

/* What a step writes; null: not wanted. */
typedef struct greenloop_multigrid_buffers {
  float* displacement;    /* 3 * vertices floats [m] */
  const uint32_t* chosen; /* vertices numbers, of which the displacements are; null: all of the model */
  uint32_t vertices;      /* of displacement; all: greenloop_multigrid_vertices */
  float* reaction;        /* 3 * hold_count floats [N], with which each hold acts on the body */
  float* shown;           /* 3 * shown vertices floats [m], displacements of the surface that is shown */
  float* stress;          /* vertices of the model floats [Pa], von Mises */
} greenloop_multigrid_buffers;

typedef struct greenloop_multigrid_report {
  greenloop_status status;
  uint64_t work;    /* units spent */
  uint32_t refused; /* the load or hold that the status is about, or GREENLOOP_NO_CONSTRAINT */
  float residual;   /* relative */
  uint32_t cycles;
  uint32_t passes; /* of Newton */
} greenloop_multigrid_report;

/* J, of the last step's state. */
typedef struct greenloop_multigrid_energy {
  float kinetic, elastic;
} greenloop_multigrid_energy;

/* Vertices, shown vertices and the time step in s of a model; 0 of one of another problem. */
uint32_t greenloop_multigrid_vertices(const greenloop_model* model);
uint32_t greenloop_multigrid_shown_vertices(const greenloop_model* model);
double greenloop_multigrid_time_step(const greenloop_model* model);

/* Start-up. */
greenloop_multigrid_requirement greenloop_multigrid_required(const greenloop_model* model,
                                                             greenloop_multigrid_limits limits);

/* Start-up. */
greenloop_multigrid_created greenloop_multigrid_create(const greenloop_model* model, greenloop_multigrid_limits limits,
                                                       void* memory, size_t bytes);

/* One cycle of the loop: a time step of the model. For the loop. */
greenloop_multigrid_report greenloop_multigrid_step(greenloop_multigrid* body, greenloop_multigrid_inputs inputs,
                                                    uint64_t work, greenloop_multigrid_buffers buffers);

/* Work: linear in the tetrahedra. For the loop. */
greenloop_multigrid_energy greenloop_multigrid_energy_of(const greenloop_multigrid* body);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
