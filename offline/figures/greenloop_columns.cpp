#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "formats/store/green_store.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/figures/column_form.hpp"
#include "offline/figures/column_records.hpp"
#include "offline/figures/column_sample.hpp"
#include "offline/pipeline/body_problem.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/sources/fem/fem_source.hpp"

namespace {

using namespace greenloop;
using namespace greenloop::offline;

struct Arguments {
  std::filesystem::path scene, records;
  std::size_t columns = 1024;
  std::string wavelet = "lifted linear";
  std::vector<double> thresholds = {0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5};
  bool json = false;
};

layout::Wavelet wavelet_of(const std::string& name) {
  for (const WaveletKind& kind : wavelet_kinds) {
    if (kind.name == name) return kind.wavelet;
  }
  throw std::invalid_argument("--wavelet " + name + ": there is no such wavelet for columns by themselves; there are " +
                              "linear, butterfly, lifted butterfly and lifted linear");
}

// A body whose Green's functions are solved, measured and forgotten.
class StreamedBody {
 public:
  StreamedBody(const Arguments& arguments, ProgressBar& progress)
      : arguments_(arguments),
        progress_(progress),
        scene_(read_scene(arguments.scene)),
        geometry_(make_body_geometry(scene_, progress)),
        fingerprint_(column_fingerprint(scene_, mesh_bytes(scene_))),
        wavelet_(geometry_.surface, geometry_.flags, geometry_.area, wavelet_of(arguments.wavelet)),
        strata_(stratified_sample(wavelet_, arguments.columns)),
        compression_(wavelet_, arguments.thresholds),
        records_(arguments.records, fingerprint_ + " " + arguments.wavelet, arguments.thresholds) {}

  void measure() {
    std::vector<std::size_t> missing = interleaved(strata_);
    missing.erase(std::remove_if(missing.begin(), missing.end(), [&](std::size_t row) { return records_.has(row); }),
                  missing.end());
    if (missing.empty()) return;
    const GreenStoreContents problem = describe_problem(scene_, geometry_, fingerprint_, progress_);
    progress_.begin("factorise");
    FemSource source(fem_problem(problem));
    progress_.end(fmt::format("{} unknowns, {:.3g} factor entries", source.unknowns(),
                              static_cast<double>(source.factor_entries())));
    progress_.begin("columns");
    for (std::size_t done = 0; done < missing.size();) {
      const std::size_t count = std::min(source.columns_at_once(), missing.size() - done);
      measure(source, std::span(missing).subspan(done, count));
      done += count;
      progress_.update(static_cast<double>(done) / static_cast<double>(missing.size()));
    }
    progress_.end(fmt::format("{} solved", missing.size()));
  }

  [[nodiscard]] std::vector<SampledRate> rates() const {
    std::vector<std::vector<CompressedColumn>> columns;
    for (const Stratum& stratum : strata_) {
      columns.emplace_back();
      for (const std::size_t row : stratum.rows) columns.back().push_back(records_.at(row));
    }
    return estimate_rates(strata_, columns, arguments_.thresholds);
  }

  [[nodiscard]] std::size_t rows() const { return wavelet_.rows(); }
  [[nodiscard]] std::size_t sampled() const {
    std::size_t count = 0;
    for (const Stratum& stratum : strata_) count += stratum.rows.size();
    return count;
  }

 private:
  void measure(ColumnSource& source, std::span<const std::size_t> rows) {
    const Eigen::MatrixXd solved = source.read(std::vector<int>(rows.begin(), rows.end()));
    for (std::size_t j = 0; j < rows.size(); ++j) {
      std::vector<double> column = blocks_of(solved, j);
      for (double& value : column) value *= geometry_.area[wavelet_.nodes()[rows[j]]];  // traction form
      records_.add(rows[j], compression_.compress(column));
    }
  }

  const Arguments& arguments_;
  ProgressBar& progress_;
  Scene scene_;
  BodyGeometry geometry_;
  std::string fingerprint_;
  SurfaceWavelet wavelet_;
  std::vector<Stratum> strata_;
  ColumnCompression compression_;
  ColumnRecords records_;
};

void print_json(const Arguments& arguments, const StreamedBody& body) {
  nlohmann::json points = nlohmann::json::array();
  for (const auto& [point, ratio_error, rms_error] : body.rates()) {
    points.push_back({{"threshold", point.threshold},
                      {"ratio", point.ratio},
                      {"ratio_standard_error", point.ratio * ratio_error},
                      {"rms_error", point.rms},
                      {"rms_standard_error", point.rms * rms_error},
                      {"max_error", point.worst_column}});
  }
  print_result(json_text(nlohmann::json{{"body", arguments.scene.stem().string()},
                                        {"free_nodes", body.rows()},
                                        {"columns", body.sampled()},
                                        {"wavelet", arguments.wavelet},
                                        {"points", points}}) +
               "\n");
}

void print_table(const Arguments& arguments, const StreamedBody& body) {
  print_result(fmt::format("{}: {} free nodes, {} columns measured, one-sided, {}; +- one standard error\n",
                           arguments.scene.stem().string(), body.rows(), body.sampled(), arguments.wavelet));
  fmt::print("  {:>8} {:>18} {:>22} {:>8}\n", "epsilon", "times fewer blocks", "RMS", "MAX");
  for (const auto& [point, ratio_error, rms_error] : body.rates()) {
    fmt::print("  {:>8} {:>18} {:>22} {:>8}\n", point.threshold,
               fmt::format("{:.1f} +- {:.1f}", point.ratio, point.ratio * ratio_error),
               fmt::format("{:.3f} % +- {:.3f} %", 100 * point.rms, 100 * point.rms * rms_error),
               fmt::format("{:.2f} %", 100 * point.worst_column));
  }
}

int run(const Arguments& arguments) {
  (void)wavelet_of(arguments.wavelet);  // before the body is made
  require_writable({.inputs = {{"the scene", arguments.scene}, {"its mesh", read_scene(arguments.scene).mesh.path}},
                    .outputs = {{"the records", arguments.records}}});
  ProgressBar progress(arguments.json);
  StreamedBody body(arguments, progress);
  body.measure();
  if (arguments.json) {
    print_json(arguments, body);
  } else {
    print_table(arguments, body);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures the one-sided compression of James and Pai 2003 on a body too large for a store: Green's functions are "
      "solved, compressed, compared and forgotten, block by block, all of them or a sample. Needs memory for the "
      "factor (3.4 GB for 40,962 vertices), and disk only for the records; a run that was killed goes on where it "
      "stopped.",
      "greenloop-columns");
  Arguments arguments;
  app.add_option("scene", arguments.scene, "scene.toml")->required()->check(CLI::ExistingFile);
  app.add_option("--records", arguments.records,
                 "CSV file of the columns measured, one by one; what is in it already is not solved again")
      ->required();
  app.add_option("--columns", arguments.columns, "About how many columns to measure, spread over every mesh level")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  app.add_option("--wavelet", arguments.wavelet, "linear, butterfly, lifted butterfly or lifted linear")
      ->capture_default_str();
  app.add_option("--epsilon", arguments.thresholds, "Thresholds, increasing")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON");
  return greenloop::run_program(app, argc, argv, [&] { return run(arguments); });
}
