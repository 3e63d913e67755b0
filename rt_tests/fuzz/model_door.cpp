#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "rt_tests/fuzz/doors.hpp"
#include "rt_tests/fuzz/walk_view.hpp"

namespace greenloop {
namespace {

class ModelDoor final : public Door {
 public:
  ModelDoor() {
    ModelData measured = synthetic_model({.levels = 2});
    for (LevelData& level : measured.levels) level.patterns = synthetic_patterns();
    seeds_ = {encode(smallest_model()),
              encode(smallest_scalar_model()),
              encode(synthetic_model({.levels = 2, .vertices = 4})),
              encode(synthetic_model({.levels = 2, .gravity = true, .pressures = 2})),
              encode(synthetic_model({.levels = 3, .epsilon = 0.02, .touchable_above = 0.5})),
              encode(synthetic_model({.levels = 2, .wavelet = layout::Wavelet::equilibrated})),
              encode(crowded_model(8, 4)),
              encode(synthetic_motion({.vertices = 20, .orbits = 4, .rows = 6})),
              encode(synthetic_motion({.vertices = 40, .planes = 2, .orbits = 4, .rows = 5, .alternating = true})),
              encode(synthetic_motion({.vertices = 20, .orbits = 4, .rows = 6, .transfer_modes = 2})),
              encode(measured),
              encode(synthetic_multigrid({}))};
  }

  bool try_one(Random& random) override {
    Bytes file = one_of(random, seeds_);
    mutate_bytes(random, 1024, file);
    return try_input(file).accepted;
  }

 private:
  std::vector<Bytes> seeds_;
};

}  // namespace

std::unique_ptr<Door> model_door() { return std::make_unique<ModelDoor>(); }

}  // namespace greenloop
