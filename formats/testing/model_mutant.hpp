#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/testing/reseal.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {

/// One section taken out of its file.
struct SectionCopy {
  layout::SectionEntry entry{};
  std::vector<std::byte> bytes;

  [[nodiscard]] bool is(layout::SectionKind kind, std::uint32_t a = 0, std::uint32_t b = 0) const {
    return entry.kind == static_cast<std::uint32_t>(kind) && entry.a == a && entry.b == b;
  }
};

/// A model file to be broken on purpose, in aligned memory. For tests only.
class ModelMutant {
 public:
  explicit ModelMutant(const SyntheticOptions& options) : bytes_(encode(synthetic_model(options))) {}
  explicit ModelMutant(std::span<const std::byte> file) : bytes_(file) {}

  [[nodiscard]] std::span<std::byte> bytes() { return {bytes_.data(), bytes_.size()}; }
  [[nodiscard]] layout::Header& header() { return *reinterpret_cast<layout::Header*>(bytes_.data()); }
  [[nodiscard]] std::span<layout::SectionEntry> table();

  /// The place of a section in the table. Throws std::out_of_range if it is absent.
  [[nodiscard]] std::uint32_t place(layout::SectionKind kind, std::uint32_t a = 0, std::uint32_t b = 0);
  [[nodiscard]] layout::SectionEntry& entry(layout::SectionKind kind, std::uint32_t a = 0, std::uint32_t b = 0) {
    return table()[place(kind, a, b)];
  }

  /// The records of a section, or its bytes from `offset` on.
  template <class Record>
  [[nodiscard]] Record* records(layout::SectionKind kind, std::uint32_t a = 0, std::uint32_t b = 0,
                                std::uint64_t offset = 0) {
    return reinterpret_cast<Record*>(bytes_.data() + entry(kind, a, b).offset + offset);
  }

  /// Lets `edit` change the list of sections (the entries' offset, bytes and crc do not matter), then lays them out
  /// anew one after the other.
  void rebuild(const std::function<void(std::vector<SectionCopy>&)>& edit);

  /// Makes the file `size` bytes long: cut, or zeros added; the header is told.
  void resize(std::size_t size);

  /// reseal, then verify.
  [[nodiscard]] VerifyResult verdict();
  [[nodiscard]] const ModelView& view() const { return view_; }

 private:
  AlignedBytes bytes_;
  ModelView view_;
};

}  // namespace greenloop
