#pragma once

#include <cstddef>

#include "offline/compress/model_builder.hpp"
#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline::test {

/// What a scene asks for by itself.
inline constexpr Accuracy default_accuracy{.rms = 0.02, .worst_column = 0.1, .patch_force = 0.05};

/// A body's model, and what is measured on its bytes rather than taken from its report.
struct MeasuredModel {
  BuiltModel built;
  double patch_force = 0;  ///< worst relative force error of all patches
  bool certified = false;  ///< check_certificate with the file's lambda_min
  bool definite = false;   ///< dense Cholesky factorisation of what the file stands for
};
[[nodiscard]] MeasuredModel measure_model(const Body& body, layout::Wavelet wavelet = layout::Wavelet::lifted_linear);

}  // namespace greenloop::offline::test
