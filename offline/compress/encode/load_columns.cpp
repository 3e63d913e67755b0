#include "offline/compress/encode/load_columns.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "formats/write/model_file.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {
namespace {

// the wavelet coefficients of displacement fields, by row, then by field
std::vector<double> coefficients(const SurfaceWavelet& wavelet, const Eigen::MatrixXd& displacement) {
  const auto fields = static_cast<std::size_t>(displacement.cols()), width = 3 * fields;
  std::vector<double> x(width * wavelet.rows());
  for (std::size_t row = 0; row < wavelet.rows(); ++row) {
    for (std::size_t k = 0; k < width; ++k) {
      x[width * row + k] = displacement(static_cast<Eigen::Index>(3 * row + k % 3), static_cast<Eigen::Index>(k / 3));
    }
  }
  for (std::size_t level = wavelet.finest(); level > 0; --level) wavelet.split(level, width, x.data());
  return x;
}

}  // namespace

void add_loads(std::vector<layout::LoadRecord> loads, const Eigen::MatrixXd& displacement, ModelData& model) {
  const SurfaceWavelet wavelet(encoded_file(model).view);
  if (displacement.rows() != static_cast<Eigen::Index>(3 * wavelet.rows()) ||
      displacement.cols() != static_cast<Eigen::Index>(loads.size())) {
    throw std::invalid_argument("loads: displacements of " + std::to_string(displacement.rows()) + " x " +
                                std::to_string(displacement.cols()) + ", expected " +
                                std::to_string(3 * wavelet.rows()) + " x " + std::to_string(loads.size()));
  }
  const std::vector<double> all = coefficients(wavelet, displacement);
  const std::size_t width = 3 * loads.size();
  std::size_t begin = 0;
  for (std::size_t level = 0; level <= wavelet.finest(); ++level) {
    const std::size_t end = wavelet.row_end(level);
    std::vector<float>& columns = model.levels[level].load_columns;
    columns.clear();
    for (std::size_t load = 0; load < loads.size(); ++load) {
      for (std::size_t row = begin; row < end; ++row) {
        for (std::size_t i = 0; i < 3; ++i) columns.push_back(static_cast<float>(all[width * row + 3 * load + i]));
      }
    }
    begin = end;
  }
  model.loads = std::move(loads);
}

}  // namespace greenloop::offline
