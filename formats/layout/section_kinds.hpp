#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/layout/elastostatic.hpp"
#include "formats/layout/impulse_response.hpp"
#include "formats/layout/multigrid.hpp"

// The one table of section kinds. Verifier, names, writer, transport form and report are made from it, and a test holds
// docs/format.md to it.
//
//   ROW(kind, number, name, indices, element, coding)
//     kind     enumerator of SectionKind; the verifier of the kind is verify_<kind>, its writer <kind>_bytes
//     number   SectionEntry::kind; a number once given away is never given another meaning
//     name     in text: Nodes stands as Nodes(2)
//     indices  how many of SectionEntry::a and b the kind has; the others are 0
//     element  what a section is an array of; std::byte where its length follows from what it holds
//     coding   in the transport form: bytes, words, or how a kind of its own is coded (formats/transport/packet.cpp)

/// Of every problem. Info begins with InfoStart, and Level(q) is the first section of mesh level q; the rest of both is
/// the problem's own.
#define GREENLOOP_COMMON_SECTIONS(ROW)             \
  ROW(info, 1, "Info", 0, std::byte, bytes)        \
  ROW(provenance, 2, "Provenance", 0, char, bytes) \
  ROW(level, 3, "Level", 1, std::byte, bytes)

#define GREENLOOP_ELASTOSTATIC_SECTIONS(ROW)                                    \
  ROW(nodes, 4, "Nodes", 1, NodeRecord, nodes)                                  \
  ROW(base_triangles, 5, "BaseTriangles", 0, std::uint32_t[3], words)           \
  ROW(refinement, 6, "Refinement", 1, RefinementRecord, refinement)             \
  ROW(representatives, 8, "Representatives", 2, std::uint32_t, representatives) \
  ROW(scales, 10, "Scales", 1, float, scales)                                   \
  ROW(couplings, 11, "Couplings", 2, std::byte, couplings)                      \
  ROW(stencils, 12, "Stencils", 1, StencilRecord, words)                        \
  ROW(patterns, 13, "Patterns", 1, PatternRecord, words)                        \
  ROW(predictions, 14, "Predictions", 1, std::byte, predictions)                \
  ROW(vertex_map, 15, "VertexMap", 0, VertexRecord, bytes)                      \
  ROW(loads, 19, "Loads", 0, LoadRecord, bytes)                                 \
  ROW(load_columns, 20, "LoadColumns", 1, float[3], words)

/// What follows from those before, in files that are ready: formats/write/ready_file.hpp writes it.
#define GREENLOOP_READY_SECTIONS(ROW)                       \
  ROW(read_marks, 16, "ReadMarks", 0, std::uint8_t, bytes)  \
  ROW(base_columns, 17, "BaseColumns", 0, std::byte, bytes) \
  ROW(mirrored_couplings, 18, "MirroredCouplings", 1, std::byte, bytes)

#define GREENLOOP_IMPULSE_RESPONSE_SECTIONS(ROW)                           \
  ROW(shape, 21, "Shape", 0, float[3], words)                              \
  ROW(triangles, 22, "Triangles", 0, std::uint32_t[3], words)              \
  ROW(quanta, 23, "Quanta", 0, float, words)                               \
  ROW(impulses, 24, "Impulses", 0, ImpulseRecord, bytes)                   \
  ROW(successions, 25, "Successions", 0, std::uint8_t, bytes)              \
  ROW(orbits, 26, "Orbits", 0, OrbitRecord, words)                         \
  ROW(references, 27, "References", 0, ReferenceRecord, words)             \
  ROW(modes, 28, "Modes", 2, std::int8_t, bytes)                           \
  ROW(amplitudes, 29, "Amplitudes", 1, ModeRecord, words)                  \
  ROW(coordinates, 30, "Coordinates", 1, std::int16_t, bytes)              \
  ROW(transfer_quanta, 31, "TransferQuanta", 0, float[2], words)           \
  ROW(transfers, 32, "Transfers", 0, std::int8_t, bytes)                   \
  ROW(transfer_amplitudes, 33, "TransferAmplitudes", 0, ModeRecord, words) \
  ROW(transfer_coordinates, 34, "TransferCoordinates", 0, std::int16_t, bytes)

#define GREENLOOP_MULTIGRID_SECTIONS(ROW)                                \
  ROW(points, 35, "Points", 0, float[3], words)                          \
  ROW(tetrahedra, 36, "Tetrahedra", 0, TetrahedronRecord, words)         \
  ROW(matters, 37, "Matters", 0, MatterRecord, words)                    \
  ROW(shown_points, 38, "ShownPoints", 0, float[3], words)               \
  ROW(shown_triangles, 39, "ShownTriangles", 0, std::uint32_t[3], words) \
  ROW(bindings, 40, "Bindings", 0, BindingRecord, words)                 \
  ROW(grid, 41, "Grid", 1, GridRecord, words)                            \
  ROW(row_starts, 42, "RowStarts", 1, std::uint32_t, words)              \
  ROW(row_uppers, 43, "RowUppers", 1, std::uint32_t, words)              \
  ROW(columns, 44, "Columns", 1, std::uint32_t, words)                   \
  ROW(blocks, 45, "Blocks", 1, float[12], words)                         \
  ROW(inverses, 46, "Inverses", 1, float[12], words)                     \
  ROW(parent_starts, 47, "ParentStarts", 1, std::uint32_t, words)        \
  ROW(parents, 48, "Parents", 1, std::uint32_t, words)                   \
  ROW(weights, 49, "Weights", 1, float, words)                           \
  ROW(coarsest_factor, 50, "CoarsestFactor", 0, double, bytes)

#define GREENLOOP_SECTION_KINDS(ROW)       \
  GREENLOOP_COMMON_SECTIONS(ROW)           \
  GREENLOOP_ELASTOSTATIC_SECTIONS(ROW)     \
  GREENLOOP_READY_SECTIONS(ROW)            \
  GREENLOOP_IMPULSE_RESPONSE_SECTIONS(ROW) \
  GREENLOOP_MULTIGRID_SECTIONS(ROW)

namespace greenloop::layout {

/// What a section holds. `a`, `b` of its entry: the indices of its name, else 0.
enum class SectionKind : std::uint32_t {
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) kind = (number),
  GREENLOOP_SECTION_KINDS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
};

/// What the table says of a kind.
struct SectionForm {
  SectionKind kind;
  const char* name;
  std::uint32_t indices;
  std::uint32_t element_bytes;
};
inline constexpr SectionForm section_forms[] = {
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) {SectionKind::kind, name, indices, sizeof(element)},
    GREENLOOP_SECTION_KINDS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
};

/// Bytes of an element of a section; 0 for a number that is no kind. Work: a comparison a kind.
constexpr std::uint32_t element_bytes(SectionKind kind) {
  for (const SectionForm& form : section_forms) {
    if (form.kind == kind) return form.element_bytes;
  }
  return 0;
}

/// Whether a number is a kind. Work: constant.
constexpr bool is_section_kind(std::uint32_t number) { return element_bytes(static_cast<SectionKind>(number)) != 0; }

/// Whether the kind holds what follows from others. Work: a comparison a kind.
constexpr bool is_ready_kind(SectionKind kind) {
  constexpr SectionKind ready[] = {
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) SectionKind::kind,
      GREENLOOP_READY_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
  };
  for (const SectionKind one : ready) {
    if (one == kind) return true;
  }
  return false;
}

/// Whether the kind is one of impulse response models. Work: constant.
constexpr bool is_impulse_response_kind(SectionKind kind) {
  return kind >= SectionKind::shape && kind <= SectionKind::transfer_coordinates;
}

/// Whether the kind is one of multigrid models. Work: constant.
constexpr bool is_multigrid_kind(SectionKind kind) {
  return kind >= SectionKind::points && kind <= SectionKind::coarsest_factor;
}

/// The minor version that brought the kind; those before 4.1 are not told apart.
constexpr std::uint16_t first_minor(SectionKind kind) {
  if (kind >= SectionKind::transfer_quanta && kind <= SectionKind::transfer_coordinates) return 8;
  if (is_multigrid_kind(kind)) return first_minor(Problem::multigrid);
  if (is_impulse_response_kind(kind)) return first_minor(Problem::impulse_response);
  if (kind == SectionKind::loads || kind == SectionKind::load_columns) return 6;
  return is_ready_kind(kind) ? 4 : kind == SectionKind::vertex_map ? 2 : 0;
}

/// The minor version that brought Level::cut_error.
inline constexpr std::uint16_t first_minor_of_cuts = 2;

/// The largest number of a kind.
constexpr std::uint32_t last_section_kind() {
  std::uint32_t last = 0;
  for (const SectionForm& form : section_forms) {
    const auto number = static_cast<std::uint32_t>(form.kind);
    last = number > last ? number : last;
  }
  return last;
}

}  // namespace greenloop::layout
