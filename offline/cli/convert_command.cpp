#include "offline/cli/convert_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/model_surface.hpp"
#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/volume_io.hpp"
#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/streams.hpp"
#include "formats/transport/stream.hpp"
#include "formats/write/c_array.hpp"
#include "formats/write/model_file.hpp"
#include "formats/write/ready_file.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/encode/ready_model.hpp"
#include "offline/pipeline/mesh_series_file.hpp"
#include "offline/scene/mesh_series.hpp"

namespace greenloop::offline {
namespace {

bool is_model(const std::string& extension) { return extension == ".gloop"; }
bool is_stream(const std::string& extension) { return extension == ".gloopz"; }
bool is_c_source(const std::string& extension) { return extension == ".h" || extension == ".c"; }
bool is_surface(const std::string& extension) {
  constexpr std::array surfaces{".off", ".obj", ".stl", ".ply"};
  return std::find(surfaces.begin(), surfaces.end(), extension) != surfaces.end();
}
bool is_volume(const std::string& extension) {
  constexpr std::array volumes{".msh", ".mesh", ".meshb", ".vtk", ".vtu", ".node", ".ele", ".veg"};
  return std::find(volumes.begin(), volumes.end(), extension) != volumes.end();
}

[[noreturn]] void refuse(const ConvertArguments& arguments, const std::string& why) {
  throw std::runtime_error(
      fmt::format("convert {} to {}: {}", arguments.input.string(), arguments.output.string(), why));
}

void check_levels(const ConvertArguments& arguments, std::uint32_t available) {
  if (arguments.levels && (*arguments.levels < 1 || *arguments.levels > available)) {
    refuse(arguments,
           fmt::format("--levels {}, but the model has {}: name 1 to {}", *arguments.levels, available, available));
  }
}

ModelFile read_stream(const ConvertArguments& arguments) {
  const AlignedBytes stream = load_file(arguments.input);
  transport::UnpackedModel unpacked;
  const auto result = transport::unpack(stream.span(), unpacked, arguments.levels.value_or(transport::all_levels));
  const std::uint32_t whole = unpacked.levels, all = unpacked.stream_levels;
  if (result.rule == transport::StreamRule::truncated) {
    refuse(arguments,
           whole == 0
               ? fmt::format("THE STREAM IS TRUNCATED before its coarsest model is whole ({}); fetch the rest",
                             describe(result))
               : fmt::format("THE STREAM IS TRUNCATED after level {}: {} of {} mesh levels are whole ({}); fetch "
                             "the rest, or take the coarser model with --levels {}",
                             whole - 1, whole, all, describe(result), whole));
  }
  if (!result.ok()) refuse(arguments, describe(result));
  check_levels(arguments, all);
  return verified_model(AlignedBytes(unpacked.model), arguments.input.string());
}

ModelFile read_levels(const ConvertArguments& arguments) {
  if (is_stream(lower_extension(arguments.input))) return read_stream(arguments);
  ModelFile model = open_model_file(arguments.input);
  check_levels(arguments, model.view.header->levels);
  if (!arguments.levels) return model;
  const auto whole = model.bytes.span();
  const auto cut = truncate_to_level({whole.begin(), whole.end()}, *arguments.levels - 1);
  return verified_model(AlignedBytes(cut), arguments.output.string());
}

ModelFile read_model(const ConvertArguments& arguments) {
  ModelFile model = read_levels(arguments);
  if (!arguments.ready) return model;
  if (model.view.problem == layout::Problem::impulse_response) {
    refuse(arguments, "an impulse response model has nothing to be made ready; leave --ready and --no-ready out");
  }
  if (model.view.problem == layout::Problem::multigrid) {
    refuse(arguments, "a multigrid model has nothing to be made ready; leave --ready and --no-ready out");
  }
  const auto bytes = *arguments.ready ? ready_model(model.bytes.span()) : plain_file(model.bytes.span());
  return verified_model(AlignedBytes(bytes), arguments.output.string());
}

void convert_model(const ConvertArguments& arguments, const std::string& to) {
  if (lower_extension(arguments.input) == to && !arguments.levels && !arguments.ready) {
    refuse(arguments, "name the mesh levels to keep with --levels, or say --ready or --no-ready");
  }
  if (is_stream(to) && arguments.ready.value_or(false)) {
    refuse(arguments, "a transport form is never ready; leave --ready out, and say it where the form is unpacked");
  }
  const ModelFile model = read_model(arguments);
  if (model.view.problem == layout::Problem::impulse_response && !is_c_source(to) && !is_model(to)) {
    refuse(arguments, "an impulse response model becomes .gloop with --levels, or .h and .c");
  }
  if (model.view.problem == layout::Problem::multigrid && !is_c_source(to)) {
    refuse(arguments, "a multigrid model becomes .h and .c");
  }
  if (is_c_source(to)) {
    write_c_array(arguments.output, model.bytes.span());
  } else if (is_surface(to)) {
    write_surface(arguments.output, finest_surface(model.view));
  } else if (is_model(to)) {
    write_file(arguments.output, model.bytes.span());
  } else if (is_stream(to)) {
    write_file(arguments.output, transport::pack(model.bytes.span()));
  } else {
    refuse(
        arguments,
        "a model becomes .gloopz, .h and .c, .gloop with --levels, --ready or --no-ready, or .off, .obj, .stl, .ply");
  }
}

/// Before any work.
void require_outputs(const ConvertArguments& arguments) {
  CommandFiles files{.inputs = {{"the input", arguments.input}}, .outputs = {{"the output", arguments.output}}};
  for (const char* part : {".node", ".ele"}) {  // of one volume
    const auto beside = std::filesystem::path(arguments.input).replace_extension(part);
    if (std::filesystem::exists(beside)) files.inputs.push_back({"a part of the input", beside});
  }
  if (is_c_source(lower_extension(arguments.output))) {
    const auto [header, source] = c_array_files(arguments.output);
    files.outputs = {{"the header", header}, {"the source", source}};
    require_replaceable(arguments.output);
  }
  require_writable(files);
}

void refuse_model_options(const ConvertArguments& arguments) {
  if (arguments.levels) refuse(arguments, "--levels is for models; leave it out");
  if (arguments.ready) refuse(arguments, "--ready and --no-ready are for models; leave them out");
}

void print_notes(const MeshNotes& notes) {
  for (const std::string& note : notes) fmt::print(std::cerr, "note: {}\n", note);
}

void convert_surface(const ConvertArguments& arguments, const std::string& to) {
  refuse_model_options(arguments);
  if (!is_surface(to)) refuse(arguments, "a surface becomes .off, .obj, .stl or .ply; `greenloop build` makes models");
  MeshNotes notes;
  const TriangleMesh mesh = read_surface(arguments.input, notes);
  print_notes(notes);
  write_surface(arguments.output, mesh);
}

void convert_volume(const ConvertArguments& arguments, const std::string& to) {
  refuse_model_options(arguments);
  if (!is_volume(to)) refuse(arguments, "a volume becomes .msh, .mesh or .vtk");
  MeshNotes notes;
  const TetrahedralMesh mesh = read_volume(arguments.input, notes);
  print_notes(notes);
  write_volume(arguments.output, mesh);
}

bool is_mesh_series(const std::string& from, const std::string& to) { return from == ".toml" && to == ".h5"; }

void convert_mesh_series(const ConvertArguments& arguments) {
  refuse_model_options(arguments);
  MeshNotes notes;
  write_mesh_series(read_mesh_series(arguments.input), arguments.output, notes);
  print_notes(notes);
}

/// All files that came of it.
std::vector<std::filesystem::path> written_files(const ConvertArguments& arguments) {
  if (!is_c_source(lower_extension(arguments.output))) return {arguments.output};
  const auto [header, source] = c_array_files(arguments.output);
  return {header, source};
}

void say_written(const ConvertArguments& arguments, std::ostream& out) {
  if (!arguments.json) {
    fmt::print(out, "wrote {}\n", arguments.output.string());
    return;
  }
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const auto& file : written_files(arguments)) files.push_back(file.string());
  out << json_text(nlohmann::ordered_json{{"input", arguments.input.string()}, {"written", files}}) << '\n';
}

}  // namespace

int run_convert(const ConvertArguments& arguments, std::ostream& out) {
  require_outputs(arguments);
  const std::string from = lower_extension(arguments.input), to = lower_extension(arguments.output);
  if (is_model(from) || is_stream(from)) {
    convert_model(arguments, to);
  } else if (is_mesh_series(from, to)) {
    convert_mesh_series(arguments);
  } else if (is_surface(from) || (from == ".vtk" && is_surface(to))) {
    convert_surface(arguments, to);
  } else if (is_volume(from)) {
    convert_volume(arguments, to);
  } else {
    refuse(arguments,
           fmt::format("do not know \"{}\"; expected a model (.gloop .gloopz), a surface (.off .obj .stl .ply), "
                       "a volume (.msh .mesh .meshb .vtk .vtu .node .ele .veg) or a series of meshes (.toml to .h5)",
                       from));
  }
  say_written(arguments, out);
  return 0;
}

void add_convert(CLI::App& parent, int& exit_code) {
  CLI::App* command = parent.add_subcommand("convert",
                                            "Model to transport form and back, C source, coarser model or surface; "
                                            "meshes to other formats, series of meshes to trajectories");
  const auto arguments = std::make_shared<ConvertArguments>();
  command
      ->add_option("input", arguments->input,
                   "Model (.gloop), its transport form (.gloopz), surface (.off .obj .stl .ply) or volume (.msh .mesh "
                   ".meshb .vtk .vtu .node .ele .veg), or the description of a series of meshes (.toml)")
      ->required();
  command->add_option("-o,--output", arguments->output, "File to write; its extension says what")->required();
  command->add_option(
      "--levels", arguments->levels,
      "Keep this many mesh levels of the model, coarsest first; of a transport form the rest is not read");
  CLI::Option* const ready = command->add_flag_callback(
      "--ready", [arguments] { arguments->ready = true; },
      "Of a model: add what a loop would make of it at its start, to be read in place");
  command
      ->add_flag_callback(
          "--no-ready", [arguments] { arguments->ready = false; }, "Of a model: leave that out")
      ->excludes(ready);
  command->add_flag("--json", arguments->json, "Print what was written as JSON");
  command->callback([arguments, &exit_code] {
    std::ostringstream out;
    exit_code = run_convert(*arguments, out);
    print_result(out.str());
  });
}

}  // namespace greenloop::offline
