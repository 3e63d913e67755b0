#pragma once

// What every model file has, `.gloop`: little-endian, read in place, every section on a 64-byte boundary with zero
// padding between.
//
//   offset 0    Header          64 bytes
//   offset 64   SectionEntry    32 bytes each, header.section_count of them, in file order
//   then        the sections    coarse to fine:
//
//     Info, Provenance               facts of the problem's own; text (JSON) of where the model comes from
//     for q = 0 .. levels-1:
//       Level(q) and what is of it   in the form and order of the problem: elastostatic.hpp
//     what is of no level            in the order of the problem
//
// So the first sections of a file, cut after any level, are again a valid and coarser model once the header says so.

#include <cstddef>
#include <cstdint>

namespace greenloop::layout {

inline constexpr char magic[8] = {'G', 'R', 'E', 'E', 'N', 'L', 'P', '\n'};
inline constexpr std::uint32_t endian_tag = 0x01020304;
inline constexpr std::uint16_t version_major = 4;
inline constexpr std::uint16_t version_minor = 9;
inline constexpr std::uint64_t alignment = 64;
inline constexpr std::uint32_t max_levels = 12;
inline constexpr std::uint32_t none = 0xffffffff;  ///< no node

/// The first multiple of the alignment at or after an offset.
constexpr std::uint64_t aligned(std::uint64_t offset) { return (offset + alignment - 1) / alignment * alignment; }

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

/// What a model answers. A reader refuses a problem that it does not know.
enum class Problem : std::uint32_t {
  elastostatic = 1,
  scalar = 2,            ///< a quantity of one number a node, as a temperature or a potential
  impulse_response = 3,  ///< motions of a scene that was simulated, played and blended
  multigrid = 4,         ///< an elastic body that is simulated in the loop
};

/// The minor version that brought a problem.
constexpr std::uint16_t first_minor(Problem problem) {
  if (problem == Problem::multigrid) return 9;
  return problem == Problem::impulse_response ? 7 : problem == Problem::scalar ? 3 : 0;
}

/// How many problems, numbered from 1, a minor version has.
constexpr std::uint32_t problems_of(std::uint16_t minor) {
  if (minor < first_minor(Problem::scalar)) return 1;
  if (minor < first_minor(Problem::impulse_response)) return 2;
  return minor < first_minor(Problem::multigrid) ? 3 : 4;
}

/// Numbers at a node, N: a load and what it causes there are vectors of so many.
constexpr std::uint32_t components_of(Problem problem) { return problem == Problem::scalar ? 1 : 3; }

/// How Info begins, whatever the problem; the rest is the problem's own.
struct InfoStart {
  std::uint32_t problem;  ///< Problem
};
static_assert(sizeof(InfoStart) == 4);

}  // namespace greenloop::layout
