#include "sim_hw/session/loaded_model.hpp"

#include <stdexcept>
#include <utility>

#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"

namespace greenloop {

LoadedModel load_model(const std::filesystem::path& file, layout::Problem problem) {
  LoadedModel loaded{load_file(file), {}};
  const auto opened = Model::open(loaded.bytes.span());
  if (!opened) throw std::runtime_error(file.string() + ": " + describe(opened.result));
  require_problem(opened.model.view(), problem, file);
  loaded.model = opened.model;
  return loaded;
}

layout::Problem problem_of(const std::filesystem::path& file) {
  const AlignedBytes bytes = load_file(file);
  const auto opened = Model::open(bytes.span());
  return opened ? opened.model.problem() : layout::Problem::elastostatic;
}

}  // namespace greenloop
