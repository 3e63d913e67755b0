/* Unilateral contacts and rigid tools in C99: what Elastostatic::step of unilateral contacts (docs/loop.md) and
 * runtime/contact_body.hpp (docs/touching.md) give, the same bits. Memory and threads: as greenloop.h says. */
#ifndef GREENLOOP_CONTACT_H
#define GREENLOOP_CONTACT_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include "runtime/greenloop.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a unilateral contact does; in an uint8_t where it stands in an array. */
typedef enum greenloop_contact_state {
  GREENLOOP_CONTACT_OPEN,  /* no force */
  GREENLOOP_CONTACT_STICK, /* it does not slide */
  GREENLOOP_CONTACT_SLIP   /* it slides, or is about to: the force is on the cone of friction */
} greenloop_contact_state;

/* A rigid surface at a point of a body: it may push the point and rub against it, but not pull it. */
typedef struct greenloop_unilateral_contact {
  uint32_t node[3]; /* touchable ones that the point hangs on; GREENLOOP_NONE: there are fewer */
  float weight[3];  /* of each, above 0; 1 in all, or less where a corner cannot move */
  float value[3];   /* m, the point's displacement at which it touches the surface and has not slid along it */
  float normal[3];  /* unit vector out of the surface, to where the point may be */
  float friction;   /* Coulomb's coefficient, 0 or more; above 1,000 as 1,000 */
  float softness;   /* m/N, of the surface itself, 0 or more; above 0 if no node is named */
  float force[3];   /* N, a guess to begin with, as from the last step */
  uint32_t tool;    /* whose the surface is: contacts of a tool share its mount */
  float mount;      /* m/N, of a spring that the whole tool hangs on, 0 or more; the same for all of its contacts */
} greenloop_unilateral_contact;

typedef struct greenloop_unilateral_report {
  greenloop_elastostatic_report step;
  float residual;      /* of the contact laws, relative */
  uint32_t iterations; /* that were made */
} greenloop_unilateral_report;

/* greenloop_elastostatic_step for `count` rigid surfaces that push and rub, of a body with limits.iterations. loads:
 * null: nothing else acts. force: 3 * count floats [N]. state: count of greenloop_contact_state; null: not wanted.
 * gap: 4 * count floats, 16-byte aligned [m], from where each touches and has not slid; null: not wanted. For the
 * loop. */
greenloop_unilateral_report greenloop_elastostatic_push(greenloop_elastostatic* body,
                                                        const greenloop_unilateral_contact* contacts, size_t count,
                                                        const greenloop_loads* loads, uint64_t work, float* force,
                                                        uint8_t* state, float* gap, float* displacement,
                                                        uint32_t nodes);

/* ---- Rigid tools. ---- */

/* A convex polyhedron in the caller's memory. */
typedef struct greenloop_polyhedron greenloop_polyhedron;

typedef enum greenloop_polyhedron_error {
  GREENLOOP_POLYHEDRON_OK,
  GREENLOOP_POLYHEDRON_BAD_COUNT,  /* fewer than four vertices or faces, or more than 128 or 252 */
  GREENLOOP_POLYHEDRON_NOT_FINITE, /* a vertex is not finite, or a coordinate of more than 1e6 m */
  GREENLOOP_POLYHEDRON_BAD_INDEX,  /* a face names no vertex */
  GREENLOOP_POLYHEDRON_FLAT_FACE,  /* a face has no area */
  GREENLOOP_POLYHEDRON_NOT_CLOSED, /* an edge is not that of just two faces that run along it in opposite directions */
  GREENLOOP_POLYHEDRON_INWARD,     /* faces are clockwise seen from outside, or enclose nothing */
  GREENLOOP_POLYHEDRON_NOT_CONVEX, /* a vertex stands out from a face's plane */
  GREENLOOP_POLYHEDRON_MEMORY_TOO_SMALL,
  GREENLOOP_POLYHEDRON_MEMORY_MISALIGNED
} greenloop_polyhedron_error;

typedef struct greenloop_polyhedron_created {
  greenloop_polyhedron_error error;
  uint32_t at;                            /* the vertex or face, by its number, that the error is about */
  size_t requested, available, missing;   /* bytes */
  const greenloop_polyhedron* polyhedron; /* null on an error */
} greenloop_polyhedron_created;

/* Bytes. Start-up. */
size_t greenloop_polyhedron_required(size_t vertices, size_t faces);

/* vertex: 3 * vertices doubles [m]; face: 3 * faces numbers of vertices, counter-clockwise seen from outside. Both are
 * copied into `memory`, GREENLOOP_ALIGNMENT-aligned. Start-up; quadratic. */
greenloop_polyhedron_created greenloop_polyhedron_create(const double* vertex, size_t vertices, const uint32_t* face,
                                                         size_t faces, void* memory, size_t bytes);

typedef enum greenloop_shape_kind {
  GREENLOOP_SHAPE_POINT,     /* in the origin of its own frame */
  GREENLOOP_SHAPE_SPHERE,    /* around the origin. size[0]: its radius */
  GREENLOOP_SHAPE_CAPSULE,   /* along z. size[0]: its radius; size[1]: half the length of its axis */
  GREENLOOP_SHAPE_BOX,       /* around the origin. size: half its sides */
  GREENLOOP_SHAPE_PLANE,     /* the half space z <= 0 */
  GREENLOOP_SHAPE_POLYHEDRON /* polyhedron: what it is */
} greenloop_shape_kind;

/* The shape of a tool, in its own frame. An unknown kind, or a polyhedron that is null, is a bad shape. */
typedef struct greenloop_shape {
  greenloop_shape_kind kind;
  double size[3];                         /* m */
  const greenloop_polyhedron* polyhedron; /* its memory must outlive the shape; null for others */
} greenloop_shape;

typedef struct greenloop_tool {
  greenloop_shape shape;
  double position[3];   /* m, of its origin, in the frame of the model */
  double quaternion[4]; /* w, x, y, z of unit length: turns the tool's axes into the model's */
  double friction;      /* Coulomb's coefficient, 0 or more; above 1,000 as 1,000 */
  double compliance;    /* m/N, of a spring between the pose and the tool, 0 or more; 0: the tool is at its pose */
} greenloop_tool;

/* Why a tool was left alone in a step. */
typedef enum greenloop_tool_fault {
  GREENLOOP_TOOL_OK,
  GREENLOOP_TOOL_BAD_SHAPE,
  GREENLOOP_TOOL_TOO_MANY_POINTS, /* more than the limits have */
  GREENLOOP_TOOL_NOT_FINITE,      /* its pose */
  GREENLOOP_TOOL_TOO_FAR,         /* a coordinate of more than 1e6 m */
  GREENLOOP_TOOL_NOT_UNIT         /* its quaternion's length differs from 1 by more than 0.01 */
} greenloop_tool_fault;

/* What a tool feels. */
typedef struct greenloop_tool_answer {
  uint8_t fault;          /* a greenloop_tool_fault: with one the tool is left out */
  double force[3];        /* N, on the tool */
  double torque[3];       /* N m, on the tool about its position and sag */
  uint32_t first_contact; /* among greenloop_contact_body_contacts */
  uint32_t contacts;      /* places that may touch, of which those with a force do */
  double depth;           /* m, how far the tool was inside of the surface before this step's answer */
  uint8_t is_behind;      /* a point of it that is followed was behind the surface then */
  double sag[3];          /* m, how far its spring lets it be from its pose */
} greenloop_tool_answer;

/* A place of the surface that may touch a tool. */
typedef struct greenloop_touch {
  uint32_t node[3]; /* those after the first are GREENLOOP_NONE unless it lies in a triangle */
  double weight[3];
  uint32_t tool;
  uint8_t state;      /* a greenloop_contact_state */
  double position[3]; /* m, of the surface, displaced */
  double normal[3];   /* unit, out of the tool */
  double force[3];    /* N, on the body */
  double gap;         /* m, from the tool along the normal */
  double slip[3];     /* m, along the tool's surface in this step */
} greenloop_touch;

/* J, of all steps so far: in + from_loads = stored + dissipated + lost, but for what is generated. */
typedef struct greenloop_contact_energy {
  double in;         /* work of the tools on the body while they touch */
  double stored;     /* what the contacts' forces strain the body with */
  double dissipated; /* by friction */
  double lost;       /* by going in steps */
  double generated;  /* the most that did not add up */
  double from_loads; /* what loads that change put in at the contacts; < 0: took out */
} greenloop_contact_energy;

/* An elastic body that tools touch; it lives in the caller's memory. */
typedef struct greenloop_contact_body greenloop_contact_body;

typedef struct greenloop_contact_body_limits {
  greenloop_elastostatic_limits elastostatic; /* max_contacts: at most 256; iterations above 0; forces_only 0 */
  uint32_t max_tools;                         /* 1..16; 0: 2 */
  uint32_t max_points;                        /* of a tool that are followed, 1..128; 0: 8 */
  double margin;          /* m, how near the surface is looked at; 0: a quarter of its mean edge length */
  double rigid_stiffness; /* N/m, of places that cannot move; 0: what the model's material has over 1 mm */
  uint64_t search_work;   /* units that looking for contacts may take; 0: what usually suffices */
  int carried;            /* 1: greenloop_contact_body_carry may be called */
} greenloop_contact_body_limits;

typedef struct greenloop_contact_body_requirement {
  size_t bytes;           /* 0: greenloop_contact_body_create would refuse */
  uint64_t least_work;    /* with that budget every step is answered */
  uint64_t worst_work;    /* of a step that is answered at the finest level */
  uint64_t touching_work; /* of finding contacts, at most: a part of both */
} greenloop_contact_body_requirement;

typedef struct greenloop_contact_body_created {
  greenloop_create_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_contact_body* body;         /* null on an error */
} greenloop_contact_body_created;

typedef struct greenloop_contact_body_report {
  greenloop_unilateral_report contact;
  uint64_t touching_work;  /* what finding contacts took of the work */
  uint32_t left_out;       /* places that may touch, but for which there was no room: the deepest were kept */
  double deepest_left_out; /* m, depth of the deepest of these, negative if not inside of a tool */
  /* The deepest of these, as a greenloop_touch says it; the tool is UINT32_MAX if nothing was left out. */
  uint32_t left_out_tool, left_out_node[3];
  double left_out_weight[3];
  uint32_t unfinished; /* tools that search_work did not suffice for */
} greenloop_contact_body_report;

/* Start-up. */
greenloop_contact_body_requirement greenloop_contact_body_required(const greenloop_model* model,
                                                                   greenloop_contact_body_limits limits);

/* memory: GREENLOOP_ALIGNMENT-aligned. Start-up; linear in the model's bytes. */
greenloop_contact_body_created greenloop_contact_body_create(const greenloop_model* model,
                                                             greenloop_contact_body_limits limits, void* memory,
                                                             size_t bytes);

/* Units that finding what may touch these tools takes at most, wherever they are. For the loop. */
uint64_t greenloop_contact_body_touching_work(const greenloop_contact_body* body, const greenloop_tool* tools,
                                              size_t count);

/* One cycle of the loop. A tool is known from step to step by its place among them; with more than max_tools the step
 * is refused. loads: null: nothing else acts. On a held status the last answer stands. For the loop. */
greenloop_contact_body_report greenloop_contact_body_step(greenloop_contact_body* body, const greenloop_tool* tools,
                                                          size_t count, const greenloop_loads* loads, uint64_t work);

/* The last answer, in the body's memory, until the next step. displacement: 4 floats per node [m], x y z 0. */
const greenloop_tool_answer* greenloop_contact_body_tools(const greenloop_contact_body* body, size_t* count);
const greenloop_touch* greenloop_contact_body_contacts(const greenloop_contact_body* body, size_t* count);
greenloop_contact_energy greenloop_contact_body_energy(const greenloop_contact_body* body);
const float* greenloop_contact_body_displacement(const greenloop_contact_body* body, size_t* nodes);

/* m^2, of the surface at rest that a contact stands for: its force over it is the traction there. For the loop. */
double greenloop_contact_body_area(const greenloop_contact_body* body, const greenloop_touch* touch);

/* The tool is somewhere else without having been between. For the loop. */
void greenloop_contact_body_forget(greenloop_contact_body* body, uint32_t tool);

/* Factors on the tools' coefficients of friction, of each node, 0 or more, read in every step until the next call; the
 * memory is the caller's, who may change them between steps. Null: 1 everywhere. For the loop. */
void greenloop_contact_body_surface_friction(greenloop_contact_body* body, const float* factor, size_t nodes);

/* The surface at rest moves by itself, by 4 floats per node [m], x y z 0, read in every step until the next call; the
 * memory is the caller's. Null: it stands still. 1; or 0, and nothing changes, with another number of nodes than the
 * model's or without greenloop_contact_body_limits.carried. For the loop. */
int greenloop_contact_body_carry(greenloop_contact_body* body, const float* offset, size_t nodes);

/* ---- A faster loop, and a passive one. ---- */

enum { GREENLOOP_LOCAL_TOOLS = 3, GREENLOOP_LOCAL_COMPONENTS = 18 };

/* The tools' forces as they follow the tools' motions while no contact changes its state: runtime/local_model.hpp. */
typedef struct greenloop_local_model {
  uint32_t tools;
  uint32_t components; /* of a tool's motion: 3, a translation, or 6, then a rotation vector */
  float length;        /* m, what a turn by a radian counts as in `range` */
  float range;         /* m, a motion up to which no contact opens, closes, begins to slip or to stick */
  float wrench[GREENLOOP_LOCAL_COMPONENTS]; /* of the body on each tool at the step: force, N, and torque, N m */
  float change[GREENLOOP_LOCAL_COMPONENTS][GREENLOOP_LOCAL_COMPONENTS]; /* of the wrenches per unit of a component */
} greenloop_local_model;

/* Of the last answer, until the next step. turns: 0: tools do not turn meanwhile. length: m, above 0. Returns the work
 * units that it took; 0, and nothing is written: refused, with no answer, no tool or more than GREENLOOP_LOCAL_TOOLS.
 * For the loop. */
uint64_t greenloop_contact_body_local_model(greenloop_contact_body* body, uint8_t turns, float length,
                                            greenloop_local_model* model);

/* motion: tools * components of it since the step, m and rad. */
float greenloop_local_model_motion_length(const greenloop_local_model* model, const float* motion);

/* wrenches: 6 * tools, N and N m. For the loop. */
void greenloop_local_model_evaluate(const greenloop_local_model* model, const float* motion, float* wrenches);

/* The largest stiffness, N/m, that a loop of this period, s, with forces that are late by `delay`, s, may render on a
 * device of this damping, N s/m, and be passive against any hand. */
double greenloop_passive_stiffness(double period, double delay, double damping, double virtual_damping);

/* N/m, of a spring in series with which a body of this stiffness is as soft as `limit`. */
double greenloop_coupling_stiffness(double body, double limit);

enum { GREENLOOP_TANK_PORTS = 16 };

/* Keeps a sampled loop passive by what it observes: runtime/passivity.hpp. */
typedef struct greenloop_energy_tank {
  uint8_t enabled;     /* 0: it only observes */
  double period;       /* s */
  double reserve;      /* J, what the hand may get beyond what it gave */
  double most_damping; /* N s/m, with which it is braked at most */
  double level;        /* J, below 0: overdrawn */
  double lowest;       /* J, the least level so far, at most 0 */
  double drained;      /* J, by braking so far */
  double delivered;    /* J, net, to the hands so far */
  uint32_t ports;      /* the rest is the tank's own */
  double position[GREENLOOP_TANK_PORTS][3], force[GREENLOOP_TANK_PORTS][3], braking[GREENLOOP_TANK_PORTS][3];
} greenloop_energy_tank;

/* An enabled tank; its settings may be changed before the first step. */
greenloop_energy_tank greenloop_energy_tank_make(double period, double reserve, double most_damping);

/* One sample. position, force: 3 * ports doubles [m, N], at most GREENLOOP_TANK_PORTS; force: what is wanted, becomes
 * what is to be rendered. stored: J. For the loop. */
void greenloop_energy_tank_step(greenloop_energy_tank* tank, const double* position, double* force, size_t ports,
                                double stored);

/* One sentence each; static storage. */
const char* greenloop_polyhedron_error_text(greenloop_polyhedron_error error);
const char* greenloop_tool_fault_text(greenloop_tool_fault fault);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
