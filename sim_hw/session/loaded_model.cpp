#include "sim_hw/session/loaded_model.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {

LoadedModel load_model(const std::filesystem::path& file) {
  LoadedModel loaded{load_file(file), {}};
  const auto opened = Model::open(loaded.bytes.span());
  if (!opened) throw std::runtime_error(file.string() + ": " + describe(opened.result));
  loaded.model = opened.model;
  return loaded;
}

LoadedBody create_body(const Model& model, const Elastostatic::Limits& limits) {
  LoadedBody loaded{AlignedBytes(Elastostatic::required(model, limits).bytes), {}};
  const auto created = Elastostatic::create(model, limits, {loaded.arena.data(), loaded.arena.size()});
  if (!created) {
    throw std::runtime_error("body: limits of " + std::to_string(limits.max_contacts) + " contacts and " +
                             std::to_string(limits.cached_factors) + " cached factors are refused");
  }
  loaded.body = created.body;
  return loaded;
}

}  // namespace greenloop
