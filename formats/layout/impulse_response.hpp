#pragma once

// The sections of an impulse response model (James & Fatahalian 2003): displacement fields of a scene that was
// simulated, in a basis of few *modes*, and *orbits*, sequences of states in its coordinates, each begun by an
// *impulse*. In this order, after Info and Provenance, for q = 0 .. levels-1:
//
//   Level(q)        modes up to here, and what leaving out the rest costs
//   Shape           only q = 0: f32 [vertices][3], m: what displacements are added to
//   Triangles       only q = 0: u32 [triangles][3]
//   Quanta          only q = 0: f32 [blocks of vertices]
//   Impulses        only q = 0: ImpulseRecord [impulses]
//   Successions     only q = 0: u8 [impulses + 1][impulses]: 1 if the second may follow the first; last: at the start
//   Orbits          only q = 0: OrbitRecord [orbits]
//   References      only q = 0: ReferenceRecord [rows][impulses]
//   Modes(q, p)     for each plane p: i8 [blocks][pairs of modes of the level][48][2]
//   Amplitudes(q)   ModeRecord [modes of the level]
//   Coordinates(q)  i16 [rows][modes of the level]
//
// and behind the last level, in files that have all of them, if Info.transfer_modes > 0:
//
//   TransferQuanta      f32 [blocks][2]
//   Transfers           i8 [blocks][3 colours][8 (2 + transfer modes)][16 vertices][2]
//   TransferAmplitudes  ModeRecord [transfer modes]
//   TransferCoordinates i16 [rows][transfer modes]
//
// A *row* holds the coordinates of one state. An orbit's rows follow one another; the first is the state before its
// start, so that the velocity of every other row is a backward difference. Orbit 0 is the scene at rest.
//
// The displacement of component v of a block's 48 (16 vertices, x y z of each) is
//   u_v = quantum(block) * sum over modes m of value_vm c_m
// where value = 256 hi + lo with the modes' two planes of 8 bits, or hi where the file has one, and c_m is the
// coordinate in units of its mode's amplitude: of a row's i16 x it is x / 32767, and c times the amplitude the
// coordinate in the orthonormal basis, in m.
//
// Radiance transfer: 16 coefficients i of a vertex and a colour, times those of light their sum is the exit radiance.
//   T_i = quantum(block, 0) mean_i + quantum(block, 1) * sum over transfer modes m of value_im a_m
// where mean_i = 256 hi + lo with two planes of 8 bits, which come before the modes, and a_m, as c_m, of a row's i16.
// Pairs of values go by i, then by planes and modes.

#include <cstddef>
#include <cstdint>

#include "formats/layout/header.hpp"

namespace greenloop::layout {

inline constexpr std::uint32_t block_vertices = 16;
inline constexpr std::uint32_t block_values = 3 * block_vertices;
inline constexpr std::uint32_t most_impulses = 64;
inline constexpr std::uint32_t most_modes = 256;
inline constexpr std::uint32_t most_planes = 2;
inline constexpr std::uint32_t most_transfer_modes = 30;  ///< so that sums of all fit 32 bits
inline constexpr std::uint32_t light_coefficients = 16;   ///< of a colour
inline constexpr std::uint32_t transfer_mode_pairs = light_coefficients / 2;
inline constexpr std::uint32_t colours = 3;

/// Bytes of Transfers of a block of vertices and a colour.
constexpr std::uint64_t transfer_bytes(std::uint32_t transfer_modes) {
  return std::uint64_t{transfer_mode_pairs} * (2 + transfer_modes) * 2 * block_vertices;
}

/// The largest value of a mode by the planes of the file, and of a coordinate.
constexpr std::int32_t most_value(std::uint32_t planes) { return planes == 1 ? 127 : 256 * 127 + 127; }
inline constexpr std::int32_t most_coordinate = 32767;

struct ImpulseInfo {
  std::uint32_t problem;     ///< Problem
  std::uint32_t components;  ///< 3
  std::uint32_t levels;      ///< of the complete model
  std::uint32_t modes;       ///< of the complete model, r
  std::uint32_t vertices;
  std::uint32_t triangles;
  std::uint32_t impulses;  ///< D, 1..most_impulses
  std::uint32_t orbits;
  std::uint32_t rows;            ///< of all orbits
  std::uint32_t planes;          ///< of Modes, 1 or 2
  double time_step;              ///< s, between two rows of an orbit
  float rate;                    ///< Hz, of the loop the scene asked for
  float blend_rate;              ///< 1/s, lambda: what an orbit differs from the state it began in dies out so fast
  float velocity_balance;        ///< s, rho: a difference of velocities counts so much in the distance of two states
  float quantisation_error;      ///< of displacements of all rows with all modes, beside that of the modes left out
  float box_min[3];              ///< m, of all states
  float box_max[3];              ///< m
  float displacement;            ///< m, root mean square over rows and vertices: what relative errors are relative to
  std::uint32_t transfer_modes;  ///< since 4.8; 0: no appearance
  std::uint64_t source_rows;     ///< states that the model stands for
  // since 4.8, of radiance transfer, 0 without; errors are relative to what it differs from its mean, root mean square
  std::uint32_t transfer_states;      ///< that light was computed for
  float transfer_error;               ///< of other states, as far as measured, by all modes
  float transfer_quantisation_error;  ///< beside that
  std::uint8_t reserved[140];
};
static_assert(sizeof(ImpulseInfo) == 256 && offsetof(ImpulseInfo, problem) == offsetof(InfoStart, problem));

struct ImpulseLevel {
  std::uint32_t modes;     ///< of this level: even; the last one of the model may be empty
  std::uint32_t mode_end;  ///< of levels 0..q
  float truncation_error;  ///< of displacements of all rows, root mean square, without the modes of later levels
  float worst_error;       ///< of the worst row, over the largest root mean square of a row
  std::uint8_t reserved[48];
};
static_assert(sizeof(ImpulseLevel) == 64);

struct ImpulseRecord {
  char name[32];        ///< UTF-8, zeros behind it
  float initial[4];     ///< alpha^I, as the scene means it: of the first step
  float persistent[4];  ///< alpha^F: of all others
};
static_assert(sizeof(ImpulseRecord) == 64);

struct OrbitRecord {
  std::uint32_t first_row;   ///< the state before its start
  std::uint32_t rows;        ///< >= 2
  std::uint32_t impulse;     ///< that began it; `none` for orbit 0
  std::uint32_t next_orbit;  ///< goes on in this one behind its last row; `none`: it has come to rest there
  std::uint32_t next_row;    ///< in this row, not its orbit's first nor last
  float next_distance;       ///< m, of the two states
  std::uint32_t reserved[2];
};
static_assert(sizeof(OrbitRecord) == 32);

/// Where an impulse leads from a state: the orbit of that impulse whose start is nearest.
struct ReferenceRecord {
  std::uint32_t orbit;  ///< `none`: the impulse may not follow
  float distance;       ///< m, of the state and the orbit's start
};
static_assert(sizeof(ReferenceRecord) == 8);

struct ModeRecord {
  float amplitude;         ///< m, the coordinate that c = 1 stands for
  float truncation_error;  ///< as of ImpulseLevel, without the modes behind this one
};
static_assert(sizeof(ModeRecord) == 8);

}  // namespace greenloop::layout
