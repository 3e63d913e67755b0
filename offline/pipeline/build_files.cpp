#include "offline/pipeline/build_files.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "offline/pipeline/body_problem.hpp"

namespace greenloop::offline {
namespace {

/// Its name was not asked for: what somebody else wrote stays.
void require_replaceable_record(const std::filesystem::path& record) {
  if (!std::filesystem::is_regular_file(record)) return;
  const auto found = nlohmann::json::parse(read_text(record), nullptr, false);
  if (found.is_object() && found.contains("solve")) return;
  throw std::runtime_error(record.string() +
                           ": the record of the build goes there, but the file is none; name another model with -o");
}

}  // namespace

bool is_passed_on(const BuildRequest& request) { return is_special(request.model); }

void require_build_files(const BuildRequest& request, const Scene& scene) {
  CommandFiles files{.inputs = {{"the scene", request.scene}, {"the mesh", scene.mesh.path}},
                     .outputs = {{"the model", request.model}, {"the store", request.store}}};
  for (const char* part : {".node", ".ele"}) {  // of one volume
    const auto beside = std::filesystem::path(scene.mesh.path).replace_extension(part);
    if (std::filesystem::exists(beside)) files.inputs.push_back({"a part of the mesh", beside});
  }
  if (!is_passed_on(request)) files.outputs.push_back({"the record of the build", build_record_path(request.model)});
  require_writable(files);
  if (is_special(request.store)) {
    throw std::runtime_error(request.store.string() + ": a store must be a file; name one with --store");
  }
  if (!is_passed_on(request)) require_replaceable_record(build_record_path(request.model));
}

}  // namespace greenloop::offline
