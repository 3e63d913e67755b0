/* Greenloop for C99 and every language that calls C: the same loops as the C++ headers beside it, the same bits.
 *
 * Memory: the caller owns all of it. A model is read in place: its bytes and the arena stay as they are while a body
 * uses them; a body needs the greenloop_model no more once it is made. Nothing allocates, locks or enters the kernel.
 *
 * Threads: a greenloop_model does not change once it is open, so any number of threads may use one at once, each with a
 * body and an arena of its own. A body is for one thread at a time; so are the buffers of a step.
 *
 * What is said to be for the loop may be called there; the rest is for start-up. */
#ifndef GREENLOOP_H
#define GREENLOOP_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include <stddef.h>
#include <stdint.h>

#include "runtime/price_list.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GREENLOOP_ALIGNMENT = 64 };  /* of a model's bytes and of an arena */
enum { GREENLOOP_MAX_LEVELS = 12 }; /* of a model */
#define GREENLOOP_NO_CONSTRAINT 0xffffffffU

#define GREENLOOP_VERSION_MAJOR 0
#define GREENLOOP_VERSION_MINOR 2
#define GREENLOOP_VERSION_PATCH 0

/* Of the library, which may differ from the header's, and of the model files that it writes and reads. */
typedef struct greenloop_version_numbers {
  int major, minor, patch;
  int format_major, format_minor;
} greenloop_version_numbers;

/* What a model file is precomputed for: which functions take it. */
typedef enum greenloop_problem {
  GREENLOOP_PROBLEM_ELASTOSTATIC = 1,
  GREENLOOP_PROBLEM_SCALAR = 2,
  GREENLOOP_PROBLEM_IMPULSE_RESPONSE = 3,
  GREENLOOP_PROBLEM_MULTIGRID = 4
} greenloop_problem;

/* Rules of the verifier that a model file can break. */
typedef enum greenloop_rule {
  GREENLOOP_RULE_OK,
  GREENLOOP_RULE_MISALIGNED_MEMORY,
  GREENLOOP_RULE_TOO_SHORT,
  GREENLOOP_RULE_BAD_MAGIC,
  GREENLOOP_RULE_FOREIGN_ENDIANNESS,
  GREENLOOP_RULE_UNSUPPORTED_MAJOR,
  GREENLOOP_RULE_WRONG_LENGTH,
  GREENLOOP_RULE_HEADER_CHECKSUM,
  GREENLOOP_RULE_TABLE_CHECKSUM,
  GREENLOOP_RULE_SECTION_OUT_OF_BOUNDS,
  GREENLOOP_RULE_SECTION_MISALIGNED,
  GREENLOOP_RULE_SECTION_OVERLAP,
  GREENLOOP_RULE_SECTION_ORDER,
  GREENLOOP_RULE_SECTION_MISSING,
  GREENLOOP_RULE_SECTION_DUPLICATE,
  GREENLOOP_RULE_SECTION_SIZE,
  GREENLOOP_RULE_SECTION_CHECKSUM,
  GREENLOOP_RULE_PADDING_NOT_ZERO,
  GREENLOOP_RULE_RESERVED_NOT_ZERO,
  GREENLOOP_RULE_BAD_ENUM,
  GREENLOOP_RULE_OUT_OF_RANGE,
  GREENLOOP_RULE_NOT_FINITE,
  GREENLOOP_RULE_NOT_INCREASING,
  GREENLOOP_RULE_INCONSISTENT
} greenloop_rule;

typedef enum greenloop_create_error {
  GREENLOOP_CREATE_OK,
  GREENLOOP_CREATE_ARENA_TOO_SMALL,
  GREENLOOP_CREATE_ARENA_MISALIGNED,
  GREENLOOP_CREATE_BAD_LIMITS,
  GREENLOOP_CREATE_UNSUPPORTED_MODEL,
  GREENLOOP_CREATE_MISMATCHED_MODELS
} greenloop_create_error;

/* What came of a step. On GREENLOOP_OK and GREENLOOP_COARSER the buffers hold the answer; on any other nothing was
 * written, so they still hold the last good one, and the body stays usable. */
typedef enum greenloop_status {
  GREENLOOP_OK,
  GREENLOOP_COARSER,
  GREENLOOP_HELD_NOT_FINITE,
  GREENLOOP_HELD_OUT_OF_RANGE,
  GREENLOOP_HELD_NOT_TOUCHABLE,
  GREENLOOP_HELD_DUPLICATE,
  GREENLOOP_HELD_RESPONSE_SIZE,
  GREENLOOP_HELD_OVER_BUDGET,
  GREENLOOP_HELD_SINGULAR,
  GREENLOOP_HELD_OVERFLOW,
  GREENLOOP_HELD_UNSUPPORTED,
  GREENLOOP_HELD_BAD_SURFACE,
  GREENLOOP_HELD_UNSOLVED,
  GREENLOOP_HELD_ILLEGAL_IMPULSE
} greenloop_status;

/* An open model; its contents are the library's. */
typedef struct greenloop_model {
#if UINTPTR_MAX > 0xffffffffU
  uint64_t storage[832];
#else
  uint64_t storage[512];
#endif
} greenloop_model;

/* A body of greenloop_elastostatic_create; it lives in the caller's arena. */
typedef struct greenloop_elastostatic greenloop_elastostatic;

/* The first fault of a model file. */
typedef struct greenloop_fault {
  greenloop_rule rule;
  uint32_t section;  /* kind of the section at fault, as in docs/format.md; 0: the header or the table */
  uint16_t a, b;     /* its indices */
  const char* field; /* static storage */
  uint64_t index;    /* of the element within the section */
  double value;      /* what stands there */
  double limit;      /* what was allowed */
} greenloop_fault;

/* What pieces of a step cost, in 256ths of a work unit each: see runtime/price_list.h and docs/budgets.md. */
typedef struct greenloop_prices {
#define GREENLOOP_ROW(name, x86_64, cortex_m7, what) uint32_t name;
  GREENLOOP_PRICES(GREENLOOP_ROW)
#undef GREENLOOP_ROW
} greenloop_prices;

/* The default ones: a unit is about an instruction of an x86-64 processor. */
greenloop_prices greenloop_default_prices(void);

/* A unit is about an instruction of a Cortex-M7. */
greenloop_prices greenloop_cortex_m7_prices(void);

/* What a body must be able to do. */
typedef struct greenloop_elastostatic_limits {
  uint32_t max_contacts;   /* 1..4096, contacts per step */
  uint32_t cached_factors; /* 1..1024, capacitance factors kept */
  int forces_only;         /* 1: no fields, little memory */
  int keep_capacitance;    /* 1: capacitance matrices beside their factors, for greenloop_elastostatic_compliance */
  uint32_t glide_cycles;   /* 1..256, steps in which the forces go over to another level; 1: at once; 0: 16 */
  uint64_t refining_work;  /* units of a step up to which it prepares a finer level; 0: no bound */
  const greenloop_prices* prices; /* that make work units of what a step does; read at once; null: the default ones */
  uint32_t max_forces; /* 0..4096, nodes that known forces are on in a step, those of masks each time; 0: refused */
  int model_loads;     /* 1: the model's loads may act, gravity and pressures */
  uint32_t max_points; /* 0..4096, points whose displacement may be asked for at once; 0: none, nor what masks meet */
  uint32_t iterations; /* 0..1024 for unilateral contacts (greenloop_contact.h), at most 256 of them; 0: refused */
  int mixed_contacts;  /* 1: contacts of kinds GREENLOOP_NORMAL and GREENLOOP_MASK; 0: they are refused */
} greenloop_elastostatic_limits;

/* The loop that a model is meant for, as its scene has it ([budget] of docs/scene.md). */
typedef struct greenloop_elastostatic_intent {
  greenloop_elastostatic_limits limits; /* the scene's contacts, the rest by default: what `work` was computed for */
  uint64_t work; /* units per step: the scene's, or what the build chose, enough for the finest level */
  float rate;    /* Hz, steps per second */
  float share;   /* of a period that a step may take, above 0 and at most 1; 1: or the scene has none */
} greenloop_elastostatic_intent;

/* What those limits cost. Work is counted in units: see docs/budgets.md. */
typedef struct greenloop_elastostatic_requirement {
  size_t bytes;                              /* of the arena; 0: greenloop_elastostatic_create would refuse */
  uint64_t least_work;                       /* the smallest budget that greenloop_elastostatic_step accepts */
  uint64_t worst_work[GREENLOOP_MAX_LEVELS]; /* of a step by its constraint_level */
  uint64_t selected_work; /* of greenloop_elastostatic_displacements and _masked_compliance; 0: they are not answered */
} greenloop_elastostatic_requirement;

typedef struct greenloop_elastostatic_created {
  greenloop_create_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_elastostatic* body;         /* null on an error */
} greenloop_elastostatic_created;

/* What is known of a node or a mask. Forces are known by greenloop_elastostatic_limits.max_forces, GREENLOOP_NORMAL and
 * GREENLOOP_MASK by mixed_contacts there. */
typedef enum greenloop_constraint_kind {
  GREENLOOP_HOLD,    /* all three components of a node's displacement */
  GREENLOOP_NORMAL,  /* what a directed mask measures, as a node's displacement along its normal; all else is free */
  GREENLOOP_FORCE,   /* the force on a node */
  GREENLOOP_PATTERN, /* the force of a mask as a whole; it is spread by the mask's weights */
  GREENLOOP_MASK,    /* all three components of a mask's mean displacement */
  GREENLOOP_ALONG    /* the force along a directed mask */
} greenloop_constraint_kind;

typedef struct greenloop_constraint {
  uint32_t node;  /* index in the model file, or the number of a mask or directed mask */
  float value[3]; /* m where displacements are known, N where forces are; of a directed mask the first alone */
  greenloop_constraint_kind kind;
} greenloop_constraint;

/* A point of the surface, where a vertex of the author's lies for example: nodes of the model and the share of each.
 * Its displacement is that of the nodes, weighted. */
typedef struct greenloop_vertex {
  uint32_t node[3];
  float weight[3]; /* 0..1, sum 1 */
} greenloop_vertex;

/* A scalar pressure mask: the nodes that a force is spread over, and the part of it on each, >= 0 with sum 1, or the
 * share of the force that it takes. As many nodes as weights. */
typedef struct greenloop_mask {
  const uint32_t* node;
  size_t nodes;
  const float* weight;
  size_t weights;
} greenloop_mask;

/* A mask whose force has a direction of its own at each node: an amount x of it is the forces x part[k], and it
 * measures the sum of part[k] times the displacement of node[k]. part: 3 floats a node; parts: nodes. */
typedef struct greenloop_directed_mask {
  const uint32_t* node;
  size_t nodes;
  const float* part;
  size_t parts;
} greenloop_directed_mask;

/* What acts on a body in a step beside its constraints, and how stiff it is. */
typedef struct greenloop_loads {
  const greenloop_mask* mask; /* that constraints of kinds GREENLOOP_PATTERN and GREENLOOP_MASK name */
  size_t masks;
  float gravity[3];      /* m/s^2, of the whole body, where greenloop_has_gravity */
  const float* pressure; /* Pa, of the model's first pressures, in their order */
  size_t pressures;
  float stiffness; /* 2^-20..2^20, Young's modulus over the model's; 0: 1 */
  const greenloop_directed_mask*
      directed_mask; /* that constraints of kinds GREENLOOP_NORMAL and GREENLOOP_ALONG name */
  size_t directed_masks;
} greenloop_loads;

/* A force [N] and its torque [N m] about a point. */
typedef struct greenloop_wrench {
  float force[3];
  float torque[3];
} greenloop_wrench;

/* How a step was answered. */
typedef struct greenloop_elastostatic_details {
  int cached_factor;         /* 1: the capacitance factor came from the cache, unchanged */
  uint32_t held_contacts;    /* constraints that the answer holds */
  uint32_t waiting_contacts; /* the others: they are new and have no force yet */
  uint32_t changed_nodes;    /* nodes put into a cached factor and taken out of it, to make this one */
  float glide;               /* share of constraint_level in the forces; the rest is of the level before it */
  float level_difference;    /* N, largest component of the older level's forces minus the newer one's; 0: no glide */
  double switch_work;        /* J, elastic energy that this step's change of `glide` put into the body */
  uint64_t needed_work;      /* units that the budget had to hold for this answer, bounds of what is counted later */
  uint64_t pending_work;     /* units, at most, until the factor of a finer level is complete; 0: none is made */
} greenloop_elastostatic_details;

typedef struct greenloop_elastostatic_report {
  greenloop_status status;
  uint32_t refused;          /* first constraint, by its place, that `status` is about; or GREENLOOP_NO_CONSTRAINT */
  uint64_t work;             /* units spent, never more than the budget */
  uint32_t constraint_level; /* level at which they were resolved */
  uint32_t field_level;      /* finest level whose details are in the field */
  float error; /* largest relative error that such answers were measured to have; infinity: unknown, held */
  greenloop_elastostatic_details details;
} greenloop_elastostatic_report;

greenloop_version_numbers greenloop_version(void);

/* Whether a step was answered, so that its buffers hold this step's answer. */
int greenloop_answered(greenloop_status status);

/* Verifies every field of a model file once. bytes: GREENLOOP_ALIGNMENT-aligned. The model is usable only if the rule
 * is GREENLOOP_RULE_OK. Start-up; work linear in the bytes. */
greenloop_fault greenloop_open(const void* bytes, size_t size, greenloop_model* model);

greenloop_problem greenloop_model_problem(const greenloop_model* model);

uint32_t greenloop_node_count(const greenloop_model* model);
/* Nodes of mesh levels 0..level, which come first; 0 for a level that the model does not have. */
uint32_t greenloop_node_count_to(const greenloop_model* model, uint32_t level);
uint32_t greenloop_level_count(const greenloop_model* model);

/* Whether a node may be a contact; 0 for a node that the model does not have. */
int greenloop_is_touchable(const greenloop_model* model, uint32_t node);

/* Writes a node's place at rest, 3 floats [m]; 0 if the model does not have the node. */
int greenloop_position(const greenloop_model* model, uint32_t node, float* position);

/* What the scene asked for. Start-up. */
greenloop_elastostatic_intent greenloop_elastostatic_intended(const greenloop_model* model);

/* Bytes and worst-case work in closed form. Start-up. */
greenloop_elastostatic_requirement greenloop_elastostatic_required(const greenloop_model* model,
                                                                   greenloop_elastostatic_limits limits);

/* Makes a body in `arena`, GREENLOOP_ALIGNMENT-aligned. Start-up; linear in the model's bytes. */
greenloop_elastostatic_created greenloop_elastostatic_create(const greenloop_model* model,
                                                             greenloop_elastostatic_limits limits, void* arena,
                                                             size_t bytes);

/* One cycle of the loop: the forces that hold `count` contacts where they are, and the displacement of the first
 * `nodes` nodes, all or those of the coarser levels (greenloop_node_count_to). force: 3 * count floats [N], in the
 * order of the contacts. displacement: 4 * nodes floats [m], x y z 0 per node, 16-byte aligned; null and 0 if no field
 * is wanted, which then costs nothing. Spends at most `work` units. For the loop. */
greenloop_elastostatic_report greenloop_elastostatic_step(greenloop_elastostatic* body,
                                                          const greenloop_constraint* contacts, size_t count,
                                                          uint64_t work, float* force, float* displacement,
                                                          uint32_t nodes);

/* The compliance between two constraints, by their places among those of the last answer, at the levels that it
 * was answered at: the displacement of i per force at j [m/N], of nodes that share a column the column's. While a glide
 * is under way the answer's forces are not those that it gives. block: 9 floats, 3 c + r,
 * displacement r per force c. 0, and nothing is written, unless the capacitance is kept (limits), the last step was
 * answered and its factor is still in the cache, which one factor of a finer level may replace. For the loop. */
int greenloop_elastostatic_compliance(const greenloop_elastostatic* body, uint32_t i, uint32_t j, float* block);

/* The same step with what else acts: known forces, on nodes and by masks, gravity and pressures. They reduce what the
 * contacts have to do; the force of a known one is itself. Of all kinds of constraints there are `count`. For the loop.
 */
greenloop_elastostatic_report greenloop_elastostatic_step_loaded(greenloop_elastostatic* body,
                                                                 const greenloop_constraint* constraints, size_t count,
                                                                 const greenloop_loads* loads, uint64_t work,
                                                                 float* force, float* displacement, uint32_t nodes);

/* Whether the model has accelerations, so that gravity may act; how many pressures it has. */
int greenloop_has_gravity(const greenloop_model* model);
uint32_t greenloop_pressure_count(const greenloop_model* model);

/* A mask along a unit vector, 3 floats; and the torque of a mask, N m, about a unit vector through its centre, without
 * a force in all. part: room for 3 floats a node, which the directed mask refers to. Of 0 nodes if there are more than
 * `capacity`, or none is off the axis. For the loop; linear in the nodes. */
greenloop_directed_mask greenloop_direct_mask(const greenloop_mask* mask, const float* direction, float* part,
                                              size_t capacity);
greenloop_directed_mask greenloop_make_torque_mask(const greenloop_model* model, const greenloop_mask* mask,
                                                   const float* axis, float* part, size_t capacity);

/* Selected answers. Each returns the units that it spent beside those of steps; 0, and nothing is written, where it is
 * refused. For the loop; at most greenloop_elastostatic_requirement.selected_work, the stiffness three times that. */

/* Displacements of points by all that acts in the last answer, 3 * count floats [m]. */
uint64_t greenloop_elastostatic_displacements(greenloop_elastostatic* body, const greenloop_vertex* points,
                                              size_t count, float* displacement);
/* The displacement of a node per force on a mask [m/N], of the model's own stiffness. block: 9 floats, 3 c + r. */
uint64_t greenloop_elastostatic_masked_compliance(greenloop_elastostatic* body, uint32_t node,
                                                  const greenloop_mask* mask, float* block);
/* The stiffness of a point-like contact [N/m]: the mean of its corners' by the point's weights, `rigid` along all axes
 * where a corner is held in place. masks: 3, of the corners. capped: 1: none is stiffer than `rigid`. */
uint64_t greenloop_elastostatic_stiffness(greenloop_elastostatic* body, const greenloop_vertex* point,
                                          const greenloop_mask* masks, float rigid, int capped, float* stiffness);

/* The sum of `count` forces at positions, 3 * count floats of each, and of their torques about a point. For the loop.
 */
greenloop_wrench greenloop_total_wrench(const float* position, const float* force, size_t count, const float* about);

/* One sentence each; static storage. */
const char* greenloop_rule_text(greenloop_rule rule);
const char* greenloop_create_error_text(greenloop_create_error error);
const char* greenloop_status_text(greenloop_status status);

/* ---- The surface: what runtime/surface.hpp gives. ----
 *
 * A greenloop_surface lives in the caller's memory, GREENLOOP_ALIGNMENT-aligned, and needs the model no more once it is
 * created. It does not change: any number of threads may ask at once. All but _required and _create are for the loop.
 */

#define GREENLOOP_NONE 0xffffffffU /* no node, no triangle */

/* What a node may be: flags to be added up. */
enum {
  GREENLOOP_NODE_DOMAIN = 1,    /* its displacement is stored */
  GREENLOOP_NODE_TOUCHABLE = 2, /* may be a contact */
  GREENLOOP_NODE_FIXED = 4,     /* held in place */
  GREENLOOP_NODE_READ = 8       /* the scene asked for its displacement */
};

typedef struct greenloop_surface greenloop_surface;

typedef enum greenloop_surface_error {
  GREENLOOP_SURFACE_OK,
  GREENLOOP_SURFACE_BAD_LEVEL,
  GREENLOOP_SURFACE_UNSUPPORTED_MODEL,
  GREENLOOP_SURFACE_MEMORY_TOO_SMALL,
  GREENLOOP_SURFACE_MEMORY_MISALIGNED
} greenloop_surface_error;

typedef struct greenloop_surface_created {
  greenloop_surface_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_surface* surface;           /* null on an error */
} greenloop_surface_created;

/* Nodes of the model, counter-clockwise seen from outside. */
typedef struct greenloop_triangle {
  uint32_t node[3];
} greenloop_triangle;

/* The nearest node; GREENLOOP_NONE if there is none, or the position is not finite. */
typedef struct greenloop_nearest_node {
  uint32_t node;
  double squared_distance; /* m^2 */
} greenloop_nearest_node;

/* The nearest point: a triangle of the surface's own level, the share of each corner. GREENLOOP_NONE if the position is
 * not finite. */
typedef struct greenloop_nearest_point {
  uint32_t triangle;
  float weight[3];         /* 0..1, sum 1 */
  double squared_distance; /* m^2 */
} greenloop_nearest_point;

/* Bytes for mesh levels 0..level; 0: greenloop_surface_create would refuse. Start-up. */
size_t greenloop_surface_required(const greenloop_model* model, uint32_t level);

/* Start-up; n log n in the triangles. */
greenloop_surface_created greenloop_surface_create(const greenloop_model* model, uint32_t level, void* memory,
                                                   size_t bytes);

/* Triangles, nodes of levels 0..level; 0 for a level that the surface does not have. */
uint32_t greenloop_surface_triangle_count(const greenloop_surface* surface, uint32_t level);
uint32_t greenloop_surface_node_count(const greenloop_surface* surface, uint32_t level);

/* Each of these writes `count` elements, which must be all there are at `level`; else it returns 0 and writes nothing.
 * displacement: null, at rest; or 4 * count floats [m], 16-byte aligned. normal: 4 * count floats, x y z 0, 16-byte
 * aligned, unit vectors outwards. area: count floats [m^2]. Work: linear in the triangles of the level. */
int greenloop_surface_triangles(const greenloop_surface* surface, uint32_t level, greenloop_triangle* triangle,
                                uint32_t count);
int greenloop_surface_normals(const greenloop_surface* surface, uint32_t level, const float* displacement,
                              float* normal, uint32_t count);
int greenloop_surface_areas(const greenloop_surface* surface, uint32_t level, const float* displacement, float* area,
                            uint32_t count);

/* The mask of a point-like contact: of every corner of the point the function max(0, 1 - distance / radius), integrated
 * with touchable nodes' linear functions, normalised; of these the mean by the point's weights. node, weight: room for
 * `capacity` of each, which the mask refers to. Of 0 nodes if they do not fit, or a number, node or level is wrong. For
 * the loop; work: make_mask of runtime/mask.hpp. */
greenloop_mask greenloop_make_mask(const greenloop_surface* surface, uint32_t level, const greenloop_vertex* point,
                                   float radius, uint32_t* node, float* weight, size_t capacity);

/* What is nearest to a position, 3 floats [m], at rest; of equally near ones the first. flags: all of them must be set
 * of the node. Work: some tens of triangles as a rule, at most all. */
greenloop_nearest_node greenloop_surface_nearest_node(const greenloop_surface* surface, const float* position,
                                                      uint32_t flags);
greenloop_nearest_point greenloop_surface_nearest_point(const greenloop_surface* surface, const float* position);

/* Vertices of the author's surface, in the order of its file; 0 if the scene did not ask to keep them. */
size_t greenloop_vertex_count(const greenloop_model* model);
/* Writes where one lies; 0 if there is no such vertex. */
int greenloop_vertex_on_surface(const greenloop_model* model, size_t vertex, greenloop_vertex* where);

/* One sentence; static storage. */
const char* greenloop_surface_error_text(greenloop_surface_error error);

/* ---- The recorder: what runtime/recorder.hpp gives, docs/recorder.md. ----
 *
 * Keeps the last steps of one body in the caller's memory, GREENLOOP_ALIGNMENT-aligned, so that greenloop-replay can
 * run them again to the same bits. Arena and memory must outlive it and stay where they are. */

typedef struct greenloop_recorder greenloop_recorder;

typedef struct greenloop_recorder_options {
  uint32_t steps;       /* kept, >= 1 */
  uint64_t interval;    /* steps from one checkpoint to the next; 0: greenloop_recorder_checkpoint is called */
  uint32_t field_nodes; /* whose displacement goes into the digest, the first ones of the file */
} greenloop_recorder_options;

typedef enum greenloop_recorder_error {
  GREENLOOP_RECORDER_OK,
  GREENLOOP_RECORDER_BAD_OPTIONS,
  GREENLOOP_RECORDER_BAD_BODY,
  GREENLOOP_RECORDER_MEMORY_TOO_SMALL,
  GREENLOOP_RECORDER_MEMORY_MISALIGNED
} greenloop_recorder_error;

typedef struct greenloop_recorder_created {
  greenloop_recorder_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_recorder* recorder;         /* null on an error */
} greenloop_recorder_created;

/* Bytes; 0: greenloop_recorder_create would refuse. Start-up. */
size_t greenloop_recorder_required(const greenloop_model* model, greenloop_elastostatic_limits limits,
                                   greenloop_recorder_options options);

/* For a body just created with this model and these limits in `arena`, before its first step. Start-up; copies the
 * arena. */
greenloop_recorder_created greenloop_recorder_create(const greenloop_model* model, greenloop_elastostatic_limits limits,
                                                     const void* arena, size_t arena_bytes,
                                                     greenloop_recorder_options options, void* memory, size_t bytes);

/* greenloop_elastostatic_step, recorded. For the loop. */
greenloop_elastostatic_report greenloop_recorder_step(greenloop_recorder* recorder, greenloop_elastostatic* body,
                                                      const greenloop_constraint* contacts, size_t count, uint64_t work,
                                                      float* force, float* displacement, uint32_t nodes);

/* Copies the arena, for a replay to start from. For a moment of the loop that has the time. */
void greenloop_recorder_checkpoint(greenloop_recorder* recorder);

/* What is to be written to a file. */
const void* greenloop_recorder_record(const greenloop_recorder* recorder, size_t* bytes);

/* One sentence; static storage. */
const char* greenloop_recorder_error_text(greenloop_recorder_error error);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
