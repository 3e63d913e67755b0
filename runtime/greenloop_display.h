/* Finer pictures and relief in C99: what runtime/finer_surface.hpp, runtime/bound_mesh.hpp, runtime/look.hpp and
 * runtime/relief.hpp give (docs/detail.md), the same bits. Memory: the caller's, GREENLOOP_ALIGNMENT-aligned; the
 * surface must outlive what is made of it. All but _required and _create are for the loop. */
#ifndef GREENLOOP_DISPLAY_H
#define GREENLOOP_DISPLAY_H
/* NOLINTBEGIN(modernize-use-using, modernize-deprecated-headers): this header is C */

#include "runtime/greenloop_contact.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- A surface split further than its model. ---- */

typedef struct greenloop_finer_surface greenloop_finer_surface;

typedef enum greenloop_finer_rule {
  GREENLOOP_FINER_MIDPOINT, /* on the surface's own triangles */
  GREENLOOP_FINER_LOOP      /* smooth, which moves the nodes too */
} greenloop_finer_rule;

typedef enum greenloop_finer_error {
  GREENLOOP_FINER_OK,
  GREENLOOP_FINER_BAD_OPTIONS,
  GREENLOOP_FINER_UNSUPPORTED_SURFACE,
  GREENLOOP_FINER_MEMORY_TOO_SMALL,
  GREENLOOP_FINER_MEMORY_MISALIGNED
} greenloop_finer_error;

typedef struct greenloop_finer_created {
  greenloop_finer_error error;
  size_t requested, available, missing; /* bytes */
  greenloop_finer_surface* surface;     /* null on an error */
} greenloop_finer_created;

/* added: levels, 0..4. Bytes; 0: greenloop_finer_surface_create would refuse for another reason than memory. */
size_t greenloop_finer_surface_required(const greenloop_surface* surface, uint32_t added, greenloop_finer_rule rule);
/* n log n in the triangles. */
greenloop_finer_created greenloop_finer_surface_create(const greenloop_surface* surface, uint32_t added,
                                                       greenloop_finer_rule rule, void* memory, size_t bytes);

/* Of added level k; 0 for a level that it does not have. */
uint32_t greenloop_finer_surface_vertex_count(const greenloop_finer_surface* surface, uint32_t k);
uint32_t greenloop_finer_surface_triangle_count(const greenloop_finer_surface* surface, uint32_t k);
/* Triangle t of added level k, which must be there, counter-clockwise from outside. */
greenloop_triangle greenloop_finer_surface_triangle(const greenloop_finer_surface* surface, uint32_t k, uint32_t t);

/* Where the vertices of added level k are: 4 * count floats [m], x y z 0; count: all of the level. displacement: null,
 * at rest; or 4 * nodes floats. Vectors are 16-byte aligned. 0, and nothing written, on a wrong size. */
int greenloop_finer_surface_positions(const greenloop_finer_surface* surface, uint32_t k, const float* displacement,
                                      uint32_t nodes, float* position, uint32_t count);
/* Outward unit normals at these positions, 4 * count floats. */
int greenloop_finer_surface_normals(const greenloop_finer_surface* surface, uint32_t k, const float* position,
                                    float* normal, uint32_t count);

/* ---- A mesh of the caller's, bound to the surface. ---- */

typedef struct greenloop_bound_mesh greenloop_bound_mesh;

typedef enum greenloop_bound_error {
  GREENLOOP_BOUND_OK,
  GREENLOOP_BOUND_BAD_VERTEX,
  GREENLOOP_BOUND_MEMORY_TOO_SMALL,
  GREENLOOP_BOUND_MEMORY_MISALIGNED
} greenloop_bound_error;

typedef struct greenloop_bound_created {
  greenloop_bound_error error;
  size_t at;                            /* the vertex that the error is about */
  size_t requested, available, missing; /* bytes */
  greenloop_bound_mesh* mesh;           /* null on an error */
} greenloop_bound_created;

size_t greenloop_bound_mesh_required(const greenloop_surface* surface, size_t vertices);
/* vertex: 3 * vertices floats [m], at rest. A nearest point of the surface each. */
greenloop_bound_created greenloop_bound_mesh_create(const greenloop_surface* surface, const float* vertex,
                                                    size_t vertices, void* memory, size_t bytes);
uint32_t greenloop_bound_mesh_vertex_count(const greenloop_bound_mesh* mesh);
/* Where the vertices are: 4 * count floats [m]. displacement: null, at rest; or 4 * nodes floats. normal: 4 * nodes
 * floats, greenloop_surface_normals of the surface's level under this displacement. seen: null, all; or `triangles`
 * flags, one for each of a level of the surface: vertices over others are left as they were. Vectors are 16-byte
 * aligned. 0, and nothing written, on a wrong size. */
int greenloop_bound_mesh_positions(const greenloop_bound_mesh* mesh, const float* displacement, const float* normal,
                                   uint32_t nodes, const uint8_t* seen, uint32_t triangles, float* position,
                                   uint32_t count);

/* ---- What is looked at. ---- */

typedef struct greenloop_look {
  float eye[3];       /* m */
  float direction[3]; /* unit vector that it looks along */
  float cosine;       /* of half the angle that it sees; -1: all around */
  float detail;       /* rad: edges that look shorter need not be halved; 0: as fine as there is */
  float turned;       /* cosine up to which what faces away counts as seen, 0..1 */
} greenloop_look;

typedef struct greenloop_seen {
  uint32_t triangles; /* that are seen */
  uint32_t halvings;  /* of the surface's edges, after which none that is seen looks longer than `detail` */
} greenloop_seen;

/* seen: `triangles` flags, one for each triangle of a level of the surface. */
greenloop_seen greenloop_look_at(const greenloop_surface* surface, const float* displacement, uint32_t nodes,
                                 greenloop_look look, uint8_t* seen, uint32_t triangles);

/* ---- Relief that tools feel as friction. ---- */

/* slope: 3 * count floats, from normals of a finer surface at rest (4 * count floats) and those of a normal map
 * (3 * count floats). */
int greenloop_relief_slopes(const float* normal, const float* detail, float* slope, uint32_t count);

/* Of a tool that moves by `way` (3 doubles, m a step) and touched in these contacts: its friction in the next step.
 * slope: 3 floats for each of `count` vertices of the last added level. */
double greenloop_relief_friction(const greenloop_finer_surface* surface, const float* slope, uint32_t count,
                                 double friction, const double* way, const greenloop_touch* contacts, size_t touches);

/* One sentence each; static storage. */
const char* greenloop_finer_error_text(greenloop_finer_error error);
const char* greenloop_bound_error_text(greenloop_bound_error error);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(modernize-use-using, modernize-deprecated-headers) */
#endif
