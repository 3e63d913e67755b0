/* A body that moves by impulse responses and is touched by tools at once, in C99: what runtime/vibrating_body.hpp
 * (docs/impulses.md) gives, the same bits. Memory and threads: as greenloop.h says. */
#ifndef GREENLOOP_VIBRATING_H
#define GREENLOOP_VIBRATING_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include "runtime/greenloop_contact.h"
#include "runtime/greenloop_impulse.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A body of greenloop_vibrating_body_create; it lives in the caller's arena. */
typedef struct greenloop_vibrating_body greenloop_vibrating_body;

typedef struct greenloop_vibrating_body_limits {
  greenloop_contact_body_limits contact; /* it is carried whatever `carried` says */
  greenloop_impulse_response_limits motion;
} greenloop_vibrating_body_limits;

typedef struct greenloop_vibrating_body_requirement {
  size_t bytes;        /* of the arena, GREENLOOP_ALIGNMENT-aligned; 0: refused for another reason */
  uint64_t least_work; /* units: the smallest budget that a step accepts */
  uint64_t worst_work; /* of a step that answers all modes and the finest level */
} greenloop_vibrating_body_requirement;

typedef struct greenloop_vibrating_body_created {
  greenloop_create_error error;         /* GREENLOOP_CREATE_MISMATCHED_MODELS: not of the same surface */
  size_t requested, available, missing; /* bytes */
  greenloop_vibrating_body* body;       /* null on an error */
} greenloop_vibrating_body_created;

typedef struct greenloop_vibrating_body_report {
  greenloop_impulse_response_report motion; /* refused: the surface stands still for this step */
  greenloop_contact_body_report contact;    /* refused: the last answer stands */
  uint64_t work;                            /* units spent by both, and by carrying the surface */
} greenloop_vibrating_body_report;

/* touched: an elastostatic model; moving: one of impulse responses. Start-up. */
greenloop_vibrating_body_requirement greenloop_vibrating_body_required(const greenloop_model* touched,
                                                                       const greenloop_model* moving,
                                                                       greenloop_vibrating_body_limits limits);

/* Both models' bytes must outlive the body. Start-up. */
greenloop_vibrating_body_created greenloop_vibrating_body_create(const greenloop_model* touched,
                                                                 const greenloop_model* moving,
                                                                 greenloop_vibrating_body_limits limits, void* memory,
                                                                 size_t bytes);

/* One cycle: an impulse of the palette, or GREENLOOP_NO_IMPULSE, and a period of the motion; then the tools on the
 * surface where that has brought it. loads: null: nothing else acts. For the loop. */
greenloop_vibrating_body_report greenloop_vibrating_body_step(greenloop_vibrating_body* body, uint32_t impulse,
                                                              const greenloop_tool* tools, size_t count,
                                                              const greenloop_loads* loads, uint64_t work);

/* The part that is touched, for its answers, in the same memory; its steps are the whole body's. */
greenloop_contact_body* greenloop_vibrating_body_contact(const greenloop_vibrating_body* body);

/* 1: the impulse may follow the last one. For the loop. */
int greenloop_vibrating_body_may_follow(const greenloop_vibrating_body* body, uint32_t impulse);

/* As of the last step, 4 floats per node [m], x y z 0: of the motion alone; of that and the contacts'. */
const float* greenloop_vibrating_body_offset(const greenloop_vibrating_body* body, size_t* nodes);
const float* greenloop_vibrating_body_displacement(const greenloop_vibrating_body* body, size_t* nodes);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
