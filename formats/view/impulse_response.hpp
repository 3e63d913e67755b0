#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/layout/impulse_response.hpp"

namespace greenloop {

/// One group of modes, in place.
struct ModeGroupView {
  const layout::ImpulseLevel* counts = nullptr;
  const std::int8_t* plane[layout::most_planes] = {};  ///< [blocks][modes / 2][48][2]; null: the file has it not
  const layout::ModeRecord* amplitudes = nullptr;      ///< [modes]
  const std::int16_t* coordinates = nullptr;           ///< [rows][modes]
};

/// Radiance transfer of all vertices and rows, in place.
struct AppearanceView {
  std::uint32_t modes = 0;                         ///< 0: the file has none
  const float* quanta = nullptr;                   ///< [blocks][2]
  const std::int8_t* transfers = nullptr;          ///< [blocks][3][8 (2 + modes)][16][2]
  const layout::ModeRecord* amplitudes = nullptr;  ///< [modes]
  const std::int16_t* coordinates = nullptr;       ///< [rows][modes]
};

/// An impulse response model, in place.
struct ImpulseResponseView {
  const layout::ImpulseInfo* info = nullptr;
  std::uint32_t levels = 0;  ///< present
  std::uint32_t modes = 0;   ///< of the levels present
  const float* shape = nullptr;
  const std::uint32_t* triangles = nullptr;
  const float* quanta = nullptr;
  std::span<const layout::ImpulseRecord> impulses;
  const std::uint8_t* successions = nullptr;
  std::span<const layout::OrbitRecord> orbits;
  const layout::ReferenceRecord* references = nullptr;  ///< [rows][impulses]
  ModeGroupView group[layout::max_levels];
  AppearanceView appearance;

  /// Blocks of 16 vertices.
  [[nodiscard]] std::uint32_t blocks() const noexcept {
    return (info->vertices + layout::block_vertices - 1) / layout::block_vertices;
  }
};

}  // namespace greenloop
