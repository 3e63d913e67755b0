// write_recorded_model FILE.h WAVELET: a model of the recorded script as a C array, FILE.h and FILE.c, and as a model
// file, FILE.gloop; WAVELET is lifted-linear, lifted-butterfly, butterfly or equilibrated: the synthetic sphere's mesh
// with arbitrary numbers on it, bits that no mathematical library has a part in. Or it is one of
// the motions: an impulse response model with arbitrary values and coordinates.
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/c_array.hpp"
#include "formats/write/writer.hpp"

namespace greenloop {
namespace {

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-24F; }

void fill_couplings(std::mt19937_64& random, std::size_t columns, std::size_t before, std::uint32_t layer,
                    CouplingsData& couplings) {
  couplings.begin = {0};
  couplings.index.clear();
  couplings.value.clear();
  const int most = (1 << (layout::value_bits[layer] - 1)) - 1;
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::uint32_t i = 0; i < before + j; ++i) {
      if (random() % 4 != 0) {
        continue;
      }
      couplings.index.push_back(i);
      for (int k = 0; k < 9; ++k) {
        couplings.value.push_back(static_cast<std::int16_t>(static_cast<int>(random() % (2U * most + 1)) - most));
      }
    }
    couplings.begin.push_back(static_cast<std::uint32_t>(couplings.index.size()));
  }
}

void fill_scales(std::mt19937_64& random, std::span<layout::Scale<3>> scales) {
  for (layout::Scale<3>& scale : scales) {
    const float size = 0x1p-6F * (1 + uniform(random));
    for (float* matrix : {scale.root, scale.diagonal}) {
      for (int k = 0; k < 6; ++k) {
        matrix[k] = k == 0 || k == 3 || k == 5 ? size : size / 4 * uniform(random);
      }
    }
    for (float& value : scale.diagonal) {
      value *= 64;
    }
  }
}

// about 1/2 on the diagonal of the first two blocks of a node, and small numbers beside
void fill_weights(std::mt19937_64& random, PredictionsData& predictions) {
  for (std::size_t k = 0; k < predictions.weight.size(); ++k) {
    const bool diagonal = k / 9 % predictions.terms < 2 && k % 9 % 4 == 0;
    predictions.weight[k] = static_cast<std::int16_t>((diagonal ? 2048 : 0) + static_cast<int>(random() % 801) - 400);
  }
}

std::size_t domain(const LevelData& level) {
  std::size_t count = 0;
  for (const layout::NodeRecord& node : level.nodes) {
    count += (node.flags & layout::node_domain) != 0 ? 1 : 0;
  }
  return count;
}

ModelData arbitrary_model(layout::Wavelet wavelet) {
  std::mt19937_64 random(20);
  ModelData data = synthetic_model({.levels = 3, .wavelet = wavelet, .touchable_above = 0.2});
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    // small enough that the identity outweighs a whole row
    const int most = (1 << (layout::value_bits[layer] - 1)) - 1;
    data.info.quantum[layer] = 0x1p-10F / static_cast<float>(most) * (1 + uniform(random));
  }
  std::size_t before = 0;
  for (LevelData& level : data.levels) {
    for (layout::RefinementRecord& record : level.refinement) {
      for (float& lift : record.lift) {
        lift = lift == 0 ? 0 : uniform(random) / 4;
      }
    }
    fill_weights(random, level.predictions);
    fill_scales(random, level.scales.of<3>());
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      fill_couplings(random, domain(level), before, layer, level.couplings[layer]);
    }
    before += domain(level);
    level.counts.worst_column_error = 0.5F;
    level.counts.rms_error = 0.25F;
    level.counts.field_column_error = 0.5F;
    level.counts.field_rms_error = 0.25F;
  }
  return data;
}

// coordinates wander, so that orbits look like motions
ImpulseResponseData arbitrary_motion(const SyntheticMotion& options) {
  std::mt19937_64 random(21);
  ImpulseResponseData data = synthetic_motion(options);
  const std::int32_t most = layout::most_value(options.planes);
  for (ModeGroupData& group : data.groups) {
    const std::size_t modes = group.amplitudes.size();
    for (layout::ModeRecord& mode : group.amplitudes) mode.amplitude = 0x1p-6F * (1 + uniform(random));
    for (std::int16_t& value : group.values) {
      value = static_cast<std::int16_t>(static_cast<int>(random() % (2U * most + 1)) - most);
    }
    for (std::size_t i = 0; i < group.coordinates.size(); ++i) {
      const int before = i < modes ? 0 : group.coordinates[i - modes];
      const int at = before - before / 16 + static_cast<int>(random() % 2001) - 1000;
      group.coordinates[i] = static_cast<std::int16_t>(at);
    }
  }
  for (layout::ReferenceRecord& reference : data.references) {
    if (reference.orbit != layout::none) reference.distance = 0x1p-8F * uniform(random);
  }
  for (layout::OrbitRecord& orbit : data.orbits) {
    if (orbit.next_orbit != layout::none) orbit.next_distance = 0x1p-8F * uniform(random);
  }
  for (std::int8_t& value : data.appearance.transfers) value = static_cast<std::int8_t>(random() >> 40);
  for (std::size_t i = 0; i < data.appearance.coordinates.size(); ++i) {
    data.appearance.coordinates[i] = data.groups[0].coordinates[i % data.groups[0].coordinates.size()];
  }
  for (float& quantum : data.appearance.quanta) quantum = 0x1p-8F * (1 + uniform(random));
  for (float& quantum : data.quanta) quantum = 0x1p-22F * (1 + uniform(random));
  return data;
}

}  // namespace
}  // namespace greenloop

int main(int argc, char** argv) {
  using greenloop::layout::Wavelet;
  const std::map<std::string, Wavelet> wavelets = {{"lifted-linear", Wavelet::lifted_linear},
                                                   {"lifted-butterfly", Wavelet::lifted_butterfly},
                                                   {"butterfly", Wavelet::butterfly},
                                                   {"equilibrated", Wavelet::equilibrated}};
  const std::map<std::string, greenloop::SyntheticMotion> motions = {
      {"motion",
       {.vertices = 90, .modes = 8, .groups = 3, .planes = 2, .orbits = 12, .alternating = true, .transfer_modes = 4}},
      {"large-motion", {.vertices = 642, .modes = 12, .groups = 3, .orbits = 12}},
      {"shown-motion", {.vertices = 24690, .modes = 12, .groups = 3, .orbits = 12}},
      {"shown-motion-16-bits", {.vertices = 24690, .modes = 12, .groups = 3, .planes = 2, .orbits = 12}},
      {"shown-motion-30-modes", {.vertices = 24690, .modes = 30, .groups = 3, .orbits = 12}},
      {"lit-motion", {.vertices = 24690, .modes = 12, .groups = 3, .orbits = 12, .transfer_modes = 7}}};
  const std::string kind = argc == 3 ? argv[2] : "";
  const auto wavelet = wavelets.find(kind);
  const auto motion = motions.find(kind);
  if (wavelet == wavelets.end() && motion == motions.end()) {
    std::cerr << "usage: write_recorded_model FILE.h "
                 "lifted-linear|lifted-butterfly|butterfly|equilibrated|motion|large-motion|shown-motion\n";
    return 2;
  }
  try {
    const std::vector<std::byte> bytes = motion != motions.end()
                                             ? greenloop::encode(greenloop::arbitrary_motion(motion->second))
                                             : greenloop::encode(greenloop::arbitrary_model(wavelet->second));
    greenloop::write_c_array(argv[1], bytes);
    greenloop::write_file(std::filesystem::path(argv[1]).replace_extension(".gloop"), bytes);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
