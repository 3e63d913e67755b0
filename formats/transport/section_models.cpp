#include "formats/transport/section_models.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#include "formats/transport/float_bits.hpp"

namespace greenloop::transport {
namespace {

constexpr std::uint32_t length_contexts = 17;
constexpr std::uint32_t most_step = 200;
constexpr std::uint32_t step_of_exponent = 40 + 127 - 150;  // to_fixed's exponent over ours
constexpr std::int64_t most_steps = 1 << 27;

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t i) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + sizeof(word) * i, sizeof(word));
  return word;
}

void set_word(std::span<std::byte> bytes, std::size_t i, std::uint32_t word) {
  std::memcpy(bytes.data() + sizeof(word) * i, &word, sizeof(word));
}

// codes word i in place and returns it
std::uint32_t code_word(BitCoder& coder, WordModel& words, std::span<std::byte> bytes, std::size_t i,
                        std::uint32_t field, std::uint32_t predicted) {
  const std::uint32_t word = words.code(coder, field, word_at(bytes, i), predicted);
  set_word(bytes, i, word);
  return word;
}

// The last digit that all numbers of a field of scales have: they are whole numbers, below 2^25, of 2^(step - 150). 0
// if there is none or some number does not come back from them.
std::uint32_t common_step(std::span<const std::byte> scales, std::size_t fields, std::size_t field) {
  const std::size_t count = scales.size() / sizeof(std::uint32_t);
  std::uint32_t step = most_step;
  for (std::size_t i = field; i < count; i += fields) {
    const std::uint32_t word = word_at(scales, i), digits = (word & 0x7fffff) | 0x800000;
    if ((word & 0x7fffffff) != 0) step = std::min(step, exponent_of(word) + std::countr_zero(digits));
  }
  for (std::size_t i = field; i < count; i += fields) {
    const std::int64_t steps = to_fixed(word_at(scales, i), step + step_of_exponent);
    if (std::abs(steps) > most_steps / 4 || from_fixed(steps, step + step_of_exponent) != word_at(scales, i)) return 0;
  }
  return step;
}

std::uint32_t code_common_step(BitCoder& coder, std::span<const std::byte> scales, std::size_t fields,
                               std::size_t field) {
  const auto step = static_cast<std::uint32_t>(coder.code_plain(common_step(scales, fields, field), 8));
  if (step > most_step) throw DamagedPacket("a digit beyond those of scales");
  return step;
}

}  // namespace

ByteModel::ByteModel() : bits_(std::array<std::uint32_t, 3>{256, 1U << 16, 1U << 16}, 1) {}

void ByteModel::code(BitCoder& coder, std::span<std::byte> bytes) {
  std::uint32_t last = 0, last_but_one = 0;
  for (std::byte& byte : bytes) {
    const auto value = std::to_integer<std::uint32_t>(byte);
    std::uint32_t node = 1;
    for (std::uint32_t i = 8; i-- > 0;) {
      const std::uint32_t two = (last << 8 | last_but_one) * 0x9e3779b1U >> 16 ^ node * 0x101U;
      const std::array contexts{node, last << 8 | node, two & 0xffff};
      node = 2 * node + static_cast<std::uint32_t>(bits_.code(coder, (value >> i & 1) != 0, contexts, 0));
    }
    last_but_one = last;
    last = node & 0xff;
    byte = static_cast<std::byte>(last);
  }
}

WordModel::WordModel(std::uint32_t fields) : differences_(fields * length_contexts), length_(fields) {}

std::uint32_t WordModel::code(BitCoder& coder, std::uint32_t field, std::uint32_t word, std::uint32_t predicted) {
  const std::int64_t from = order_of(predicted);
  // a decoder's difference may be any number
  const auto difference = static_cast<std::uint64_t>(code_difference(coder, field, order_of(word) - from));
  return bits_of_order(static_cast<std::uint32_t>(static_cast<std::uint64_t>(from) + difference));
}

std::uint32_t WordModel::code_steps(BitCoder& coder, std::uint32_t field, std::uint32_t step, std::uint32_t word,
                                    std::uint32_t predicted) {
  const std::int64_t from = to_fixed(predicted, step + step_of_exponent);
  const std::int64_t difference = code_difference(coder, field, to_fixed(word, step + step_of_exponent) - from);
  if (difference < -most_steps || difference > most_steps)
    throw DamagedPacket("a number of more digits than there are");
  return from_fixed(from + difference, step + step_of_exponent);
}

std::int64_t WordModel::code_difference(BitCoder& coder, std::uint32_t field, std::int64_t difference) {
  const std::uint64_t coded =
      differences_.code(coder, interleave_sign(difference), field * length_contexts + length_[field] / 2);
  length_[field] = std::min(static_cast<std::uint32_t>(std::bit_width(coded)), 33U);
  return restore_sign(coded);
}

void MeshModel::code_words(BitCoder& coder, std::uint32_t fields, std::span<std::byte> section) {
  WordModel words(fields);
  for (std::size_t i = 0; i < section.size() / sizeof(std::uint32_t); ++i) {
    code_word(coder, words, section, i, static_cast<std::uint32_t>(i % fields),
              i < fields ? 0 : word_at(section, i - fields));
  }
}

void MeshModel::code_refinement(BitCoder& coder, std::uint32_t q, std::span<std::byte> section) {
  constexpr std::size_t fields = sizeof(layout::RefinementRecord) / sizeof(std::uint32_t);
  code_words(coder, fields, section);
  const std::size_t count = section.size() / sizeof(layout::RefinementRecord);
  nodes_.resize(begin_[q] + count);
  for (std::size_t i = 0; i < count; ++i) {
    nodes_[begin_[q] + i].parent = {word_at(section, fields * i), word_at(section, fields * i + 1)};
  }
}

void MeshModel::code_nodes(BitCoder& coder, std::uint32_t q, std::span<std::byte> section) {
  constexpr std::size_t fields = sizeof(layout::NodeRecord) / sizeof(std::uint32_t);
  const std::size_t count = section.size() / sizeof(layout::NodeRecord);
  const std::uint32_t exponent = largest_exponent();
  nodes_.resize(begin_[q] + count);
  begin_[q + 1] = nodes_.size();
  WordModel words(fields);
  for (std::size_t i = 0; i < count; ++i) {
    Node& node = nodes_[begin_[q] + i];
    const auto predicted = predicted_position(begin_[q] + i, exponent);
    for (std::uint32_t k = 0; k < fields; ++k) {
      const std::uint32_t before = i == 0 ? 0 : word_at(section, fields * (i - 1) + k);
      const std::uint32_t word = code_word(coder, words, section, fields * i + k, k, k < 3 ? predicted[k] : before);
      if (k < 3) node.position[k] = word;
      if (k == 4) node.flags = word;
    }
  }
}

std::uint32_t MeshModel::largest_exponent() const {
  std::uint32_t largest = 0;
  for (const Node& node : nodes_) {
    for (const std::uint32_t coordinate : node.position) largest = std::max(largest, exponent_of(coordinate));
  }
  return largest;
}

std::array<std::uint32_t, 3> MeshModel::predicted_position(std::size_t node, std::uint32_t exponent) const {
  const auto [a, b] = nodes_[node].parent;
  std::array<std::uint32_t, 3> position{};
  if (a < node && b < node) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t sum = to_fixed(nodes_[a].position[k], exponent) + to_fixed(nodes_[b].position[k], exponent);
      position[k] = from_fixed(sum / 2, exponent);
    }
  } else if (node > 0) {
    position = nodes_[node - 1].position;
  }
  return position;
}

std::uint32_t MeshModel::representative(std::uint32_t c, std::uint32_t node) const {
  return node < representatives_[c].size() ? representatives_[c][node] : layout::none;
}

void MeshModel::code_representatives(BitCoder& coder, std::uint32_t c, std::uint32_t q, std::span<std::byte> section) {
  const std::size_t count = section.size() / sizeof(std::uint32_t);
  auto& known = representatives_[c];
  known.resize(std::max(known.size(), begin_[q] + count), layout::none);
  std::array<AdaptiveBit, 4> first;
  std::array<AdaptiveBit, 4> second;
  WordModel words(1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t node = begin_[q] + i;
    std::uint32_t a = layout::none, b = layout::none;
    const bool touchable = node < nodes_.size() && (nodes_[node].flags & layout::node_touchable) != 0;
    if (touchable && q <= c) a = static_cast<std::uint32_t>(node);
    if (touchable && q > c) {
      a = representative(c, nodes_[node].parent[0]);
      b = representative(c, nodes_[node].parent[1]);
    }
    const std::uint32_t given = word_at(section, i);
    const auto context = static_cast<std::size_t>(touchable) * 2 + static_cast<std::size_t>(a == b);
    std::uint32_t word = a;
    if (!first[context].code(coder, given == a)) {
      word = second[context].code(coder, given == b) ? b : words.code(coder, 0, given, a);
    }
    set_word(section, i, word);
    known[node] = word;
  }
}

void MeshModel::code_scales(BitCoder& coder, std::uint32_t q, std::uint32_t components, std::span<std::byte> section) {
  const std::vector<std::size_t> nodes = domain_nodes(q);
  std::vector<GridPoint> points;
  points.reserve(nodes.size());
  const std::uint32_t exponent = largest_exponent();
  for (const std::size_t node : nodes) points.push_back(grid_point(nodes_[node], exponent));
  const auto near = neighbours_before(points);
  const std::uint32_t fields = components * (components + 1);
  std::vector<std::uint32_t> step;
  for (std::size_t k = 0; k < fields; ++k) step.push_back(code_common_step(coder, section, fields, k));
  WordModel words(fields);
  for (std::size_t i = 0; i < section.size() / sizeof(std::uint32_t) / fields; ++i) {
    const std::uint32_t like = i < near.size() ? near[i][0] : no_neighbour;
    for (std::uint32_t k = 0; k < fields; ++k) {
      const std::size_t at = fields * i + k;
      const std::uint32_t given = word_at(section, at),
                          predicted = like == no_neighbour ? 0 : word_at(section, std::size_t{fields} * like + k);
      set_word(section, at,
               step[k] == 0 ? words.code(coder, k, given, predicted)
                            : words.code_steps(coder, k, step[k], given, predicted));
    }
  }
}

std::vector<Coefficient> MeshModel::coefficients(std::uint32_t q) const {
  const std::uint32_t exponent = largest_exponent();
  std::vector<Coefficient> coefficients;
  for (std::uint32_t r = 0; r <= q; ++r) {
    for (const std::size_t node : domain_nodes(r)) {
      coefficients.push_back({.point = grid_point(nodes_[node], exponent), .level = r});
    }
  }
  return coefficients;
}

std::uint32_t MeshModel::own_coefficients(std::uint32_t q) const {
  return static_cast<std::uint32_t>(domain_nodes(q).size());
}

std::vector<std::size_t> MeshModel::domain_nodes(std::uint32_t q) const {
  std::vector<std::size_t> nodes;
  for (std::size_t i = begin_[q]; i < std::min(begin_[q + 1], nodes_.size()); ++i) {
    if ((nodes_[i].flags & layout::node_domain) != 0) nodes.push_back(i);
  }
  return nodes;
}

GridPoint MeshModel::grid_point(const Node& node, std::uint32_t exponent) {
  GridPoint point{};
  for (std::size_t k = 0; k < 3; ++k) {
    point[k] = static_cast<std::int32_t>(to_fixed(node.position[k], exponent) / (1 << 25));
  }
  return point;
}

}  // namespace greenloop::transport
