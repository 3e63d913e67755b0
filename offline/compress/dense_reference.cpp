#include "offline/compress/dense_reference.hpp"

#include <cstring>
#include <stdexcept>

#include "formats/verify.hpp"
#include "offline/compress/compliance_pyramid.hpp"
#include "offline/compress/model_tables.hpp"

namespace greenloop::offline::test {
namespace {

Eigen::Index at(std::size_t row) { return static_cast<Eigen::Index>(3 * row); }

Eigen::Matrix3d symmetric(const float (&six)[6]) {
  Eigen::Matrix3d matrix;
  const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) matrix(r, c) = static_cast<double>(six[place[r][c]]);
  }
  return matrix;
}

// block-diagonal
Sparse diagonal(const layout::Scale* scales, std::size_t count, const float (layout::Scale::*six)[6]) {
  Sparse matrix(at(count), at(count));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Matrix3d block = symmetric(scales[i].*six);
    for (Eigen::Index c = 0; c < 3; ++c) {
      for (Eigen::Index r = 0; r < 3; ++r) matrix.insert(at(i) + r, at(i) + c) = block(r, c);
    }
  }
  return matrix;
}

Sparse roots(const layout::Scale* scales, std::size_t count) { return diagonal(scales, count, &layout::Scale::root); }

// the two factors of a step, with `sign` 1, or of its inverse, with -1
struct Factors {
  Sparse predict, lift;
};
Factors factors(const LinearWavelet& wavelet, std::size_t level, double sign) {
  const Eigen::Index size = at(wavelet.row_end(level));
  Factors result{Sparse(size, size), Sparse(size, size)};
  result.predict.setIdentity();
  result.lift.setIdentity();
  for (const auto& odd : wavelet.odds(level)) {
    for (int side = 0; side < 2; ++side) {
      if (odd.parent[side] == LinearWavelet::no_row) continue;
      for (Eigen::Index k = 0; k < 3; ++k) {
        result.predict.coeffRef(at(odd.row) + k, at(odd.parent[side]) + k) = -0.5 * sign;
        result.lift.coeffRef(at(odd.parent[side]) + k, at(odd.row) + k) = sign * static_cast<double>(odd.lift[side]);
      }
    }
  }
  return result;
}

double value_at(const CouplingsView& couplings, std::size_t block, std::size_t k) {
  if (couplings.value_bits == 16) {
    std::int16_t value = 0;
    std::memcpy(&value, couplings.value + 18 * block + 2 * k, 2);
    return value;
  }
  if (couplings.value_bits == 8) return static_cast<std::int8_t>(couplings.value[9 * block + k]);
  const int nibble = std::to_integer<int>((couplings.value[5 * block + k / 2] >> (k % 2 == 0 ? 0 : 4)) & std::byte{15});
  return nibble > 7 ? nibble - 16 : nibble;
}

std::size_t row_at(const CouplingsView& couplings, std::size_t column, std::size_t block) {
  if (couplings.index_bytes == 2) return static_cast<const std::uint16_t*>(couplings.index)[block];
  if (couplings.index_bytes == 4) return static_cast<const std::uint32_t*>(couplings.index)[block];
  return block - couplings.begin[column];
}

// scaled couplings of a level with one partner: rows x columns
Eigen::MatrixXd couplings(const LevelView& level, layout::Partner partner, std::uint32_t layers, std::size_t rows,
                          std::size_t columns) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(at(rows), at(columns));
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    const CouplingsView& from = level.couplings[static_cast<int>(partner)][layer];
    for (std::size_t j = 0; j < from.columns; ++j) {
      for (std::size_t b = from.begin[j]; b < from.begin[j + 1]; ++b) {
        for (std::size_t k = 0; k < 9; ++k) {
          matrix(at(row_at(from, j, b)) + static_cast<Eigen::Index>(k % 3), at(j) + static_cast<Eigen::Index>(k / 3)) +=
              static_cast<double>(from.quantum) * value_at(from, b, k);
        }
      }
    }
  }
  return matrix;
}

// couplings of a level's own coefficients with each other, diagonal blocks included
Eigen::MatrixXd own(const LevelView& level, const layout::Scale* scales, std::uint32_t layers) {
  const std::size_t count = level.counts->domain_count;
  const Eigen::MatrixXd half = couplings(level, layout::Partner::same, layers, count, count);
  const Sparse root = roots(scales, count);
  const Eigen::MatrixXd scaled = half + half.transpose() + diagonal(scales, count, &layout::Scale::diagonal);
  return root * scaled * root;
}

}  // namespace

Sparse forward_step(const LinearWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors(wavelet, level, 1);
  return lift * predict;
}

Sparse backward_step(const LinearWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors(wavelet, level, -1);
  return predict * lift;
}

NonStandardForm dense_form(const LinearWavelet& wavelet, const Eigen::MatrixXd& compliance) {
  const std::size_t levels = wavelet.finest() + 1;
  NonStandardForm form{.averages = std::vector<Eigen::MatrixXd>(levels),
                       .details = std::vector<Eigen::MatrixXd>(levels),
                       .crossed = std::vector<Eigen::MatrixXd>(levels)};
  form.averages.back() = compliance;
  for (std::size_t level = wavelet.finest(); level > 0; --level) {
    const Sparse step = forward_step(wavelet, level);
    const Eigen::MatrixXd all = step * form.averages[level] * step.transpose();
    const Eigen::Index evens = at(wavelet.row_end(level - 1)), odds = all.rows() - evens;
    form.averages[level - 1] = all.topLeftCorner(evens, evens);
    form.details[level] = all.bottomRightCorner(odds, odds);
    form.crossed[level] = all.bottomLeftCorner(odds, evens);
    if (level > 1) form.crossed[level] = form.crossed[level] * forward_step(wavelet, level - 1).transpose();
  }
  return form;
}

std::vector<Eigen::MatrixXd> dense_compliances(const ModelView& view, std::uint32_t layers) {
  const LinearWavelet wavelet(view);
  std::vector<Eigen::MatrixXd> result = {own(view.level[0], view.level[0].averages, layers)};
  for (std::size_t level = 1; level < view.levels; ++level) {
    const LevelView& from = view.level[level];
    const std::size_t odds = from.counts->domain_count, evens = wavelet.row_end(level - 1);
    const std::size_t below = level > 1 ? level - 2 : 0, averages = wavelet.row_end(below);
    const Sparse root = roots(from.details, odds);
    Eigen::MatrixXd crossed(at(odds), at(evens));  // B_l
    crossed.leftCols(at(averages)) = root *
                                     couplings(from, layout::Partner::averages, layers, averages, odds).transpose() *
                                     roots(view.level[below].averages, averages);
    if (level > 1) {
      crossed.rightCols(at(evens - averages)) =
          root * couplings(from, layout::Partner::parents, layers, evens - averages, odds).transpose() *
          roots(view.level[level - 1].details, evens - averages);
      crossed = crossed * backward_step(wavelet, level - 1).transpose();
    }
    Eigen::MatrixXd all(at(evens + odds), at(evens + odds));
    all << result.back(), crossed.transpose(), crossed, own(from, from.details, layers);
    const Sparse back = backward_step(wavelet, level);
    result.emplace_back(back * all * back.transpose());
  }
  return result;
}

ColumnSource columns_of(const Eigen::MatrixXd& compliance) {
  return [&compliance](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return compliance.middleCols(at(first), at(count));
  };
}

ModelData model_of(const Body& body, bool lifted, const Encoding& encoding) {
  const LinearWavelet wavelet(body.mesh, body.flags, body.area, lifted);
  ModelData model = describe_mesh(body.mesh, body.flags, body.area, wavelet, facts());
  add_representatives(body.mesh, body.flags, model);
  model.info.field_layers = 3;
  encode_couplings(build_pyramid(wavelet, columns_of(body.compliance), 0.5 * encoding.threshold, {}), encoding, model);
  return model;
}

File::File(const ModelData& model) : bytes(encode(model)) {
  if (const auto result = verify(bytes.span(), view); !result.ok()) throw std::logic_error(result.field);
}

layout::Info facts() {
  layout::Info info{};
  info.young = 1e5;
  info.poisson = 0.3;
  info.rate = 1000;
  info.max_contacts = 64;
  info.step_work = 1'000'000;
  return info;
}

}  // namespace greenloop::offline::test
