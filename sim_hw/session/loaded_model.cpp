#include "sim_hw/session/loaded_model.hpp"

#include <stdexcept>
#include <utility>

#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {

LoadedModel load_model(const std::filesystem::path& file) {
  LoadedModel loaded{load_file(file), {}};
  const auto opened = Model::open(loaded.bytes.span());
  if (!opened) throw std::runtime_error(file.string() + ": " + describe(opened.result));
  require_problem(opened.model.view(), layout::Problem::elastostatic, file);
  loaded.model = opened.model;
  return loaded;
}

}  // namespace greenloop
