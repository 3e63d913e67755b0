#include <doctest/doctest.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/figures/column_form.hpp"
#include "offline/figures/exact_body.hpp"
#include "offline/pipeline/build_model_file.hpp"

namespace greenloop::offline {
namespace {

constexpr int levels = 2;

struct ProgramRun {
  int status = -1;
  std::string output;  // with what went to standard error, if that was asked for
};

ProgramRun run(const std::string& arguments) {
  std::string command = "\"" GREENLOOP_COLUMNS "\" ";
  command += arguments;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("popen failed");
  ProgramRun result;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) result.output += static_cast<char>(c);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.status = WEXITSTATUS(status);
  return result;
}

// a folder with a smooth body of 162 vertices and its scene
class Folder {
 public:
  Folder() {
    std::filesystem::create_directories(path_);
    const SemiRegularMesh blob = test::blob(levels);
    write_surface(path_ / "blob.off", {blob.positions, triangles_of_level(blob, levels)});
    std::ofstream(scene()) << "[surface]\nfile = \"blob.off\"\nsize = \"10 cm\"\n"
                              "[remesh]\nbase_vertices = 12\nlevels = 2\n"
                              "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                              "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n"
                              "[compression]\nwavelet = \"lifted linear\"\n";
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }

  [[nodiscard]] std::filesystem::path scene() const { return path_ / "blob.toml"; }
  [[nodiscard]] std::filesystem::path records() const { return path_ / "columns.csv"; }
  [[nodiscard]] std::filesystem::path model() const { return path_ / "blob.gloop"; }
  [[nodiscard]] std::filesystem::path store() const { return path_ / "blob.h5"; }
  [[nodiscard]] std::string arguments() const {
    return fmt::format("\"{}\" --records \"{}\" --epsilon 0.02 0.05 0.2 ", scene().string(), records().string());
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("greenloop_columns_test_" + std::to_string(getpid()));
};

std::vector<RatePoint> rates_of_store(const Folder& folder) {
  ProgressBar quiet(true);
  build_model_file({.scene = folder.scene(), .model = folder.model(), .store = folder.store()}, quiet);
  return column_form_rates(open_body(folder.store()), wavelet_kinds[3], {0.02, 0.05, 0.2}, {}).back().points;
}

// as a process killed while it writes a record leaves the file
void cut_last_line(const std::filesystem::path& file) {
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
}

TEST_CASE("columns: killed and taken up again, the program finds what the store of the same body tells") {
  const Folder folder;
  const ProgramRun part = run(folder.arguments() + "--columns 60 --json");
  REQUIRE(part.status == 0);
  const auto sample = nlohmann::json::parse(part.output);
  CHECK(sample["columns"] >= 50);
  CHECK(sample["columns"] < sample["free_nodes"]);
  CHECK(sample["points"][0]["ratio_standard_error"] > 0);

  cut_last_line(folder.records());
  const ProgramRun whole = run(folder.arguments() + "--columns 1000 --json");
  REQUIRE(whole.status == 0);
  const auto all = nlohmann::json::parse(whole.output);
  CHECK(all["columns"] == all["free_nodes"]);
  const auto expected = rates_of_store(folder);
  REQUIRE(all["points"].size() == expected.size());
  for (std::size_t t = 0; t < expected.size(); ++t) {
    const auto& point = all["points"][t];
    CHECK(point["threshold"] == expected[t].threshold);
    CHECK(point["ratio"].get<double>() == doctest::Approx(expected[t].ratio).epsilon(1e-9));
    CHECK(point["rms_error"].get<double>() == doctest::Approx(expected[t].rms).epsilon(1e-9));
    CHECK(point["max_error"].get<double>() == doctest::Approx(expected[t].worst_column).epsilon(1e-9));
    CHECK(point["ratio_standard_error"] == 0);
  }

  const std::string table = run(folder.arguments() + "--columns 1000 2>&1").output;
  CHECK(table.find("one-sided, lifted linear") != std::string::npos);
  CHECK(table.find("tetrahedra") == std::string::npos);  // every column is in the records
  const ProgramRun other = run(folder.arguments() + "--wavelet linear 2>&1");
  CHECK(other.status == 1);
  CHECK(other.output.find("columns of another body or wavelet") != std::string::npos);
}

TEST_CASE("columns: an unknown wavelet and a missing scene are refused by name") {
  const Folder folder;
  const ProgramRun wavelet = run(folder.arguments() + "--wavelet haar 2>&1");
  CHECK(wavelet.status == 1);
  CHECK(wavelet.output.find("--wavelet haar: there is no such wavelet") != std::string::npos);
  CHECK(run("none.toml --records none.csv 2>&1").output.find("none.toml") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
