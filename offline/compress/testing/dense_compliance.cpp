#include "offline/compress/testing/dense_compliance.hpp"

#include <cstring>

#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"
#include "offline/compress/wavelet/wavelet_compliance.hpp"

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

// the two factors of a step, with `sign` 1, or of its inverse, with -1
struct Factors {
  Sparse predict, lift;
};
Factors factors(const SurfaceWavelet& wavelet, std::size_t level, double sign) {
  const Eigen::Index size = at(wavelet.row_end(level));
  Factors result{Sparse(size, size), Sparse(size, size)};
  result.predict.setIdentity();
  result.lift.setIdentity();
  for (const auto& odd : wavelet.odds(level)) {
    const auto add_term = [&](std::uint32_t row, const Eigen::Matrix3d& weight) {
      for (Eigen::Index k = 0; k < 9; ++k) {
        result.predict.coeffRef(at(odd.row) + k % 3, at(row) + k / 3) -= sign * weight(k % 3, k / 3);
      }
    };
    for (const auto& [row, weight] : wavelet.block_prediction(odd)) add_term(row, weight);
    if (!wavelet.has_blocks()) {
      for (const auto& [row, weight] : odd.prediction()) add_term(row, weight * Eigen::Matrix3d::Identity());
    }
    for (int side = 0; side < 2; ++side) {
      if (odd.parent[side] == SurfaceWavelet::no_row) continue;
      for (Eigen::Index k = 0; k < 3; ++k) {
        result.lift.coeffRef(at(odd.parent[side]) + k, at(odd.row) + k) = sign * static_cast<double>(odd.lift[side]);
      }
    }
  }
  return result;
}

template <class Stored>
double number_at(const std::byte* value, std::size_t n) {
  Stored number = 0;
  std::memcpy(&number, value + sizeof(Stored) * n, sizeof(Stored));
  return number;
}

double value_at(const std::byte* value, std::uint32_t bits, std::size_t block, std::size_t k) {
  if (bits == 16) return number_at<std::int16_t>(value, 9 * block + k);
  if (bits == 8) return number_at<std::int8_t>(value, 9 * block + k);
  const int nibble = std::to_integer<int>((value[5 * block + k / 2] >> (k % 2 == 0 ? 0 : 4)) & std::byte{15});
  return nibble > 7 ? nibble - 16 : nibble;
}

std::size_t row_at(const CouplingsView& couplings, std::size_t block) {
  if (couplings.index_bytes == 2) return static_cast<const std::uint16_t*>(couplings.index)[block];
  return static_cast<const std::uint32_t*>(couplings.index)[block];
}

// W U^ W^T
Eigen::MatrixXd stored_form(const ModelView& view) {
  const Eigen::Index size = at(view.domain_count);
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(size, size);
  std::vector<layout::Scale<3>> scales;
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& from = view.level[level];
    scales.insert(scales.end(), from.scales_of<3>(), from.scales_of<3>() + from.counts->domain_count);
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = from.couplings[layer];
      for (std::size_t j = 0; j < couplings.columns; ++j) {
        for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          double element[9];
          for (std::size_t k = 0; k < 9; ++k) {
            element[k] = value_at(couplings.value, layout::value_bits[layer], b, k);
          }
          const std::size_t row = row_at(couplings, b), column = from.domain_begin + j;
          const Eigen::Matrix3d block = static_cast<double>(view.info->quantum[layer]) * symmetric(scales[row].root) *
                                        Eigen::Map<const Eigen::Matrix3d>(element) * symmetric(scales[column].root);
          form.block<3, 3>(at(row), at(column)) += block;
          form.block<3, 3>(at(column), at(row)) += block.transpose();
        }
      }
    }
  }
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const Eigen::Matrix3d root = symmetric(scales[i].root);
    form.block<3, 3>(at(i), at(i)) = root * symmetric(scales[i].diagonal) * root;
  }
  return form;
}

}  // namespace

Sparse forward_step(const SurfaceWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors(wavelet, level, 1);
  return lift * predict;
}

Sparse backward_step(const SurfaceWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors(wavelet, level, -1);
  return predict * lift;
}

Sparse forward_transform(const SurfaceWavelet& wavelet, std::size_t level) {
  const Eigen::Index size = at(wavelet.row_end(level));
  Sparse all(size, size);
  all.setIdentity();
  for (std::size_t l = level; l > 0; --l) {
    const Sparse step = forward_step(wavelet, l);
    Sparse padded(size, size);
    padded.setIdentity();
    for (Eigen::Index outer = 0; outer < step.outerSize(); ++outer) {
      for (Sparse::InnerIterator it(step, outer); it; ++it) padded.coeffRef(it.row(), it.col()) = it.value();
    }
    all = Sparse(padded * all);
  }
  return all;
}

std::vector<Eigen::MatrixXd> level_compliances(const SurfaceWavelet& wavelet, const Eigen::MatrixXd& compliance) {
  std::vector<Eigen::MatrixXd> levels(wavelet.finest() + 1);
  levels.back() = compliance;
  for (std::size_t level = wavelet.finest(); level > 0; --level) {
    const Sparse step = forward_step(wavelet, level);
    const Eigen::Index evens = at(wavelet.row_end(level - 1));
    levels[level - 1] = Eigen::MatrixXd(step * levels[level] * step.transpose()).topLeftCorner(evens, evens);
  }
  return levels;
}

std::vector<Eigen::MatrixXd> dense_compliances(const ModelView& view) {
  const SurfaceWavelet wavelet(view);
  const Eigen::MatrixXd form = stored_form(view);
  std::vector<Eigen::MatrixXd> result;
  for (std::size_t level = 0; level < view.levels; ++level) {
    const Eigen::Index size = at(wavelet.row_end(level));
    Eigen::MatrixXd x = form.topLeftCorner(size, size);
    for (std::size_t l = 1; l <= level; ++l) {
      const Eigen::Index end = at(wavelet.row_end(l));
      const Sparse back = backward_step(wavelet, l);
      x.topRows(end) = Eigen::MatrixXd(back * x.topRows(end));
      x.leftCols(end) = Eigen::MatrixXd(x.leftCols(end) * back.transpose());
    }
    result.push_back(x);
  }
  return result;
}

ExactColumns columns_of(const Eigen::MatrixXd& compliance) {
  return [&compliance](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return compliance.middleCols(at(first), at(count));
  };
}

ModelData model_of(const Body& body, layout::Wavelet kind, const Encoding& encoding) {
  const SurfaceWavelet wavelet = make_wavelet(body.mesh, body.flags, body.area, kind, columns_of(body.compliance));
  ModelData model = describe_mesh(body.mesh, body.flags, body.area, wavelet, facts());
  add_representatives(body.mesh, body.flags, model);
  encode_couplings(transform_compliance(wavelet, columns_of(body.compliance), 0.25 * encoding.threshold, {}), encoding,
                   model);
  return model;
}

File::File(const ModelData& model) : ModelFile(encoded_file(model)) {}

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
