#include "formats/write/writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "formats/verify.hpp"
#include "formats/verify/crc32c.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::PredictionsHeader;
using layout::SectionEntry;
using layout::SectionKind;
using Bytes = std::vector<std::byte>;

constexpr std::size_t tail_bytes = 16;

void require(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("model to be written: " + what);
}

template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> what, Values&&... values) {
  throw std::invalid_argument("model to be written: " + fmt::format(what, std::forward<Values>(values)...));
}

void require_size(const std::string& what, std::size_t size, std::size_t expected) {
  require(size == expected, fmt::format("{} has {} entries, expected {}", what, size, expected));
}

void pad(Bytes& bytes) { bytes.resize((bytes.size() + layout::alignment - 1) / layout::alignment * layout::alignment); }

void append(Bytes& bytes, std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

template <class Record>
Bytes bytes_of(const std::vector<Record>& records) {
  const auto bytes = std::as_bytes(std::span(records));
  return {bytes.begin(), bytes.end()};
}

template <class Record>
Bytes bytes_of_one(const Record& record) {
  return bytes_of(std::vector<Record>{record});
}

template <class To, class From>
Bytes narrowed(const std::vector<From>& values, const std::string& what) {
  Bytes bytes;
  bytes.reserve(values.size() * sizeof(To));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<To>(values[i]);
    if (value != values[i]) refuse("{}[{}] = {} does not fit in {} bytes", what, i, values[i], sizeof(To));
    append(bytes, std::as_bytes(std::span(&value, 1)));
  }
  return bytes;
}

// two elements a byte, the low nibble first; ten nibbles a block, the last one zero
Bytes nibbles(const std::vector<std::int16_t>& values, const std::string& what) {
  Bytes bytes(values.size() / 9 * 5);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < -7 || values[i] > 7) refuse("{}[{}] = {} does not fit in 4 bits", what, i, values[i]);
    const std::size_t element = i % 9;
    bytes[i / 9 * 5 + element / 2] |= static_cast<std::byte>((values[i] & 15) << (4 * (element % 2)));
  }
  return bytes;
}

Bytes encode_values(const std::vector<std::int16_t>& values, std::uint32_t bits, const std::string& what) {
  switch (bits) {
    case 4:
      return nibbles(values, what);
    case 8:
      return narrowed<std::int8_t>(values, what);
    default:
      return bytes_of(values);
  }
}

// a row among so many in as few bytes as hold any
std::uint32_t index_bytes_of(std::uint32_t rows) { return rows <= 65536 ? 2 : 4; }

Bytes encode_index(const std::vector<std::uint32_t>& index, std::uint32_t index_bytes, const std::string& what) {
  return index_bytes == 2 ? narrowed<std::uint16_t>(index, what) : bytes_of(index);
}

Bytes encode_predictions(const PredictionsData& data, std::uint32_t nodes, std::uint32_t rows,
                         const std::string& name) {
  PredictionsHeader header{};
  header.nodes = nodes;
  header.terms = data.terms;
  header.rows = rows;
  header.index_bytes = index_bytes_of(rows);
  Bytes bytes(sizeof(header));
  header.index_offset = bytes.size();
  append(bytes, encode_index(data.index, header.index_bytes, name + ".index"));
  pad(bytes);
  header.weight_offset = bytes.size();
  append(bytes, bytes_of(data.weight));
  bytes.resize(bytes.size() + tail_bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

struct SectionBytes {
  SectionEntry entry{};
  Bytes bytes;
};

// The sections in the order of layout.hpp.
class SectionList {
 public:
  explicit SectionList(const ModelData& model) : model_(model) {
    add(SectionKind::info, 0, 0, bytes_of_one(completed_info()));
    add(SectionKind::provenance, 0, 0, bytes_of(std::vector<char>(model.provenance.begin(), model.provenance.end())));
    for (std::uint32_t q = 0; q < levels(); ++q) add_level(q);
  }

  [[nodiscard]] std::vector<SectionBytes>& sections() { return sections_; }

 private:
  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(model_.levels.size()); }

  static SectionBytes section(SectionKind kind, std::uint32_t a, std::uint32_t b, Bytes bytes) {
    SectionEntry entry{};
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(a);
    entry.b = static_cast<std::uint16_t>(b);
    entry.bytes = bytes.size();
    entry.crc = crc32c(bytes);
    return {entry, std::move(bytes)};
  }
  void add(SectionKind kind, std::uint32_t a, std::uint32_t b, Bytes bytes) {
    sections_.push_back(section(kind, a, b, std::move(bytes)));
  }

  void add_level(std::uint32_t q) {
    const LevelData& level = model_.levels[q];
    const std::size_t place = sections_.size();
    add(SectionKind::level, q, 0, {});
    add(SectionKind::nodes, q, 0, bytes_of(level.nodes));
    if (q == 0) add(SectionKind::base_triangles, 0, 0, bytes_of(model_.base_triangles));
    if (q > 0) {
      require_size(fmt::format("levels[{}].refinement", q), level.refinement.size(), level.nodes.size());
      add(SectionKind::refinement, q, 0, bytes_of(level.refinement));
    }
    add_stencils(q);
    add_predictions(q);
    for (std::uint32_t c = 0; c <= q; ++c) add_representatives(c, q);
    for (std::uint32_t r = 0; r < q; ++r) add_representatives(q, r);
    require_size(fmt::format("levels[{}].scales", q), level.scales.size(), domain_count(q));
    add(SectionKind::scales, q, 0, bytes_of(level.scales));
    kept_blocks_ += level.scales.size();
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) add_couplings(q, layer);
    add_patterns(q);
    sections_[place] = section(SectionKind::level, q, 0, bytes_of_one(completed_counts(q)));  // now they are known
  }

  void add_stencils(std::uint32_t q) {
    const bool wanted = q > 0 && layout::is_butterfly(static_cast<layout::Wavelet>(model_.info.wavelet));
    const auto& stencils = model_.levels[q].stencils;
    require_size(fmt::format("levels[{}].stencils", q), stencils.size(), wanted ? domain_count(q) : 0);
    if (wanted) add(SectionKind::stencils, q, 0, bytes_of(stencils));
  }

  void add_predictions(std::uint32_t q) {
    const bool wanted = q > 0 && static_cast<layout::Wavelet>(model_.info.wavelet) == layout::Wavelet::equilibrated;
    const PredictionsData& data = model_.levels[q].predictions;
    const std::string name = fmt::format("levels[{}].predictions", q);
    const std::size_t terms = wanted ? std::size_t{domain_count(q)} * data.terms : 0;
    require_size(name + ".index", data.index.size(), terms);
    require_size(name + ".weight", data.weight.size(), 9 * terms);
    if (!wanted) return;
    add(SectionKind::predictions, q, 0, encode_predictions(data, domain_count(q), domain_of_mesh(q - 1), name));
  }

  void add_representatives(std::uint32_t c, std::uint32_t q) {
    const LevelData& constraint = model_.levels[c];
    if (c < model_.info.coarsest_constraint_level) {
      return require_size(fmt::format("levels[{}].representatives", c), constraint.representatives.size(), 0);
    }
    require_size(fmt::format("levels[{}].representatives", c), constraint.representatives.size(), levels());
    require_size(fmt::format("levels[{}].representatives[{}]", c, q), constraint.representatives[q].size(),
                 model_.levels[q].nodes.size());
    add(SectionKind::representatives, c, q, bytes_of(constraint.representatives[q]));
  }

  void add_patterns(std::uint32_t q) {
    const auto& patterns = model_.levels[q].patterns;
    if (q >= model_.info.coarsest_constraint_level) return add(SectionKind::patterns, q, 0, bytes_of(patterns));
    require_size(fmt::format("levels[{}].patterns", q), patterns.size(), 0);
  }

  void add_couplings(std::uint32_t q, std::uint32_t layer) {
    const CouplingsData& data = model_.levels[q].couplings[layer];
    const std::string name = section_name(SectionKind::couplings, q, layer);
    add(SectionKind::couplings, q, layer,
        encode_couplings(data, domain_count(q), domain_of_mesh(q), layout::value_bits[layer], name));
    kept_blocks_ += data.begin.back();
  }

  [[nodiscard]] std::uint32_t domain_count(std::uint32_t q) const {
    const auto& nodes = model_.levels[q].nodes;
    return static_cast<std::uint32_t>(std::count_if(
        nodes.begin(), nodes.end(), [](const auto& node) { return (node.flags & layout::node_domain) != 0; }));
  }

  // of K(q)
  [[nodiscard]] std::uint32_t domain_of_mesh(std::uint32_t q) const {
    std::uint32_t count = 0;
    for (std::uint32_t r = 0; r <= q; ++r) count += domain_count(r);
    return count;
  }

  [[nodiscard]] layout::Info completed_info() const {
    layout::Info info = model_.info;
    info.levels = levels();
    info.finest_constraint_level = levels() - 1;
    for (std::size_t k = 0; k < 3; ++k) {
      info.box_min[k] = std::numeric_limits<float>::infinity();
      info.box_max[k] = -std::numeric_limits<float>::infinity();
      for (const LevelData& level : model_.levels) {
        for (const auto& node : level.nodes) {
          info.box_min[k] = std::min(info.box_min[k], node.position[k]);
          info.box_max[k] = std::max(info.box_max[k], node.position[k]);
        }
      }
    }
    return info;
  }

  [[nodiscard]] layout::Level completed_counts(std::uint32_t q) const {
    const LevelData& level = model_.levels[q];
    require(q > 0 || model_.base_triangles.size() % 3 == 0, "base_triangles is not a list of triples");
    layout::Level counts = level.counts;
    counts.node_count = static_cast<std::uint32_t>(level.nodes.size());
    counts.domain_count = domain_count(q);
    counts.base_triangle_count = q == 0 ? static_cast<std::uint32_t>(model_.base_triangles.size() / 3) : 0;
    counts.kept_blocks = kept_blocks_;
    counts.dense_blocks = std::uint64_t{domain_of_mesh(q)} * domain_of_mesh(q);
    return counts;
  }

  const ModelData& model_;
  std::vector<SectionBytes> sections_;
  std::uint64_t kept_blocks_ = 0;  // in the sections so far
};

// header with both checksums; the table and the length must already stand in `file`
void seal(Bytes& file, std::uint32_t section_count, std::uint32_t levels, std::uint16_t minor) {
  layout::Header header{};
  std::memcpy(header.magic, layout::magic, sizeof(header.magic));
  header.endian = layout::endian_tag;
  header.major = layout::version_major;
  header.minor = minor;
  header.file_bytes = file.size();
  header.section_count = section_count;
  header.levels = levels;
  header.table_crc = crc32c(std::span(file).subspan(sizeof(header), section_count * sizeof(SectionEntry)));
  header.header_crc = crc32c(std::as_bytes(std::span(&header, 1)).first(offsetof(layout::Header, header_crc)));
  std::memcpy(file.data(), &header, sizeof(header));
}

ModelView require_valid(const AlignedBytes& file) {
  ModelView view;
  const VerifyResult result = verify(file.span(), view);
  require(result.ok(), describe(result));
  return view;
}

}  // namespace

std::vector<std::byte> encode_couplings(const CouplingsData& data, std::uint32_t columns, std::uint32_t rows,
                                        std::uint32_t value_bits, const std::string& name) {
  require_size(name + ".begin", data.begin.size(), columns + std::size_t{1});
  const std::size_t blocks = data.begin.back();
  require_size(name + ".index", data.index.size(), blocks);
  require_size(name + ".value", data.value.size(), 9 * blocks);

  CouplingsHeader header{};
  header.columns = blocks > 0 ? columns : 0;
  header.rows = rows;
  header.index_bytes = index_bytes_of(rows);
  header.block_count = blocks;

  Bytes bytes;
  bytes.reserve(sizeof(CouplingsHeader) + 4 * (columns + std::size_t{1}) + 40 * blocks);
  bytes.resize(sizeof(CouplingsHeader));
  header.begin_offset = bytes.size();
  append(bytes, std::as_bytes(std::span(data.begin).first(header.columns + std::size_t{1})));
  pad(bytes);
  header.index_offset = bytes.size();
  append(bytes, encode_index(data.index, header.index_bytes, name + ".index"));
  pad(bytes);
  header.value_offset = bytes.size();
  append(bytes, encode_values(data.value, value_bits, name + ".value"));
  bytes.resize(bytes.size() + tail_bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

std::vector<std::byte> encode(const ModelData& model) {
  require(!model.levels.empty() && model.levels.size() <= layout::max_levels,
          fmt::format("{} levels, expected 1 to {}", model.levels.size(), layout::max_levels));
  SectionList list(model);
  const auto count = static_cast<std::uint32_t>(list.sections().size());

  Bytes file(sizeof(layout::Header) + count * sizeof(SectionEntry));
  pad(file);
  for (std::uint32_t i = 0; i < count; ++i) {
    SectionBytes& section = list.sections()[i];
    section.entry.offset = file.size();
    std::memcpy(file.data() + sizeof(layout::Header) + i * sizeof(SectionEntry), &section.entry, sizeof(SectionEntry));
    append(file, section.bytes);
    pad(file);
    section.bytes = {};
  }
  seal(file, count, static_cast<std::uint32_t>(model.levels.size()), layout::version_minor);
  require_valid(AlignedBytes(file));
  return file;
}

std::vector<std::byte> truncate_to_level(std::vector<std::byte> model, std::uint32_t q) {
  const AlignedBytes whole(model);
  const ModelView view = require_valid(whole);
  require(q < view.levels, fmt::format("cut after level {}, but the file ends with level {}", q, view.levels - 1));
  require(q >= view.info->coarsest_constraint_level,
          fmt::format("cut after level {}, but the coarsest constraint level is {}; keep at least that many levels", q,
                      view.info->coarsest_constraint_level));

  std::vector<SectionEntry> table(view.header->section_count);
  std::byte* const table_bytes = model.data() + sizeof(layout::Header);
  std::memcpy(table.data(), table_bytes, table.size() * sizeof(SectionEntry));
  const auto dropped = std::find_if(table.begin(), table.end(), [&](const SectionEntry& entry) {
    return entry.kind == static_cast<std::uint32_t>(SectionKind::level) && entry.a == q + 1;
  });
  const auto kept = static_cast<std::size_t>(dropped - table.begin());
  std::fill(table_bytes + kept * sizeof(SectionEntry), table_bytes + table.size() * sizeof(SectionEntry), std::byte{0});
  model.resize(static_cast<std::size_t>(table[kept - 1].offset + table[kept - 1].bytes));
  pad(model);
  seal(model, static_cast<std::uint32_t>(kept), q + 1, view.header->minor);
  require_valid(AlignedBytes(model));
  return model;
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream file(part, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  const int reason = errno;
  std::error_code error;
  if (file) {
    std::filesystem::rename(part, path, error);
    if (!error) return;
  } else {
    error.assign(reason, std::generic_category());
  }
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  throw std::runtime_error(path.string() + ": cannot be written: " + error.message());
}

}  // namespace greenloop
