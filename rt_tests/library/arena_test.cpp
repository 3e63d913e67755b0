// What a body takes of memory, against what it took when this was written: growth is to be noticed, and meant.
#include <doctest/doctest.h>

#include "formats/testing/synthetic_model.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr double margin = 1.02;  // of the recorded bytes, for what does not depend on the model

struct Recorded {
  SyntheticOptions model;
  Elastostatic::Limits limits;
  std::size_t bytes;
};

TEST_CASE("arenas are not larger than recorded") {
  const Recorded all[] = {
      {{.levels = 4}, {.max_contacts = 16, .cached_factors = 8}, 384640},
      {{.levels = 5}, {.max_contacts = 16, .cached_factors = 8}, 1280384},
      {{.levels = 5}, {.max_contacts = 64, .cached_factors = 8}, 2626880},
      {{.levels = 5, .wavelet = layout::Wavelet::lifted_butterfly}, {.max_contacts = 16, .cached_factors = 8}, 1344448},
      {{.levels = 5, .wavelet = layout::Wavelet::equilibrated}, {.max_contacts = 16, .cached_factors = 8}, 1777088},
  };
  for (const Recorded& recorded : all) {
    const TestModel model(recorded.model);
    const std::size_t bytes = Elastostatic::required(model.model(), recorded.limits).bytes;
    CAPTURE(model.model().node_count());
    CAPTURE(recorded.limits.max_contacts);
    CHECK(static_cast<double>(bytes) <= margin * static_cast<double>(recorded.bytes));
    CHECK(static_cast<double>(recorded.bytes) <= margin * static_cast<double>(bytes));
  }
}

}  // namespace
}  // namespace greenloop
