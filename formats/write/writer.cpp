#include "formats/write/writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "formats/layout/elastostatic_order.hpp"
#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/section_file.hpp"

namespace greenloop {
namespace {

using layout::CouplingsHeader;
using layout::PredictionsHeader;
using layout::SectionEntry;
using layout::SectionKind;
using Bytes = std::vector<std::byte>;

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

// two elements a byte, the low nibble first; the nibble behind a block's last element is zero
Bytes nibbles(const std::vector<std::int16_t>& values, std::uint32_t components, const std::string& what) {
  const std::size_t elements = std::size_t{components} * components;
  const std::size_t block_bytes = layout::block_bytes(components, 4);
  Bytes bytes(values.size() / elements * block_bytes);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < -7 || values[i] > 7) refuse("{}[{}] = {} does not fit in 4 bits", what, i, values[i]);
    const std::size_t element = i % elements;
    bytes[i / elements * block_bytes + element / 2] |= static_cast<std::byte>((values[i] & 15) << (4 * (element % 2)));
  }
  return bytes;
}

Bytes encode_values(const std::vector<std::int16_t>& values, const CouplingsForm& form, const std::string& what) {
  switch (form.value_bits) {
    case 4:
      return nibbles(values, form.components, what);
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
  pad_to_alignment(bytes);
  header.weight_offset = bytes.size();
  append(bytes, bytes_of(data.weight));
  bytes.resize(bytes.size() + layout::tail_bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

// The sections of a model in the order of layout/elastostatic_order.hpp.
class SectionList {
 public:
  explicit SectionList(const ModelData& model) : model_(model), info_(completed_info()) {
    add(SectionKind::info, 0, 0, bytes_of_one(info_));
    add(SectionKind::provenance, 0, 0, bytes_of(std::vector<char>(model.provenance.begin(), model.provenance.end())));
    for (std::uint32_t q = 0; q < levels(); ++q) add_level(q);
    if (!model.vertices.empty()) add(SectionKind::vertex_map, 0, 0, vertex_map_bytes(0, 0));
  }

  [[nodiscard]] std::vector<SectionBytes> take() && { return std::move(sections_); }

 private:
  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(model_.levels.size()); }
  [[nodiscard]] std::uint32_t components() const { return model_.info.components; }

  void add(SectionKind kind, std::uint32_t a, std::uint32_t b, Bytes bytes) {
    SectionEntry entry{};
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(a);
    entry.b = static_cast<std::uint16_t>(b);
    sections_.push_back({entry, std::move(bytes)});
  }

  void add_level(std::uint32_t q) {
    check_sizes(q);
    const std::size_t place = sections_.size();
    layout::visit_elastostatic_level(info_, q, [&](SectionKind kind, std::uint32_t a, std::uint32_t b) {
      add(kind, a, b, section_bytes(kind, a, b));
      return true;
    });
    sections_[place].bytes = bytes_of_one(completed_counts(q));  // now they are known
  }

  void check_sizes(std::uint32_t q) const {
    const LevelData& level = model_.levels[q];
    const auto check = [q](const std::string& field, std::size_t size, std::size_t expected) {
      require_size(fmt::format("levels[{}].{}", q, field), size, expected);
    };
    const auto wavelet = static_cast<layout::Wavelet>(model_.info.wavelet);
    const bool constrained = q >= model_.info.coarsest_constraint_level;
    const bool predicted = q > 0 && wavelet == layout::Wavelet::equilibrated;
    const std::size_t terms = predicted ? std::size_t{domain_count(q)} * level.predictions.terms : 0;
    if (q > 0) check("refinement", level.refinement.size(), level.nodes.size());
    check("stencils", level.stencils.size(), q > 0 && layout::is_butterfly(wavelet) ? domain_count(q) : 0);
    check("predictions.index", level.predictions.index.size(), terms);
    check("predictions.weight", level.predictions.weight.size(), std::size_t{components()} * components() * terms);
    check("representatives", level.representatives.size(), constrained ? levels() : 0);
    for (std::size_t r = 0; r < level.representatives.size(); ++r) {
      check(fmt::format("representatives[{}]", r), level.representatives[r].size(), model_.levels[r].nodes.size());
    }
    check("scales", level.scales.numbers.size(), std::size_t{components()} * (components() + 1) * domain_count(q));
    if (!constrained) check("patterns", level.patterns.size(), 0);
    check("load_columns", level.load_columns.size(), 3 * model_.loads.size() * domain_count(q));
  }

  // a, b: the indices of the section's name
  Bytes section_bytes(SectionKind kind, std::uint32_t a, std::uint32_t b) {
    switch (kind) {
#define GREENLOOP_ROW(kind, number, name, indices, element, coding) \
  case SectionKind::kind:                                           \
    return kind##_bytes(a, b);
      GREENLOOP_ELASTOSTATIC_SECTIONS(GREENLOOP_ROW)
#undef GREENLOOP_ROW
      default:
        return {};  // Level(q), which counts what follows it
    }
  }

  Bytes nodes_bytes(std::uint32_t q, std::uint32_t) { return bytes_of(model_.levels[q].nodes); }
  Bytes base_triangles_bytes(std::uint32_t, std::uint32_t) { return bytes_of(model_.base_triangles); }
  Bytes refinement_bytes(std::uint32_t q, std::uint32_t) { return bytes_of(model_.levels[q].refinement); }
  Bytes stencils_bytes(std::uint32_t q, std::uint32_t) { return bytes_of(model_.levels[q].stencils); }
  Bytes patterns_bytes(std::uint32_t q, std::uint32_t) { return bytes_of(model_.levels[q].patterns); }
  Bytes vertex_map_bytes(std::uint32_t, std::uint32_t) { return bytes_of(model_.vertices); }
  Bytes loads_bytes(std::uint32_t, std::uint32_t) { return bytes_of(model_.loads); }
  Bytes load_columns_bytes(std::uint32_t q, std::uint32_t) { return bytes_of(model_.levels[q].load_columns); }
  Bytes representatives_bytes(std::uint32_t c, std::uint32_t q) {
    return bytes_of(model_.levels[c].representatives[q]);
  }
  Bytes predictions_bytes(std::uint32_t q, std::uint32_t) {
    return encode_predictions(model_.levels[q].predictions, domain_count(q), domain_of_mesh(q - 1),
                              section_name(SectionKind::predictions, q, 0));
  }
  Bytes scales_bytes(std::uint32_t q, std::uint32_t) {
    kept_blocks_ += domain_count(q);
    return bytes_of(model_.levels[q].scales.numbers);
  }
  Bytes couplings_bytes(std::uint32_t q, std::uint32_t layer) {
    const CouplingsData& data = model_.levels[q].couplings[layer];
    Bytes bytes = encode_couplings(data, {components(), domain_count(q), domain_of_mesh(q), layout::value_bits[layer]},
                                   section_name(SectionKind::couplings, q, layer));
    kept_blocks_ += data.begin.back();
    return bytes;
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
    info.loads = static_cast<std::uint32_t>(model_.loads.size());
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
  const layout::Info info_;
  std::vector<SectionBytes> sections_;
  std::uint64_t kept_blocks_ = 0;  // in the sections so far
};

// of what the sections hold
std::uint16_t least_minor(const ModelData& model) {
  const bool cuts = std::any_of(model.levels.begin(), model.levels.end(),
                                [](const LevelData& level) { return level.counts.cut_error != 0; });
  return std::max(cuts ? layout::first_minor_of_cuts : std::uint16_t{0}, layout::first_minor(model.info));
}

ModelView require_valid(const AlignedBytes& file) {
  ModelView view;
  const VerifyResult result = verify(file.span(), view);
  require(result.ok(), describe(result));
  return view;
}

void require_constraint_level(const ModelView& view, std::uint32_t q) {
  if (view.problem != layout::Problem::elastostatic && view.problem != layout::Problem::scalar) return;
  const layout::Info& info = *view.info;
  require(q >= info.coarsest_constraint_level,
          fmt::format("cut after level {}, but the coarsest constraint level is {}; keep at least that many levels", q,
                      info.coarsest_constraint_level));
}

}  // namespace

std::vector<std::byte> encode_couplings(const CouplingsData& data, const CouplingsForm& form, const std::string& name) {
  require_size(name + ".begin", data.begin.size(), form.columns + std::size_t{1});
  const std::size_t blocks = data.begin.back();
  require_size(name + ".index", data.index.size(), blocks);
  require_size(name + ".value", data.value.size(), blocks * form.components * form.components);

  CouplingsHeader header{};
  header.columns = blocks > 0 ? form.columns : 0;
  header.rows = form.rows;
  header.index_bytes = index_bytes_of(form.rows);
  header.block_count = blocks;

  Bytes bytes;
  bytes.reserve(sizeof(CouplingsHeader) + 4 * (form.columns + std::size_t{1}) + 40 * blocks);
  bytes.resize(sizeof(CouplingsHeader));
  header.begin_offset = bytes.size();
  append(bytes, std::as_bytes(std::span(data.begin).first(header.columns + std::size_t{1})));
  pad_to_alignment(bytes);
  header.index_offset = bytes.size();
  append(bytes, encode_index(data.index, header.index_bytes, name + ".index"));
  pad_to_alignment(bytes);
  header.value_offset = bytes.size();
  append(bytes, encode_values(data.value, form, name + ".value"));
  bytes.resize(bytes.size() + layout::tail_bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

ModelFile encoded_file(const ModelData& model) {
  require(!model.levels.empty() && model.levels.size() <= layout::max_levels,
          fmt::format("{} levels, expected 1 to {}", model.levels.size(), layout::max_levels));
  require(model.info.components == 1 || model.info.components == 3,
          fmt::format("info.components is {}, expected 1 or 3", model.info.components));
  ModelFile file{AlignedBytes(file_of(SectionList(model).take(), static_cast<std::uint32_t>(model.levels.size()),
                                      least_minor(model))),
                 {}};
  file.view = require_valid(file.bytes);
  return file;
}

std::vector<std::byte> encode(const ModelData& model) {
  const ModelFile file = encoded_file(model);
  const auto bytes = file.bytes.span();
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> truncate_to_level(std::vector<std::byte> model, std::uint32_t q) {
  const AlignedBytes whole(model);
  const ModelView view = require_valid(whole);
  require(q < view.header->levels,
          fmt::format("cut after level {}, but the file ends with level {}", q, view.header->levels - 1));
  require_constraint_level(view, q);

  const auto table = section_entries(view);
  std::byte* const table_bytes = model.data() + sizeof(layout::Header);
  const auto dropped = std::find_if(table.begin(), table.end(), [&](const SectionEntry& entry) {
    return entry.kind == static_cast<std::uint32_t>(SectionKind::level) && entry.a == q + 1;
  });
  const auto kept = static_cast<std::size_t>(dropped - table.begin());
  std::fill(table_bytes + kept * sizeof(SectionEntry), table_bytes + table.size() * sizeof(SectionEntry), std::byte{0});
  model.resize(static_cast<std::size_t>(table[kept - 1].offset + table[kept - 1].bytes));
  pad_to_alignment(model);
  layout::Header header{};
  header.major = view.header->major;
  header.minor = view.header->minor;
  header.section_count = static_cast<std::uint32_t>(kept);
  header.levels = q + 1;
  seal(model, header);
  require_valid(AlignedBytes(model));
  return model;
}

}  // namespace greenloop
