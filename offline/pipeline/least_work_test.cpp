// What a body needs at least is known before its columns are: never more than what its model declares.

#include "offline/pipeline/least_work.hpp"

#include <doctest/doctest.h>

#include <string>

#include "formats/write/writer.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/compress/wavelet_choice.hpp"

namespace greenloop::offline {
namespace {

constexpr std::uint32_t contacts = 9;

TEST_CASE("the bound before anything is computed is below what models of every wavelet declare") {
  const test::Body body = test::make_body(3);
  const std::uint64_t bound = least_work_bound(body.mesh, body.flags, body.area, contacts, 0);
  CHECK(bound > 0);
  CHECK(least_work_bound(body.mesh, body.flags, body.area, 2 * contacts, 0) > bound);
  CHECK(least_work_bound(body.mesh, body.flags, body.area, contacts, 1) > bound);
  for (const layout::Wavelet wavelet : layout::wavelets) {
    ModelData model = test::model_of<3>(body, wavelet, {.threshold = 0.01, .quantum = 0.001});
    model.info.max_contacts = contacts;
    CAPTURE(static_cast<int>(wavelet));
    CHECK(least_work(encode(model)) >= bound);
  }
}

Scene scene_with(const std::string& budget) {
  return parse_scene(
      "[surface]\nfile = \"bear.off\"\nunit = \"cm\"\n[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
      "[[fixed]]\nbelow = 0.1\naxis = \"y\"\n[budget]\n" +
          budget,
      "bear.toml");
}

std::string refusal(const std::string& budget, std::uint64_t least, LeastOf models = LeastOf::any_wavelet) {
  try {
    require_work(scene_with(budget), "bear.toml", least, models);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

TEST_CASE("a budget that cannot hold the least answer is refused by file, key, value and what mends it") {
  CHECK(refusal("work = 999\n", 1000) ==
        "bear.toml: budget.work: 999 units a step; 16 contacts need at least 1000, at the coarsest level; raise work "
        "or lower contacts");
  CHECK(refusal("work = 999\n", 1000, LeastOf::this_wavelet) ==
        refusal("work = 999\n", 1000) + "; another [compression] wavelet may need less");
  CHECK(refusal("rate = \"4 kHz\"\nshare = 0.4\nunits_per_us = 2000\ncontacts = 5\n", 200001) ==
        "bear.toml: budget.share: 0.4 of a period of 4000 Hz is 100 us, 200000 work units at 2000 units per us; 5 "
        "contacts need at least 200001, at the coarsest level; raise share, lower rate or contacts, or state with "
        "units_per_us how much faster the target is");
}

TEST_CASE("a budget that holds the least answer is not refused, nor where the build chooses") {
  CHECK(refusal("work = 1000\n", 1000).empty());
  CHECK(refusal("rate = \"4 kHz\"\nshare = 0.4\nunits_per_us = 2000\n", 200000).empty());
  CHECK(refusal("rate = \"1 MHz\"\n", std::uint64_t{1} << 50).empty());
}

}  // namespace
}  // namespace greenloop::offline
