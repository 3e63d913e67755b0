#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/layout.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {

/// One group of modes of an impulse response model before encoding.
struct ModeGroupData {
  layout::ImpulseLevel counts{};               ///< its errors; counts of modes are filled in
  std::vector<layout::ModeRecord> amplitudes;  ///< [modes of the group], an even number
  std::vector<std::int16_t> values;            ///< [vertices][3][modes], in quanta of the vertex's block
  std::vector<std::int16_t> coordinates;       ///< [rows][modes], -32767..32767
};

/// Radiance transfer of an impulse response model before encoding, in the order of layout/impulse_response.hpp.
struct AppearanceData {
  std::uint32_t states = 0;                    ///< that light was computed for
  float error = 0;                             ///< of other states, relative to the variation
  float quantisation_error = 0;                ///< likewise, of all rows
  std::vector<float> quanta;                   ///< [blocks][2]
  std::vector<std::int8_t> transfers;          ///< [blocks][3][8 (2 + modes)][16][2]
  std::vector<layout::ModeRecord> amplitudes;  ///< [modes]; none: the model has no appearance
  std::vector<std::int16_t> coordinates;       ///< [rows][modes], -32767..32767
};

/// A whole impulse response model before encoding. Offline only.
struct ImpulseResponseData {
  layout::ImpulseInfo info{};  ///< counts are filled in
  std::string provenance;
  std::vector<float> shape;              ///< m, [vertices][3]
  std::vector<std::uint32_t> triangles;  ///< [triangles][3]
  std::vector<float> quanta;             ///< m, [blocks of 16 vertices]: see layout/impulse_response.hpp
  std::vector<layout::ImpulseRecord> impulses;
  std::vector<std::uint8_t> successions;  ///< [impulses + 1][impulses]
  std::vector<layout::OrbitRecord> orbits;
  std::vector<layout::ReferenceRecord> references;  ///< [rows][impulses]
  std::vector<ModeGroupData> groups;                ///< coarse to fine: the levels of the file
  AppearanceData appearance;
};

/// The file of such a model: deterministic, complete, checksummed, verified. ImpulseInfo::planes says whether values
/// are of 8 bits or of 16: layout::most_value. Throws std::invalid_argument naming the field that does not fit.
/// Filled in from the vectors: the counts of ImpulseInfo and ImpulseLevel, and `problem`.
[[nodiscard]] ModelFile encoded_file(const ImpulseResponseData& model);

/// The bytes of that file.
[[nodiscard]] std::vector<std::byte> encode(const ImpulseResponseData& model);

}  // namespace greenloop
