#pragma once

// The model file, `.gloop`: little-endian, read in place, every section on a 64-byte boundary with zero padding
// between.
//
//   offset 0    Header          64 bytes
//   offset 64   SectionEntry    32 bytes each, header.section_count of them, in file order
//   then        the sections    coarse to fine:
//
//     Info, Provenance                                   global facts; text (JSON) of where the model comes from
//     for q = 0 .. levels-1:
//       Level(q)                                         counts and measured errors of the model cut off after level q
//       Nodes(q)                                         NodeRecord [node_count(q)]: M(q), domain nodes first
//       BaseTriangles                                    only q = 0: u32 [3 * base_triangle_count]
//       Refinement(q)                                    only q > 0: RefinementRecord [node_count(q)]
//       Columns(q)                                       ColumnRecord [column_count(q)]: the GFs of constraint level q
//       Representatives(c, q) for c = 0..q               u32 [node_count(q)]: column of level c that stands for a node
//       Representatives(q, r) for r = 0..q-1             u32 [node_count(r)]
//       Blocks(c, q)          for c = 0..q               wavelet coefficients: columns of level c, rows of level q
//       Blocks(q, r)          for r = 0..q-1
//
// A constraint level without columns has none of Columns, Representatives and Blocks.
// So the first sections of a file, cut after any level, are again a valid and coarser model once the header says so.
// A node is named by its place in the file: coarse to fine, and within a level the *domain* (nodes whose displacement
// is stored: free and needed by the scene, closed under free parents) comes first. All other nodes do not move or are
// not read; their displacement is zero.
//
// The columns of constraint level c are displacements per unit force spread over the hat function of a vertex of that
// level (m/N): block (i, j) maps a force at column j to wavelet coefficient i. See docs/theory.md.

#include <cstddef>
#include <cstdint>

namespace greenloop::layout {

inline constexpr char magic[8] = {'G', 'R', 'E', 'E', 'N', 'L', 'P', '\n'};
inline constexpr std::uint32_t endian_tag = 0x01020304;
inline constexpr std::uint16_t version_major = 1;
inline constexpr std::uint16_t version_minor = 0;
inline constexpr std::uint64_t alignment = 64;
inline constexpr std::uint32_t max_levels = 12;
inline constexpr std::uint32_t none = 0xffffffff;  ///< no parent, no column

/// What a section holds. `a`, `b` of its entry: the indices in parentheses, else 0.
enum class SectionKind : std::uint32_t {
  info = 1,             ///< Info
  provenance = 2,       ///< UTF-8 text, no terminator
  level = 3,            ///< (q) Level
  nodes = 4,            ///< (q) NodeRecord[]
  base_triangles = 5,   ///< u32[3 * count]
  refinement = 6,       ///< (q) RefinementRecord[]
  columns = 7,          ///< (c) ColumnRecord[]
  representatives = 8,  ///< (c, q) u32[]
  blocks = 9,           ///< (c, r) BlocksHeader and its arrays
};

struct Header {
  char magic[8];
  std::uint32_t endian;
  std::uint16_t major;
  std::uint16_t minor;
  std::uint64_t file_bytes;  ///< exact length of this file, a multiple of 64
  std::uint32_t section_count;
  std::uint32_t levels;     ///< mesh levels present in this file, 1..Info::levels
  std::uint32_t table_crc;  ///< CRC32C of the section table
  std::uint8_t reserved[24];
  std::uint32_t header_crc;  ///< CRC32C of the 60 bytes before it
};
static_assert(sizeof(Header) == 64);

struct SectionEntry {
  std::uint32_t kind;
  std::uint16_t a;
  std::uint16_t b;
  std::uint64_t offset;  ///< from the start of the file, a multiple of 64
  std::uint64_t bytes;   ///< without padding
  std::uint32_t crc;     ///< CRC32C of those bytes
  std::uint32_t reserved;
};
static_assert(sizeof(SectionEntry) == 32);

enum class Problem : std::uint32_t { elastostatic = 1 };
enum class Wavelet : std::uint32_t { lifted_linear = 1 };

struct Info {
  std::uint32_t problem;       ///< Problem
  std::uint32_t wavelet;       ///< Wavelet
  std::uint32_t components;    ///< 3: displacements and forces are vectors
  std::uint32_t levels;        ///< mesh levels of the complete model, L + 1
  double young;                ///< Pa
  double poisson;              ///< -
  double epsilon;              ///< block threshold at the finest level, relative to each column's largest block
  double store_asymmetry;      ///< largest relative asymmetry of the exact compliance
  float box_min[3];            ///< m
  float box_max[3];            ///< m
  float rate;                  ///< Hz: the loop the scene asked for
  std::uint32_t max_contacts;  ///< the scene's
  std::uint64_t step_work;     ///< work units per step the scene asked for
  std::uint32_t coarsest_constraint_level;
  std::uint32_t finest_constraint_level;  ///< L; in a file cut after level q the finest one present is q
  std::uint8_t reserved[160];
};
static_assert(sizeof(Info) == 256);

/// The model cut off after this level; errors against the exact compliance, over all columns of constraint level q.
struct Level {
  std::uint32_t node_count;           ///< |M(q)|
  std::uint32_t domain_count;         ///< domain nodes of M(q): the first ones
  std::uint32_t column_count;         ///< columns of constraint level q; 0 below Info::coarsest_constraint_level
  std::uint32_t base_triangle_count;  ///< q = 0 only, else 0
  std::uint64_t kept_blocks;          ///< blocks of constraint level q, rows of every level of the complete model
  std::uint64_t dense_blocks;         ///< columns of constraint level q times domain nodes of the complete model
  float rms_error;                    ///< ||Xi^ - Xi||_F / ||Xi||_F, traction form
  float worst_column_error;           ///< max_j ||Xi^_j - Xi_j||_inf / ||Xi_j||_inf, block-wise Frobenius
  float force_error;                  ///< worst relative error of the total force of a sampled patch held at this level
  std::uint32_t reserved[5];
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

struct RefinementRecord {
  std::uint32_t parent[2];  ///< ends of the edge it halves, nodes of coarser levels
  float lift[2];            ///< lifting weights towards the parents; 0 towards parents outside the domain
};
static_assert(sizeof(RefinementRecord) == 16);

struct ColumnRecord {
  std::uint32_t node;  ///< centre of the hat, a domain node of K(c); increasing along the section
  float area;          ///< m^2, the integral of the hat of level c over the free boundary
};
static_assert(sizeof(ColumnRecord) == 8);

/// Block-sparse columns. With n = columns, m = block_count, and arrays at 64-byte multiples within the section:
///   begin  u32 [n + 1]     first block of each column
///   scale  f32 [n]         m/N per quantum, >= 0
///   index  u16|u32 [m]     row within the level's domain nodes, increasing within a column; absent if index_bytes = 0
///   value  i8|i16 [9 m]    blocks by columns: value[9 b + 3 c + r] = displacement r per force c; then >= 16 zero bytes
/// Each array starts at the first multiple of 64 after the one before it; no value is -128 (i8) or -32768 (i16).
/// index_bytes = 0: every column keeps every row (begin[j] = j * rows), index_offset = 0.
struct BlocksHeader {
  std::uint32_t columns;
  std::uint32_t rows;         ///< Level::domain_count of level r
  std::uint32_t value_bytes;  ///< 1 or 2
  std::uint32_t index_bytes;  ///< 0, 2 or 4
  std::uint64_t block_count;
  std::uint64_t begin_offset;  ///< from the start of the section, as are the others
  std::uint64_t scale_offset;
  std::uint64_t index_offset;
  std::uint64_t value_offset;
  std::uint64_t reserved;
};
static_assert(sizeof(BlocksHeader) == 64);

}  // namespace greenloop::layout
