#pragma once

// The transport form of a model file, `.gloopz`: the same model entropy-coded, coarse to fine. Little-endian.
//
//   StreamHeader     64 bytes
//   then for every mesh level of the model, from 0:
//     PacketHeader   32 bytes
//     coded bytes    PacketHeader::coded_bytes of them
//
// The packets of levels 0 .. q alone give the model cut off after level q. What the coded bytes mean is said in
// docs/format.md and, exactly, by the code in this folder.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace greenloop::transport {

inline constexpr char magic[8] = {'G', 'R', 'E', 'E', 'N', 'L', 'Z', '\n'};
inline constexpr std::uint16_t version_major = 2;

/// A packet decodes to at most this many bytes for each of its own.
inline constexpr std::uint64_t most_expansion = 256;

struct StreamHeader {
  char magic[8];
  std::uint16_t major;        ///< version of this form
  std::uint16_t model_major;  ///< of the model file
  std::uint16_t model_minor;
  std::uint16_t levels;             ///< packets, 1 .. 12
  std::uint64_t model_bytes;        ///< length of the complete model file
  std::uint8_t model_reserved[24];  ///< of its header
  std::uint32_t reserved[3];        ///< 0
  std::uint32_t header_crc;         ///< CRC32C of the 60 bytes before it
};
static_assert(sizeof(StreamHeader) == 64);

struct PacketHeader {
  std::uint32_t level;
  std::uint32_t coded_crc;  ///< CRC32C of the coded bytes
  std::uint64_t coded_bytes;
  std::uint64_t content_bytes;  ///< of the model file from the end of the packet before to the end of this one
  std::uint32_t content_crc;    ///< CRC32C of the packet's entries of the section table, then of its sections
  std::uint32_t header_crc;     ///< CRC32C of the 28 bytes before it
};
static_assert(sizeof(PacketHeader) == 32);

/// Why a stream was refused, or did not give all of its model.
enum class StreamRule : std::uint8_t {
  ok,
  truncated,  ///< it ends too early; the levels before are whole
  bad_magic,
  unsupported_version,
  header_checksum,
  packet_checksum,
  out_of_range,
  damaged,           ///< the coded bytes do not decode
  content_checksum,  ///< or to something else
  trailing_bytes,
  not_a_model,
};

/// The verdict of unpack.
struct StreamResult {
  StreamRule rule = StreamRule::ok;
  std::uint32_t packet = 0;  ///< at fault; meaningless for the stream's header
  std::uint64_t offset = 0;  ///< in the stream, of the field or of the coded bytes
  const char* field = "";    ///< static storage
  std::uint64_t value = 0;   ///< what stands there
  std::uint64_t limit = 0;   ///< what was expected or allowed
  std::string reason;        ///< of damaged and not_a_model: what was found

  [[nodiscard]] bool ok() const { return rule == StreamRule::ok; }
};

/// What a stream gave.
struct UnpackedModel {
  std::vector<std::byte> model;     ///< a whole, verified model file; empty if there is none
  std::uint32_t levels = 0;         ///< mesh levels in it
  std::uint32_t stream_levels = 0;  ///< of the model that was packed; 0 if the stream's header is not right
};

inline constexpr std::uint32_t all_levels = 0xffffffff;

/// The transport form of a whole model file, without what plain_file leaves out. Throws std::invalid_argument if
/// `model` is not a valid model. Deterministic. Memory: some times the model. Work: a microsecond or so for a value.
/// Offline only.
[[nodiscard]] std::vector<std::byte> pack(std::span<const std::byte> model);

/// The model of the first `levels` mesh levels of a stream, or of all; what follows them is not looked at. The very
/// bytes that were packed, ready sections left out, or those that truncate_to_level makes of them. If the stream ends
/// early, the result says so and `unpacked` holds the model of the whole packets there are; after any other fault it is
/// empty. Memory and work are bounded by the length of the stream whatever its bytes. Offline only.
[[nodiscard]] StreamResult unpack(std::span<const std::byte> stream, UnpackedModel& unpacked,
                                  std::uint32_t levels = all_levels);

/// "packet_checksum": the rule's name as in StreamRule.
[[nodiscard]] const char* rule_name(StreamRule rule);

/// One sentence for people: packet, field, offset, value and limit of the fault, and how to mend it.
[[nodiscard]] std::string describe(const StreamResult& result);

}  // namespace greenloop::transport
