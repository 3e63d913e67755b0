#include "formats/transport/predictions_model.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace greenloop::transport {
namespace {

constexpr std::uint32_t most_elements = 9;
constexpr std::int64_t one = 4096;  // in units of layout::prediction_unit
static_assert(one * layout::prediction_unit == 1);

layout::PredictionsHeader header_of(std::span<const std::byte> section) {
  layout::PredictionsHeader header;
  std::memcpy(&header, section.data(), sizeof(header));
  return header;
}

template <class Number>
Number number_at(std::span<const std::byte> section, std::uint64_t offset) {
  Number number = 0;
  std::memcpy(&number, section.data() + offset, sizeof(number));
  return number;
}

// codes the difference of a number in place from a prediction
template <class Number>
std::int64_t code_number(BitCoder& coder, AdaptiveInteger& model, std::uint32_t context, std::span<std::byte> section,
                         std::uint64_t offset, std::int64_t predicted) {
  constexpr std::int64_t most_difference = std::int64_t{1} << 33;
  const std::int64_t given = number_at<Number>(section, offset) - predicted;
  const std::int64_t difference = restore_sign(model.code(coder, interleave_sign(given), context));
  const std::int64_t value = predicted + std::clamp(difference, -most_difference, most_difference);
  const auto number = static_cast<Number>(value);
  if (number != value) throw DamagedPacket("a prediction beyond its range");
  std::memcpy(section.data() + offset, &number, sizeof(number));
  return value;
}

template <class Index>
void code_index(BitCoder& coder, AdaptiveInteger& model, const layout::PredictionsHeader& header,
                std::span<std::byte> section) {
  std::array<std::int64_t, layout::most_prediction_terms> before{};
  std::uint64_t offset = sizeof(header);
  for (std::uint32_t node = 0; node < header.nodes; ++node) {
    for (std::uint32_t k = 0; k < header.terms; ++k, offset += sizeof(Index)) {
      before[k] = code_number<Index>(coder, model, k, section, offset, before[k]);
    }
  }
}

}  // namespace

bool PredictionsModel::fits(std::span<const std::byte> section, std::uint32_t components) {
  if (section.size() < sizeof(layout::PredictionsHeader)) return false;
  const auto header = header_of(section);
  // with no terms a length says nothing of the nodes
  if (header.terms == 0 || header.terms > layout::most_prediction_terms ||
      (header.index_bytes != 2 && header.index_bytes != 4)) {
    return false;
  }
  const layout::PredictionsExtent extent(header, components);
  return header.index_offset == extent.index && header.weight_offset == extent.weight &&
         section.size() >= extent.weight_end;
}

void PredictionsModel::code(BitCoder& coder, std::span<std::byte> section, std::uint32_t components) {
  const auto header = header_of(section);
  if (header.index_bytes == 2) {
    code_index<std::uint16_t>(coder, index_, header, section);
  } else {
    code_index<std::uint32_t>(coder, index_, header, section);
  }
  const std::uint32_t elements = components * components;
  std::uint64_t offset = layout::PredictionsExtent(header, components).weight;
  for (std::uint32_t node = 0; node < header.nodes; ++node) {
    std::array<std::int64_t, most_elements> left{};
    for (std::uint32_t e = 0; e < elements; e += components + 1) left[e] = one;
    for (std::uint32_t k = 0; k < header.terms; ++k) {
      const bool last = k + 1 == header.terms;
      for (std::uint32_t e = 0; e < elements; ++e, offset += sizeof(std::int16_t)) {
        const std::uint32_t context = elements * (last ? layout::most_prediction_terms : k) + e;
        left[e] -= code_number<std::int16_t>(coder, weight_, context, section, offset, last ? left[e] : 0);
      }
    }
  }
}

PredictionsGaps gaps_of_predictions(std::span<std::byte> section, std::uint32_t components) {
  const layout::PredictionsExtent extent(header_of(section), components);
  return {section.subspan(extent.index_end, extent.weight - extent.index_end), section.subspan(extent.weight_end)};
}

}  // namespace greenloop::transport
