#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "formats/store/body_force.hpp"
#include "formats/store/green_store.hpp"
#include "formats/store/hdf5_file.hpp"

namespace greenloop {

inline constexpr int kGreenStoreVersion = 2;
inline constexpr const char* kDisplacement = "/green/displacement";
inline constexpr const char* kContentsChecksum = "contents_checksum";

/// Every dataset of a store; one that no finite elements made has no /volume.
inline constexpr std::array kGreenStoreDatasets{"/surface/position",
                                                "/surface/parents",
                                                "/surface/base_triangles",
                                                "/surface/vertex_end",
                                                "/surface/area",
                                                "/surface/flags",
                                                "/green/row_node",
                                                "/green/column_node",
                                                "/green/displacement",
                                                "/green/checksum",
                                                "/green/done",
                                                kBodyForce,
                                                kBodyForceChecksum,
                                                kBodyForceDone,
                                                "/volume/position",
                                                "/volume/tetrahedra",
                                                "/volume/fixed",
                                                "/volume/interpolation/row_start",
                                                "/volume/interpolation/column",
                                                "/volume/interpolation/weight"};

/// Throws std::invalid_argument naming the first field that contradicts another or is out of range.
void require_valid(const GreenStoreContents& contents);

/// Writes everything but /green/displacement, /green/checksum, /green/done and /body_force; see docs/store.md.
void write_contents(Hdf5File& file, const GreenStoreContents& contents);

/// The reverse, with shapes, units, finiteness and cross-references checked. How many components there are is said by
/// the shape of /green/displacement.
[[nodiscard]] GreenStoreContents read_contents(const Hdf5File& file);

/// CRC32C of all that write_contents writes, numbers as little-endian bytes in the order of docs/store.md.
[[nodiscard]] std::uint32_t checksum(const GreenStoreContents& contents);

/// Throws if the file states another checksum of these contents.
void require_checksum(const Hdf5File& file, const GreenStoreContents& contents);

/// Throws unless the dataset's attribute `unit` is `unit`.
void require_unit(const Hdf5File& file, const std::string& dataset, const std::string& unit);

}  // namespace greenloop
