#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/layout.hpp"
#include "formats/transport/adaptive_integer.hpp"
#include "formats/transport/couplings_model.hpp"
#include "formats/transport/predictions_model.hpp"
#include "formats/transport/range_coder.hpp"
#include "formats/transport/section_models.hpp"
#include "formats/view.hpp"
#include "formats/write/section_file.hpp"

namespace greenloop::transport {

/// Where in a model file the sections of a packet lie.
struct FileExtent {
  std::uint64_t begin = 0;  ///< end of the packet before
  std::uint64_t end = 0;    ///< first multiple of 64 at or after the last section
};

/// The sections of one level after the other, through a coder: the same calls write and read. Remembers what it has
/// seen.
class PacketModel {
 public:
  /// Codes the sections of level q. An encoder passes the sections and `model`, the view they were taken from; a
  /// decoder passes none and null, and gets them. Throws DamagedPacket if they do not fill `extent` exactly. Memory:
  /// that of the extent. Work: linear in the bytes; columns times rows for couplings.
  void code(BitCoder& coder, std::uint32_t q, FileExtent extent, std::vector<SectionBytes>& sections,
            const ModelView* model);

 private:
  void code_table(BitCoder& coder, FileExtent extent, std::vector<SectionBytes>& sections);
  // whether the section is one of level q that is coded by what it means, and not byte by byte
  bool code_records(BitCoder& coder, std::uint32_t q, SectionBytes& section);
  void code_predictions(BitCoder& coder, std::span<std::byte> bytes);
  void code_couplings(BitCoder& coder, std::uint32_t q, std::span<SectionBytes*> layers, const ModelView* model);

  std::uint32_t components_ = 3;  // of the model, once its Info is known
  AdaptiveInteger table_{8};
  ByteModel bytes_;
  MeshModel mesh_;
  PredictionsModel predictions_;
  CouplingsModel couplings_;
};

/// Checksum of what a packet decodes to: of the table's entries, then of the sections' bytes.
[[nodiscard]] std::uint32_t content_crc(std::span<const SectionBytes> sections);

}  // namespace greenloop::transport
