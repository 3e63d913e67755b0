#include "offline/compress/testing/dense_compliance.hpp"

#include <cstring>

#include "offline/compress/encode/model_tables.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"
#include "offline/compress/wavelet/wavelet_compliance.hpp"

namespace greenloop::offline::test {
namespace {

SquareMatrix<1> symmetric(const float (&one)[1]) { return SquareMatrix<1>(static_cast<double>(one[0])); }

SquareMatrix<3> symmetric(const float (&six)[6]) {
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
template <unsigned N>
Factors factors(const SurfaceWavelet& wavelet, std::size_t level, double sign) {
  const Eigen::Index size = block_begin<N>(wavelet.row_end(level)), n = N;
  Factors result{Sparse(size, size), Sparse(size, size)};
  result.predict.setIdentity();
  result.lift.setIdentity();
  for (const auto& odd : wavelet.odds(level)) {
    for (const auto& [row, weight] : prediction_of<N>(wavelet, odd)) {
      for (Eigen::Index k = 0; k < n * n; ++k) {
        result.predict.coeffRef(block_begin<N>(odd.row) + k % n, block_begin<N>(row) + k / n) -=
            sign * weight(k % n, k / n);
      }
    }
    for (int side = 0; side < 2; ++side) {
      if (odd.parent[side] == SurfaceWavelet::no_row) continue;
      for (Eigen::Index k = 0; k < n; ++k) {
        result.lift.coeffRef(block_begin<N>(odd.parent[side]) + k, block_begin<N>(odd.row) + k) =
            sign * static_cast<double>(odd.lift[side]);
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

template <unsigned N>
double value_at(const std::byte* value, std::uint32_t bits, std::size_t block, std::size_t k) {
  if (bits == 16) return number_at<std::int16_t>(value, block_numbers<N> * block + k);
  if (bits == 8) return number_at<std::int8_t>(value, block_numbers<N> * block + k);
  const int nibble =
      std::to_integer<int>((value[(block_numbers<N> + 1) / 2 * block + k / 2] >> (k % 2 == 0 ? 0 : 4)) & std::byte{15});
  return nibble > 7 ? nibble - 16 : nibble;
}

std::size_t row_at(const CouplingsView& couplings, std::size_t block) {
  if (couplings.index_bytes == 2) return static_cast<const std::uint16_t*>(couplings.index)[block];
  return static_cast<const std::uint32_t*>(couplings.index)[block];
}

// W U^ W^T
template <unsigned N>
Eigen::MatrixXd stored_form(const ModelView& view) {
  const Eigen::Index size = block_begin<N>(view.domain_count);
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(size, size);
  std::vector<layout::Scale<N>> scales;
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& from = view.level[level];
    scales.insert(scales.end(), from.scales_of<N>(), from.scales_of<N>() + from.counts->domain_count);
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const CouplingsView& couplings = from.couplings[layer];
      for (std::size_t j = 0; j < couplings.columns; ++j) {
        for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
          double element[block_numbers<N>];
          for (std::size_t k = 0; k < block_numbers<N>; ++k) {
            element[k] = value_at<N>(couplings.value, layout::value_bits[layer], b, k);
          }
          const std::size_t row = row_at(couplings, b), column = from.domain_begin + j;
          const SquareMatrix<N> block = static_cast<double>(view.info->quantum[layer]) * symmetric(scales[row].root) *
                                        Eigen::Map<const SquareMatrix<N>>(element) * symmetric(scales[column].root);
          form.block<N, N>(block_begin<N>(row), block_begin<N>(column)) += block;
          form.block<N, N>(block_begin<N>(column), block_begin<N>(row)) += block.transpose();
        }
      }
    }
  }
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const SquareMatrix<N> root = symmetric(scales[i].root);
    form.block<N, N>(block_begin<N>(i), block_begin<N>(i)) = root * symmetric(scales[i].diagonal) * root;
  }
  return form;
}

}  // namespace

template <>
std::vector<PredictionTerm<1>> prediction_of(const SurfaceWavelet&, const SurfaceWavelet::Odd& odd) {
  std::vector<PredictionTerm<1>> terms;
  for (const auto& [row, weight] : odd.prediction()) terms.push_back({row, SquareMatrix<1>(weight)});
  return terms;
}

template <>
std::vector<PredictionTerm<3>> prediction_of(const SurfaceWavelet& wavelet, const SurfaceWavelet::Odd& odd) {
  std::vector<PredictionTerm<3>> terms;
  for (const auto& [row, weight] : wavelet.block_prediction(odd)) terms.push_back({row, weight});
  if (wavelet.has_blocks()) return terms;
  for (const auto& [row, weight] : odd.prediction()) terms.push_back({row, weight * SquareMatrix<3>::Identity()});
  return terms;
}

template <unsigned N>
Sparse forward_step(const SurfaceWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors<N>(wavelet, level, 1);
  return lift * predict;
}

template <unsigned N>
Sparse backward_step(const SurfaceWavelet& wavelet, std::size_t level) {
  const auto [predict, lift] = factors<N>(wavelet, level, -1);
  return predict * lift;
}

template <unsigned N>
Sparse forward_transform(const SurfaceWavelet& wavelet, std::size_t level) {
  const Eigen::Index size = block_begin<N>(wavelet.row_end(level));
  Sparse all(size, size);
  all.setIdentity();
  for (std::size_t l = level; l > 0; --l) {
    const Sparse step = forward_step<N>(wavelet, l);
    Sparse padded(size, size);
    padded.setIdentity();
    for (Eigen::Index outer = 0; outer < step.outerSize(); ++outer) {
      for (Sparse::InnerIterator it(step, outer); it; ++it) padded.coeffRef(it.row(), it.col()) = it.value();
    }
    all = Sparse(padded * all);
  }
  return all;
}

template <unsigned N>
std::vector<Eigen::MatrixXd> level_compliances(const SurfaceWavelet& wavelet, const Eigen::MatrixXd& compliance) {
  std::vector<Eigen::MatrixXd> levels(wavelet.finest() + 1);
  levels.back() = compliance;
  for (std::size_t level = wavelet.finest(); level > 0; --level) {
    const Sparse step = forward_step<N>(wavelet, level);
    const Eigen::Index evens = block_begin<N>(wavelet.row_end(level - 1));
    levels[level - 1] = Eigen::MatrixXd(step * levels[level] * step.transpose()).topLeftCorner(evens, evens);
  }
  return levels;
}

template <unsigned N>
static std::vector<Eigen::MatrixXd> dense_of(const ModelView& view) {
  const SurfaceWavelet wavelet(view);
  const Eigen::MatrixXd form = stored_form<N>(view);
  std::vector<Eigen::MatrixXd> result;
  for (std::size_t level = 0; level < view.levels; ++level) {
    const Eigen::Index size = block_begin<N>(wavelet.row_end(level));
    Eigen::MatrixXd x = form.topLeftCorner(size, size);
    for (std::size_t l = 1; l <= level; ++l) {
      const Eigen::Index end = block_begin<N>(wavelet.row_end(l));
      const Sparse back = backward_step<N>(wavelet, l);
      x.topRows(end) = Eigen::MatrixXd(back * x.topRows(end));
      x.leftCols(end) = Eigen::MatrixXd(x.leftCols(end) * back.transpose());
    }
    result.push_back(x);
  }
  return result;
}

std::vector<Eigen::MatrixXd> dense_compliances(const ModelView& view) {
  return view.info->components == 1 ? dense_of<1>(view) : dense_of<3>(view);
}

template <unsigned N>
ExactColumns columns_of(const Eigen::MatrixXd& compliance) {
  return [&compliance](std::size_t first, std::size_t count) -> Eigen::MatrixXd {
    return compliance.middleCols(block_begin<N>(first), block_begin<N>(count));
  };
}

template <unsigned N>
ModelData model_of(const Body& body, layout::Wavelet kind, const Encoding& encoding) {
  const SurfaceWavelet wavelet =
      make_wavelet<N>(body.mesh, body.flags, body.area, kind, columns_of<N>(body.compliance));
  ModelData model = describe_mesh(body.mesh, body.flags, body.area, wavelet,
                                  N == 1 ? layout::Problem::scalar : layout::Problem::elastostatic, facts<N>());
  add_representatives(body.mesh, body.flags, model);
  encode_couplings(transform_compliance<N>(wavelet, columns_of<N>(body.compliance), 0.25 * encoding.threshold, {}),
                   encoding, model);
  return model;
}

File::File(const ModelData& model) : ModelFile(encoded_file(model)) {}

template <unsigned N>
layout::Info facts() {
  layout::Info info{};
  if (N == 3) {
    info.young = 1e5;
    info.poisson = 0.3;
  }
  info.rate = 1000;
  info.max_contacts = 64;
  info.step_work = 1'000'000;
  return info;
}

template Sparse forward_step<1>(const SurfaceWavelet&, std::size_t);
template Sparse backward_step<1>(const SurfaceWavelet&, std::size_t);
template Sparse forward_transform<1>(const SurfaceWavelet&, std::size_t);
template std::vector<Eigen::MatrixXd> level_compliances<1>(const SurfaceWavelet&, const Eigen::MatrixXd&);
template ExactColumns columns_of<1>(const Eigen::MatrixXd&);
template ModelData model_of<1>(const Body&, layout::Wavelet, const Encoding&);
template layout::Info facts<1>();

template Sparse forward_step<3>(const SurfaceWavelet&, std::size_t);
template Sparse backward_step<3>(const SurfaceWavelet&, std::size_t);
template Sparse forward_transform<3>(const SurfaceWavelet&, std::size_t);
template std::vector<Eigen::MatrixXd> level_compliances<3>(const SurfaceWavelet&, const Eigen::MatrixXd&);
template ExactColumns columns_of<3>(const Eigen::MatrixXd&);
template ModelData model_of<3>(const Body&, layout::Wavelet, const Encoding&);
template layout::Info facts<3>();

}  // namespace greenloop::offline::test
