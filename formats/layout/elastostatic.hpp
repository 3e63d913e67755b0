#pragma once

// The sections of an elastostatic model, and of a scalar one, which has the very same with blocks of 1x1 instead of
// 3x3: N = Info::components is what a node has of numbers. What is said here of displacements and forces, in m and N,
// holds for a scalar problem's quantity and its source in their units. In this order, after Info and Provenance, for q
// = 0 .. levels-1:
//
//   Level(q)                                         counts and measured errors of the model cut off after level q
//   Nodes(q)                                         NodeRecord [node_count(q)]: M(q), domain nodes first
//   BaseTriangles                                    only q = 0: u32 [3 * base_triangle_count]
//   Loads                                            only q = 0, if Info::loads > 0: LoadRecord [Info::loads]
//   Refinement(q)                                    only q > 0: RefinementRecord [node_count(q)]
//   Stencils(q)                                      only q > 0, Butterfly: StencilRecord [domain_count(q)]
//   Predictions(q)                                   only q > 0, Equilibrated: PredictionsHeader and its arrays
//   Representatives(c, q) for c = first..q           u32 [node_count(q)]: node of K(c) that stands for a node
//   Representatives(q, r) for r = 0..q-1             u32 [node_count(r)]
//   Scales(q)                                        Scale<N> [domain_count(q)]
//   Couplings(q, layer) for each layer               CouplingsHeader and its arrays
//   Patterns(q) if q >= first                        PatternRecord[], by kind, then contacts; none: not measured
//   LoadColumns(q)                                   if Info::loads > 0: f32 [Info::loads][domain_count(q)][3]
//
// and after the last level of a complete model, if the scene asked for it
//
//   VertexMap                                        VertexRecord[]: where the author's vertices lie
//
// and, if the file is ready, what follows from the sections of the levels and a loop would make at its start
//
//   ReadMarks                                        u8 [domain nodes]
//   BaseColumns                                      BaseColumnsHeader and its values
//   MirroredCouplings(layer) for each layer          CouplingsHeader and its arrays
//
// `first` is Info::coarsest_constraint_level; levels below it have no Representatives and no Patterns. A touchable node
// is represented on constraint level c by a domain node of K(c), by itself if it is one; any other node by `none`.
// A node is named by its place in the file: coarse to fine, and within a level the *domain* (nodes whose displacement
// is stored: free and needed by the scene, closed under free parents) comes first. All other nodes do not move or are
// not read; their displacement is zero.
//
// The compliance U of the domain nodes (m/N) in two-sided wavelet coordinates, W U W^T with the forward transform
//   W = T_1 ... T_L      (T_l: predict, then lift, on K(l))
// that turns nodal displacements into averages on level 0 and details on M(1) .. M(L): one coefficient a domain node,
// numbered alike. A coefficient i has a scale, the symmetric root R_i of its conditional compliance (what is left of
// its diagonal block once the coefficients of its level are held); what is stored of the block (i, j), i < j, is R_i^-1
// (W U W^T)_ij R_j^-1 in whole quanta, and nothing where it is small. The scaled diagonal blocks stand beside the
// scales. See docs/theory.md and docs/compression.md.

#include <cstddef>
#include <cstdint>

#include "formats/layout/header.hpp"

namespace greenloop::layout {

/// Couplings are stored in layers by size. The first, of a coarser quantum, is for what is too large for the second;
/// what is left of it stands in another. A file has every section, even an empty one.
inline constexpr std::uint32_t layers = 4;
inline constexpr std::uint32_t value_bits[layers] = {16, 16, 8, 4};  ///< of one element of a block

/// Bytes of a stored block between nodes of so many components, with so many bits an element: the last half byte is 0.
constexpr std::uint64_t block_bytes(std::uint32_t components, std::uint32_t bits) {
  return (std::uint64_t{components} * components * bits + 7) / 8;
}

/// Bytes of zero behind the blocks of a section: a wide load of the last block stays inside it.
inline constexpr std::uint64_t tail_bytes = 16;

enum class Wavelet : std::uint32_t {
  lifted_linear = 1,
  linear = 2,
  lifted_butterfly = 3,
  butterfly = 4,
  equilibrated = 5,
};
inline constexpr Wavelet wavelets[] = {Wavelet::lifted_linear, Wavelet::linear, Wavelet::lifted_butterfly,
                                       Wavelet::butterfly, Wavelet::equilibrated};

constexpr bool is_lifted(Wavelet wavelet) {
  return wavelet == Wavelet::lifted_linear || wavelet == Wavelet::lifted_butterfly;
}
constexpr bool is_butterfly(Wavelet wavelet) {
  return wavelet == Wavelet::lifted_butterfly || wavelet == Wavelet::butterfly;
}

struct Info {
  std::uint32_t problem;       ///< Problem
  std::uint32_t wavelet;       ///< Wavelet
  std::uint32_t components;    ///< N = components_of(problem)
  std::uint32_t levels;        ///< mesh levels of the complete model, L + 1
  double young;                ///< Pa; 0 in a scalar model
  double poisson;              ///< -; 0 in a scalar model
  double threshold;            ///< scaled blocks below this Frobenius norm over root N were dropped
  double store_asymmetry;      ///< largest relative asymmetry of the exact compliance
  double lambda_min;           ///< m/N: certified below the least eigenvalue of U; 0: no certificate
  float box_min[3];            ///< m
  float box_max[3];            ///< m
  float rate;                  ///< Hz: the loop the scene asked for
  std::uint32_t max_contacts;  ///< the scene's
  std::uint64_t step_work;     ///< work units per step the scene asked for
  std::uint32_t coarsest_constraint_level;
  std::uint32_t finest_constraint_level;  ///< L; in a file cut after level q the finest one present is q
  float quantum[layers];                  ///< of the scaled values of each layer of couplings, in [0, 1]
  float share;                            ///< of the loop's period that a step may take, 0..1; 0: the scene has none
  std::uint32_t loads;                    ///< records of Loads, columns of LoadColumns; 0: neither section is there
  std::uint8_t reserved[128];
};
static_assert(sizeof(Info) == 256 && offsetof(Info, problem) == offsetof(InfoStart, problem));

/// The minor version that brought what an Info says.
constexpr std::uint16_t first_minor(const Info& info) {
  return info.loads != 0 ? 6 : info.share != 0 ? 5 : first_minor(static_cast<Problem>(info.problem));
}

// Forces and fields are of one compliance, that of all couplings: u = W^-1 (W U W^T) T^-T f for forces f on constraint
// level c.

/// Contacts that a model may ask for: no more than this, and for each pair of one of them (of as many as the domain
/// has) and a domain node the file has a quarter of a byte. What a body of `max_contacts` takes is so bounded by the
/// length of its file; up to 128 contacts are never refused.
inline constexpr std::uint32_t most_contacts = 4096;
inline constexpr std::uint64_t contact_pairs_per_byte = 4;

/// The model cut off after this level: the compliance between the averages of level q, which are the forces and the
/// displacements of constraint level q. Errors against the exact one, all relative.
struct Level {
  std::uint32_t node_count;           ///< |M(q)|
  std::uint32_t domain_count;         ///< domain nodes of M(q): the first ones
  std::uint32_t base_triangle_count;  ///< q = 0 only, else 0
  float cut_error;             ///< field_error at coarsest_constraint_level without the details of levels after q
  std::uint64_t kept_blocks;   ///< NxN blocks stored in levels 0..q: scales and couplings
  std::uint64_t dense_blocks;  ///< domain nodes of K(q), squared
  float rms_error;             ///< ||U^ - U||_F / ||U||_F
  float worst_column_error;    ///< max_j ||U^_j - U_j||_inf / ||U_j||_inf, block-wise Frobenius
  float patch_force_error;     ///< worst ||f^ - f|| / ||f|| of sampled 64-node patches displaced along x, y or z
  float field_rms_error;       ///< rms_error at nodes with node_read
  float field_column_error;    ///< worst_column_error, errors at nodes with node_read
  // of contacts resolved at this level, against the exact solution at the finest level: the worst of the patterns of
  // at most 64 contacts that are not is_rough; 0 if none was measured
  float field_error;  ///< ||u^ - u|| / ||u||
  float field_peak;   ///< largest error of a node over the largest displacement
  float force_error;  ///< ||f^ - f|| / ||f||
};
static_assert(sizeof(Level) == 64);

enum NodeFlag : std::uint32_t {
  node_domain = 1,     ///< its displacement is stored
  node_touchable = 2,  ///< may be a contact
  node_fixed = 4,      ///< held in place
  node_read = 8,       ///< the scene asked for its displacement
};

struct NodeRecord {
  float position[3];  ///< m, undeformed
  float area;         ///< m^2, the integral of its hat function on the finest level
  std::uint32_t flags;
};
static_assert(sizeof(NodeRecord) == 20);

/// Where a vertex of the author's surface lies on the model's: the nearest point of its finest level.
struct VertexRecord {
  std::uint32_t node[3];  ///< corners of a triangle
  float weight[3];        ///< of each, 0..1 with sum 1
};
static_assert(sizeof(VertexRecord) == 24);

struct RefinementRecord {
  std::uint32_t parent[2];  ///< ends of the edge it halves, nodes of coarser levels
  float lift[2];            ///< lifting weights towards the parents; 0 towards those outside the domain; 0 if unlifted
};
static_assert(sizeof(RefinementRecord) == 16);

/// What the Butterfly scheme predicts a node from besides the two ends of its edge, which weigh 1/2 each: nodes of
/// coarser levels in the domain or fixed; all `none`: from the two ends alone. Nodes may occur twice: weights add.
struct StencilRecord {
  std::uint32_t wing[2];   ///< weight 1/8: the third corners of the two triangles at the edge
  std::uint32_t outer[4];  ///< weight -1/16: across the sides of those triangles, two of each triangle
};
static_assert(sizeof(StencilRecord) == 24);

inline constexpr float wing_weight = 0.125F, outer_weight = -0.0625F;

/// Predictions with NxN weights: x_m = d_m + sum over k of P_mk x_k, for the domain nodes m of M(q), from as many
/// domain nodes k of K(q-1) each. Arrays at 64-byte multiples in the section, with n = nodes:
///   index   u16|u32 [n * terms]   the nodes k, by their place among all domain nodes; weights of the same node add
///   weight  i16 [N N n * terms]   P_mk in units of prediction_unit, then >= 16 zero bytes; element N c + r of a block:
///                                 displacement r of m per displacement c of k; the most negative value does not occur
struct PredictionsHeader {
  std::uint32_t nodes;         ///< domain nodes of M(q)
  std::uint32_t terms;         ///< 0..most_prediction_terms; the same for every node
  std::uint32_t rows;          ///< domain nodes of K(q-1)
  std::uint32_t index_bytes;   ///< 2 or 4
  std::uint64_t index_offset;  ///< from the start of the section
  std::uint64_t weight_offset;
  std::uint32_t reserved[8];
};
static_assert(sizeof(PredictionsHeader) == 64);

inline constexpr std::uint32_t most_prediction_terms = 8;
inline constexpr float prediction_unit = 0x1p-12F;

/// Where the arrays of a Predictions section stand, in bytes from its start. No overflow if there are at most
/// most_prediction_terms.
struct PredictionsExtent {
  std::uint64_t index, index_end, weight, weight_end;

  constexpr PredictionsExtent(const PredictionsHeader& header, std::uint32_t components) : index(sizeof(header)) {
    const std::uint64_t blocks = std::uint64_t{header.nodes} * header.terms;
    index_end = index + blocks * header.index_bytes;
    weight = aligned(index_end);
    weight_end = weight + blocks * block_bytes(components, 16);
  }
};

/// What people do to a body: contacts that a model's answers are measured on.
enum class PatternKind : std::uint32_t {
  node = 1,         ///< a single node displaced along x, y or z
  patch = 2,        ///< the nodes nearest to one, displaced as a whole along x, y or z
  sphere = 3,       ///< a rigid sphere pushed in along the inward normal; contacts that only push
  turned = 4,       ///< a patch turned by 5 degrees about its normal or a tangent, through its centre
  gathered = 5,     ///< a patch squeezed tangentially by 5 % towards its centre
  pinch = 6,        ///< two fingers on opposite sides of a thin part, pressed towards each other
  opposed = 7,      ///< two distant patches moved oppositely
  alternating = 8,  ///< neighbours displaced along plus and minus the normal
  random = 9,       ///< every node of a patch displaced at random
};
inline constexpr std::uint32_t pattern_kinds = 9;
inline constexpr std::uint32_t most_pattern_contacts = 256;

/// Whether neighbours are displaced differently, as no tool does: their forces nearly cancel, and so does the field
/// beyond them, which the errors are relative to.
constexpr bool is_rough(PatternKind kind) { return kind == PatternKind::alternating || kind == PatternKind::random; }

/// Whether groups of contacts are pushed as a whole, so that their total forces say something.
constexpr bool has_total_force(PatternKind kind) {
  return kind == PatternKind::node || kind == PatternKind::patch || kind == PatternKind::sphere ||
         kind == PatternKind::pinch || kind == PatternKind::opposed;
}

/// Fewest contacts of a pattern of this kind.
constexpr std::uint32_t least_contacts(PatternKind kind) {
  return kind == PatternKind::node || kind == PatternKind::sphere ? 1 : 2;
}

/// Relative errors of the complete model's answers at constraint level q to all patterns of one kind and size: median,
/// 95th percentile and worst, against the exact answer of the finest level to the same contacts.
struct PatternRecord {
  std::uint32_t kind;      ///< PatternKind
  std::uint32_t contacts;  ///< nodes, at most (a sphere only holds those it pushes)
  std::uint32_t samples;   ///< sites times displacements
  std::uint32_t reserved;
  float field_error[3];  ///< ||u^ - u|| / ||u||, nodes weighted by area; u^ - u: at nodes with node_read
  float field_peak[3];   ///< largest |u^_i - u_i| of nodes with node_read over the largest |u_i| of any node
  float force_error[3];  ///< ||f^ - f|| / ||f|| of the nodal forces
  float
      total_force_error[3];  ///< sum_g |F^_g - F_g| / sum_g |F_g| of the groups' total forces; has_total_force, else 0
};
static_assert(sizeof(PatternRecord) == 64);

/// The scale of a coefficient of N components: two symmetric positive definite matrices, by rows from the diagonal on:
/// xx, xy, xz, yy, yz, zz.
template <unsigned N>
struct Scale {
  float root[N * (N + 1) / 2];      ///< R; (m/N)^(1/2)
  float diagonal[N * (N + 1) / 2];  ///< R^-1 (W U W^T)_ii R^-1
};
static_assert(sizeof(Scale<3>) == 48 && sizeof(Scale<1>) == 8);

/// What a load of a model is, and its unit.
enum class LoadKind : std::uint32_t {
  acceleration_x = 1,  ///< of the whole body: each of its parts is pulled by its mass times so many m/s^2 along x
  acceleration_y = 2,
  acceleration_z = 3,
  pressure = 4,  ///< Pa on a part of the surface, in the directions that the scene chose
};
inline constexpr std::uint32_t load_kinds = 4;
inline constexpr std::uint32_t accelerations = 3;  ///< stand first and in this order, or are absent
inline constexpr std::uint32_t most_loads = 64;

/// A load whose displacements the model holds. LoadColumns(q) say of each load and each coefficient of M(q) the
/// wavelet coefficient of the displacement (m) under one unit of the load.
struct LoadRecord {
  std::uint32_t kind;  ///< LoadKind
  float resultant[3];  ///< N a unit: the sum of its forces; of an acceleration the body's mass (kg) along it
  char name[48];       ///< of a pressure: printable ASCII, none twice, zeros behind; of an acceleration all zeros
};
static_assert(sizeof(LoadRecord) == 64);

/// Sparse NxN blocks by columns. With n = columns, m = block_count, and arrays at 64-byte multiples in the section:
///   begin  u32 [n + 1]     first block of each column
///   index  u16|u32 [m]     row, increasing within a column
///   value  [m]             blocks, then >= 16 zero bytes; element k = N c + r of a block: scaled displacement r of the
///                          row per scaled force c of the column, in quanta of the layer
///            4 bits        element k is nibble k, low nibble first, -7..7; the nibble behind the last is 0
///            8 bits        an i8 an element
///            16 bits       an i16 an element; the most negative value does not occur, nor in 8 bits
/// Columns are the coefficients of the level, by their place among the domain nodes of M(q); rows are coefficients that
/// lie before the column's, by their place among all domain nodes: the block of the other half is the transpose. Every
/// array starts at the first multiple of 64 after the one before it. A section without blocks has no columns.
struct CouplingsHeader {
  std::uint32_t columns;
  std::uint32_t rows;         ///< domain nodes of K(q)
  std::uint32_t index_bytes;  ///< 2 or 4
  std::uint32_t reserved0;
  std::uint64_t block_count;
  std::uint64_t begin_offset;  ///< from the start of the section, as are the others
  std::uint64_t index_offset;
  std::uint64_t value_offset;
  std::uint32_t reserved[4];
};
static_assert(sizeof(CouplingsHeader) == 64);

/// Coefficients side by side in a tile of base columns.
inline constexpr std::uint32_t tile_width = 8;

/// The blocks of level 0's rows, transposed, as columns of tiles without indices; docs/format.md says when there are
/// any. The values follow: [columns][tiles][N N][tile_width] i8.
struct BaseColumnsHeader {
  std::uint32_t columns;     ///< domain nodes of K(0), or 0
  std::uint32_t tiles;       ///< of a column: domain nodes / tile_width, up to a whole tile; or 0
  std::uint32_t layer_mask;  ///< bit l: layer l of the couplings is held here; or 0
  std::uint32_t reserved[13];
};
static_assert(sizeof(BaseColumnsHeader) == 64);

}  // namespace greenloop::layout
