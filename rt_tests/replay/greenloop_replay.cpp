// greenloop-replay: runs the steps that a Recorder kept again, on the model they were taken on, and compares every bit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/model_file.hpp"
#include "rt_tests/replay/replay.hpp"

namespace {

std::vector<char> read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + ": cannot be opened");
  return {std::istreambuf_iterator<char>(stream), {}};
}

void print(const greenloop::Replay& replay) {
  fmt::print("steps {} to {}: {}\n", replay.first, replay.first + replay.steps - 1,
             replay.differs ? fmt::format("step {} came out DIFFERENT", *replay.differs) : "the SAME bits");
  if (replay.unfinished) fmt::print("the last one did not come back when it was recorded; here it did\n");
}

nlohmann::json json(const greenloop::Replay& replay) {
  return {{"verdict", replay.differs ? "VIOLATED" : "HELD"},
          {"first", replay.first},
          {"steps", replay.steps},
          {"same", !replay.differs},
          {"differs", replay.differs ? nlohmann::json(*replay.differs) : nlohmann::json()},
          {"unfinished", replay.unfinished}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Runs the steps that a greenloop::Recorder kept again and compares what comes of them, bit for bit.",
               "greenloop-replay");
  std::string record, model;
  bool as_json = false;
  app.add_option("RECORD", record, "file with the bytes of Recorder::record")->required()->check(CLI::ExistingFile);
  app.add_option("MODEL", model, "model file (.gloop) of the recorded body")->required()->check(CLI::ExistingFile);
  app.add_flag("--json", as_json, "machine-readable result");
  return greenloop::run_program(app, argc, argv, [&] {
    const std::vector<char> bytes = read_bytes(record);
    const auto replay = greenloop::replay(std::as_bytes(std::span(bytes)), greenloop::load_file(model).span());
    if (as_json) {
      greenloop::print_result(greenloop::json_text(json(replay)) + "\n");
    } else {
      print(replay);
    }
    return replay.differs ? 1 : 0;
  });
}
