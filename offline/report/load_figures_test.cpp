#include "offline/report/load_figures.hpp"

#include <doctest/doctest.h>

#include <string>

#include "formats/testing/dense_wavelet.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "offline/report/model_surface.hpp"

namespace greenloop::offline {
namespace {

ModelMutant model_of(const ModelData& data) {
  ModelMutant mutant(encode(data));
  REQUIRE(mutant.verdict().ok());
  return mutant;
}

}  // namespace

TEST_CASE("loads: the displacement of every node follows from the coefficients") {
  for (const layout::Wavelet kind : layout::wavelets) {
    const ModelData data = synthetic_model({.levels = 3, .wavelet = kind, .gravity = true});
    const ModelMutant mutant = model_of(data);
    const ModelView& view = mutant.view();
    const auto moved = load_displacement(view, 1);
    REQUIRE(moved.size() == view.node_count);
    const DenseWavelet wavelet(data);
    Eigen::MatrixXd x(wavelet.rows(2), 1);
    for (std::uint32_t q = 0; q < 3; ++q) {
      const Eigen::Index count = wavelet.rows(q) - 3 * wavelet.begin(q);
      x.block(3 * wavelet.begin(q), 0, count, 1) =
          Eigen::Map<const Eigen::VectorXf>(view.level[q].load_column(1), count).cast<double>();
    }
    for (std::uint32_t q = 1; q < 3; ++q) wavelet.inverse(q, x.topRows(wavelet.rows(q)));
    for (std::uint32_t node = 0; node < view.node_count; ++node) {
      const Eigen::Index place = wavelet.domain_index(node);
      const Eigen::Vector3d expected =
          place < 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(x.block(3 * place, 0, 3, 1));
      CHECK((moved[node] - expected).norm() <= 1e-9 * x.cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE("loads: a picture each, the first six of more, with their names") {
  const ModelMutant mutant = model_of(synthetic_model({.levels = 2, .gravity = true, .pressures = 4}));
  const VisibleSurface finest = model_surface(mutant.view()).level(1);
  const Figure figure = loads_figure(mutant.view(), finest);
  REQUIRE(figure.panels.size() == 6);
  CHECK(figure.caption.find("The first 6 of 7 loads.") != std::string::npos);
  CHECK(figure.panels[2].str().find(">acceleration along z, 9.81\u202fm/s²<") != std::string::npos);
  CHECK(figure.panels[5].str().find(">pressure 2, 1\u202fkPa<") != std::string::npos);
}

}  // namespace greenloop::offline
