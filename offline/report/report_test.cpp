#include "offline/report/report.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "formats/output/output_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/body_figures.hpp"
#include "offline/report/level_frontiers.hpp"
#include "offline/report/loop_figures.hpp"
#include "offline/report/model_facts.hpp"
#include "offline/report/model_figures.hpp"
#include "offline/report/report_command.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A page without the base64 of its pictures.
std::string without_pictures(std::string page) {
  const std::string begin = "base64,";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at + begin.size())) {
    page.erase(at + begin.size(), page.find('"', at) - at - begin.size());
  }
  return page;
}

/// The synthetic sphere as a file, with a trace and a snapshot of a press on its top and a build record.
struct Sample {
  TemporaryFolder folder{"report_test"};
  std::filesystem::path model = folder.path() / "ball.gloop";
  ModelFile file;

  Sample() {
    write_file(model, encode(synthetic_model({.levels = 3, .coarsest_constraint_level = 1})));
    file = open_model_file(model);
  }
  [[nodiscard]] std::filesystem::path trace(int cycles, std::uint64_t work) const {
    std::string text = "time,x0,y0,z0,force_x0,force_y0,force_z0,force,contacts,level,field_level,work,budget,status\n";
    for (int i = 0; i < cycles; ++i) {
      const double force = 3.0 * i / cycles;
      text += fmt::format("{},0,0,0.1,0,0,{},{},4,{},2,{},1000,ok\n", i * 1e-3, force, force, 1 + i % 2, work);
    }
    return folder.write("trace.csv", text);
  }
  [[nodiscard]] std::filesystem::path snapshot() const {
    std::string text = "node,x,y,z\n";
    for (std::uint32_t node = 0; node < file.view.node_count; ++node) {
      text += fmt::format("{},0,0,{}\n", node, node == 4 ? -0.01 : -0.0001);
    }
    return folder.write("snapshot.csv", text);
  }
  [[nodiscard]] std::filesystem::path build() const {
    return folder.write("build.json", R"({"scene": "ball & <co>", "stages": [{"name": "solve", "seconds": 2}],
      "compression": {"threshold": 0.02, "frontier": [
      {"threshold": 0.01, "rms_error": 0.01, "worst_patch_force_error": 0.03, "bytes": 2000, "step_work": 900,
       "levels": [{"level": 1, "rms_error": 0.01, "bytes": 400, "step_work": 90}]},
      {"threshold": 0.02, "rms_error": 0.02, "worst_patch_force_error": 0.05, "bytes": 1000, "step_work": 500,
       "levels": [{"level": 1, "rms_error": 0.02, "bytes": 300, "step_work": 50}]}]}})");
  }
  [[nodiscard]] Report report(bool complete) const {
    ReportInputs inputs{.model = model, .trace = {}, .snapshot = {}, .build = {}};
    if (complete) inputs = {.model = model, .trace = trace(3000, 900), .snapshot = snapshot(), .build = build()};
    return make_report(file, inputs);
  }
};

}  // namespace

TEST_CASE("records and traces of other models are refused") {
  const Sample sample;
  const auto refusal = [&](const std::filesystem::path& trace, const std::filesystem::path& build) {
    ReportInputs inputs{.model = sample.model, .trace = {}, .snapshot = {}, .build = {}};
    if (!trace.empty()) inputs.trace = trace;
    if (!build.empty()) inputs.build = build;
    return message_of([&] { (void)make_report(sample.file, inputs); });
  };
  const auto other = sample.folder.write("other.build.json", R"({"bytes": 64})");
  CHECK(has(refusal({}, other), "is the record of another model"));
  const auto bytes = std::filesystem::file_size(sample.model);
  CHECK(refusal({}, sample.folder.write("own.build.json", fmt::format(R"({{"bytes": {}}})", bytes))).empty());
  const auto finer = sample.folder.write(
      "finer.csv",
      "time,x0,y0,z0,force_x0,force_y0,force_z0,force,contacts,level,field_level,work,budget,status\n"
      "0,0,0,0,0,0,1,1,1,2,3,10,10,ok\n");
  CHECK(has(refusal(finer, {}), "level 3 in a model of 3"));
}

TEST_CASE("the command writes the complete report and every figure, the same as the library") {
  const Sample sample;
  int exit_code = 1;
  CLI::App app("test", "greenloop");
  add_report(app, exit_code);
  const auto figures = sample.folder.path() / "figures";
  app.parse(fmt::format("report {} --trace {} --snapshot {} --build {} --figures {} --json", sample.model.string(),
                        sample.trace(3000, 900).string(), sample.snapshot().string(), sample.build().string(),
                        figures.string()));
  CHECK(exit_code == 0);
  const Report report = sample.report(true);
  CHECK(content_of(sample.folder.path() / "ball.html") == report.html);
  std::vector<std::string> names;
  for (const Figure& figure : report.figures) {
    CAPTURE(figure.name);
    names.push_back(figure.name);
    const std::string svg = content_of(figures / (figure.name + ".svg"));
    CHECK(svg.starts_with("<?xml"));
    CHECK_FALSE(has(svg, "var("));
  }
  CHECK(names == std::vector<std::string>{"body", "meshes", "force", "work", "levels", "level_errors", "frontier",
                                          "level_frontiers", "bytes", "stages"});
  CHECK(report.missing.empty());
  CHECK(report.html.size() < 2'000'000);
  const std::string text = without_pictures(report.html);
  CHECK(text.size() < report.html.size() - 100'000);
  CHECK(has(text, "ball &amp; &lt;co&gt;"));
  for (const std::string forbidden : {"<script", "<link", "src=", "href=\"http", "url(http", "@import", ">nan", "nan\"",
                                      "nan ", "lnan", "not a number", "inf\""}) {
    CAPTURE(forbidden);
    CHECK_FALSE(has(text, forbidden));
  }
}

TEST_CASE("forces of other runs and a stability map stand in the report where they are given") {
  const Sample sample;
  int exit_code = 1;
  CLI::App app("test", "greenloop");
  add_report(app, exit_code);
  const auto slide = sample.folder.path() / "slide.csv";
  std::filesystem::copy_file(sample.trace(100, 900), slide);
  const auto map = sample.folder.write("map.csv", "rate,delay,stiffness,bound,stable\n500,0,100,200,1\n");
  const auto figures = sample.folder.path() / "figures";
  app.parse(fmt::format("report --trace {} --trace {} --stability {} --figures {} {}", sample.trace(100, 900).string(),
                        slide.string(), map.string(), figures.string(), sample.model.string()));
  CHECK(exit_code == 0);
  const std::string page = content_of(sample.folder.path() / "ball.html");
  CHECK(has(page, "Force over time: slide"));
  CHECK(has(page, "Stability over stiffness"));
  for (const char* name : {"force.svg", "force_slide.svg", "stability.svg"}) {
    CHECK(std::filesystem::exists(figures / name));
  }
}

TEST_CASE("what is missing is named with the command that makes it, and nothing stands in for it") {
  const Sample sample;
  const Report report = sample.report(false);
  REQUIRE(report.missing.size() == 3);
  CHECK(has(report.missing[0].command, "greenloop-loop " + sample.model.string() + " --trace trace.csv --snapshot"));
  CHECK(has(report.missing[2].command, "greenloop build"));
  CHECK(has(report.missing[2].command, "ball.build.json"));
  CHECK(has(report.html, "Not in this report"));
  for (const char* name :
       {"id=\"body\"", "id=\"force\"", "id=\"work\"", "id=\"levels\"", "id=\"frontier\"", "missed cycles"}) {
    CAPTURE(name);
    CHECK_FALSE(has(report.html, name));
  }
  CHECK(has(report.html, "id=\"meshes\""));
}

TEST_CASE("a build record without a frontier is missing its frontier only") {
  const Sample sample;
  const auto build = sample.folder.write("build.json", "{}");
  const auto report = make_report(sample.file, {.model = sample.model, .trace = {}, .snapshot = {}, .build = build});
  REQUIRE(report.missing.size() == 3);
  CHECK(has(report.missing[2].what, "no frontier"));
}

TEST_CASE("misses are said and crossed") {
  const Sample sample;
  const auto late = load_trace(sample.trace(100, 1001));
  CHECK(has(work_figure(late).caption, "100 of 100 cycles missed"));
  CHECK(has(work_figure(late).svg(), "missed (100)"));
  const auto punctual = load_trace(sample.trace(100, 1000));
  CHECK(has(work_figure(punctual).caption, "No miss in 100 cycles"));
  CHECK_FALSE(has(work_figure(punctual).svg(), "missed"));
}

TEST_CASE("work that is a small part of the budget is on a logarithmic scale") {
  const Sample sample;
  const auto small = load_trace(sample.trace(100, 3));
  CHECK(has(work_figure(small).caption, "on a logarithmic scale"));
  CHECK(has(work_figure(small).caption, "a unit is an instruction"));
  for (const char* tick : {">work [10³ units]<", ">0.01<", ">0.1<", ">1<"}) CHECK(has(work_figure(small).svg(), tick));
  CHECK_FALSE(has(work_figure(load_trace(sample.trace(100, 900))).caption, "logarithmic"));
  CHECK_FALSE(has(work_figure(load_trace(sample.trace(100, 0))).svg(), "nan"));
}

TEST_CASE("every text of a panel is 14 pixels high on a telephone of 400") {
  const Sample sample;
  constexpr double shown = 376;  // pixels that the page's margins leave
  for (const Figure& figure : sample.report(true).figures) {
    CAPTURE(figure.name);
    for (const SvgCanvas& panel : figure.panels) {
      CHECK(panel.width() == panel_width);
      const std::string text = panel.str(), size = "font-size=\"";
      for (std::size_t at = text.find(size); at != std::string::npos; at = text.find(size, at + 1)) {
        CHECK(std::stod(text.substr(at + size.size(), 8)) * shown / panel_width >= 13.9);
      }
    }
  }
}

TEST_CASE("how a model was built is shown on request only") {
  const TemporaryFolder folder("report_test");
  ModelData data = synthetic_model({.levels = 2});
  data.provenance = R"({"tool": "a hammer", "mesh_error": {"force": 0.4, "patches": [
    {"axis": "z", "center": [0.01, 0, -0.002], "error": 0.4}, {"axis": 7, "error": 0.2}, 3, {"error": "x"}]}})";
  write_file(folder.path() / "told.gloop", encode(data));
  const ModelFile file = open_model_file(folder.path() / "told.gloop");
  const auto page = [&](bool provenance) {
    return make_report(file, {.model = "m", .trace = {}, .snapshot = {}, .build = {}, .provenance = provenance}).html;
  };
  CHECK(has(page(true), "a hammer"));
  CHECK_FALSE(has(page(false), "a hammer"));
  const Table mesh = mesh_error_table(file.view);
  REQUIRE(mesh.rows.size() == 2);
  CHECK(mesh.rows[0] == std::vector<std::string>{"10, 0, -2", "z", "40\u202f%"});
  CHECK(mesh.rows[1][1] == "?");
  CHECK(has(page(false), "<td>10, 0, -2</td><td>z</td>"));
}

TEST_CASE("figures of a long trace stay small, and one cycle is enough") {
  const Sample sample;
  const auto long_trace = load_trace(sample.trace(60'000, 900));
  CHECK(force_figure(long_trace).svg().size() < 150'000);
  CHECK(work_figure(long_trace).svg().size() < 150'000);
  CHECK(levels_figure(long_trace, 3).svg().size() < 150'000);
  const auto one = load_trace(sample.trace(1, 900));
  for (const Figure& figure : {force_figure(one), work_figure(one), levels_figure(one, 3)}) {
    CAPTURE(figure.name);
    CHECK_FALSE(has(figure.svg(), "nan"));
    CHECK_FALSE(has(figure.svg(), "inf"));
  }
}

TEST_CASE("the displacement is drawn with its factor, the largest node named") {
  const Sample sample;
  const ModelSurface surface = model_surface(sample.file.view);
  const auto drawn =
      drawn_displacement(surface.mesh.positions, load_snapshot(sample.snapshot(), sample.file.view.node_count));
  CHECK(drawn.largest_node == 4);
  CHECK(drawn.largest == doctest::Approx(0.01));
  CHECK(drawn.factor == 2);
  CHECK(drawn.magnified[4].z() == doctest::Approx(-0.02));
}

TEST_CASE("a displacement beyond linear elasticity is said to be so") {
  const Sample sample;
  const ModelSurface surface = model_surface(sample.file.view);
  const std::vector<Eigen::Vector3d> far(surface.flags.size(), Eigen::Vector3d(5, 0, 0));
  const auto drawn = drawn_displacement(surface.mesh.positions, far);
  const ViewFrame frame = view_frame(Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
  const Figure figure = body_figure(surface.level(2), drawn, frame, nullptr);
  CHECK(has(figure.caption, "too far for linear elasticity"));
  CHECK(has(figure.caption, "drawn at 1/200"));
}

TEST_CASE("a model's surface is its nodes and levels") {
  const Sample sample;
  const ModelSurface surface = model_surface(sample.file.view);
  CHECK(surface.mesh.vertex_end == std::vector<std::size_t>{6, 18, 66});
  CHECK(surface.level(2).triangles.size() == 128);
  CHECK(surface.count(layout::node_fixed) + surface.count(layout::node_domain) <= 66);
  const auto fixed = surface.level(2).fixed;
  CHECK(std::count(fixed.begin(), fixed.end(), 1) == static_cast<int>(surface.count(layout::node_fixed)));
}

TEST_CASE("bytes by kind add up to the file") {
  const Sample sample;
  std::uint64_t sum = 0;
  const auto kinds = bytes_by_kind(sample.file.view);
  for (const KindBytes& kind : kinds) sum += kind.bytes;
  CHECK(sum == std::filesystem::file_size(sample.model));
  CHECK(kinds.back().name == "header, table, padding");
  CHECK(kinds.back().bytes >= sizeof(layout::Header));
}

TEST_CASE("every kind of section has a name") {
  const TemporaryFolder folder("report_test");
  for (const layout::Wavelet wavelet : layout::wavelets) {
    write_file(folder.path() / "kinds.gloop", encode(synthetic_model({.levels = 2, .wavelet = wavelet})));
    std::vector<std::string> names;
    for (const KindBytes& kind : bytes_by_kind(open_model_file(folder.path() / "kinds.gloop").view)) {
      CAPTURE(kind.name);
      CHECK_FALSE(has(kind.name, "unknown"));
      names.push_back(kind.name);
    }
    const auto count = [&](const char* name) { return std::count(names.begin(), names.end(), name); };
    CHECK(count("base triangles") == 1);
    CHECK(count("stencils") == (layout::is_butterfly(wavelet) ? 1 : 0));
    CHECK(count("predictions") == (wavelet == layout::Wavelet::equilibrated ? 1 : 0));
  }
}

TEST_CASE("one row per constraint level, with its errors") {
  const Sample sample;
  const Table plain = level_table(sample.file.view, {});
  REQUIRE(plain.rows.size() == 2);
  CHECK(plain.rows[0][0] == "1");
  CHECK(plain.rows[1].size() == plain.head.size());
  CHECK(plain.rows[1][1] == readable_count(sample.file.view.domain_count));
  CHECK(plain.rows[1][2] == readable_count(sample.file.view.level[2].counts->kept_blocks));
  CHECK(plain.rows[1][5] == readable_percent(sample.file.view.level[2].counts->rms_error));
  const Table used = level_table(sample.file.view, summarise(load_trace(sample.trace(100, 1))));
  CHECK(used.rows[1].size() == used.head.size());
  CHECK(used.rows[1].back() == "50\u202f%");
}

TEST_CASE("the finest constraint level's bytes are all scales and couplings") {
  const Sample sample;
  std::uint64_t sum = 0;
  std::vector<std::string> names;
  for (const KindBytes& kind : bytes_by_kind(sample.file.view)) {
    names.push_back(kind.name);
    if (kind.name == "scales" || has(kind.name, "couplings")) sum += kind.bytes;
  }
  for (const char* name : {"scales", "couplings, 8 bits", "couplings, 4 bits", "representatives"}) {
    CAPTURE(name);
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  }
  CHECK(level_table(sample.file.view, {}).rows[1][4] == readable_bytes(static_cast<double>(sum)));
}

TEST_CASE("facts say wavelet, bits, layers and certificate") {
  const TemporaryFolder folder("report_test");
  const auto fact = [&](const ModelData& data, std::string_view name) {
    write_file(folder.path() / "facts.gloop", encode(data));
    const ModelFile file = open_model_file(folder.path() / "facts.gloop");
    for (const FactGroup& group : model_facts(file.view, model_surface(file.view))) {
      for (const Fact& one : group.facts) {
        if (one.name == name) return one.value;
      }
    }
    return std::string();
  };
  ModelData data = synthetic_model({.wavelet = layout::Wavelet::linear});
  CHECK(fact(data, "wavelet") == "linear");
  std::size_t nibbles = 0;
  for (const LevelData& level : data.levels) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      const std::size_t count = level.couplings[layer].index.size();
      nibbles += layout::value_bits[layer] == 4 ? count : 0;
    }
  }
  write_file(folder.path() / "size.gloop", encode(data));
  const ModelFile file = open_model_file(folder.path() / "size.gloop");
  const FieldSize field = field_size(file.view);
  CHECK(fact(data, "blocks that a field is summed of") ==
        readable_count(field.blocks) + ", at most " + readable_count(field.longest) + " by a force on one node");
  CHECK(has(fact(data, "couplings by bits per value"), "4: " + readable_count(nibbles)));
  CHECK(fact(data, "positive definite") == "none");
  data.info.lambda_min = 2.5e-5;
  CHECK(fact(data, "positive definite") == "every eigenvalue is above 2.5e-05\u202fm/N");
  data = synthetic_model({.levels = 1});
  CHECK(fact(data, "wavelet") == "lifted linear");
}

TEST_CASE(
    "a scalar model has no material, no unit, nothing that builds or runs it; its dense matrix has a number a block") {
  const TemporaryFolder folder("report_test");
  ModelData data = synthetic_model({.components = 1, .levels = 3});
  data.info.lambda_min = 2.5e-5;
  write_file(folder.path() / "scalar.gloop", encode(data));
  const ModelFile file = open_model_file(folder.path() / "scalar.gloop");
  CHECK(dense_bytes(file.view) == 4 * 41 * 41);
  const Report report =
      make_report(file, {.model = folder.path() / "scalar.gloop", .trace = {}, .snapshot = {}, .build = {}});
  CHECK(has(report.html, "scalar"));
  CHECK(has(report.html, "every eigenvalue is above 2.5e-05<"));
  const std::string page = without_pictures(report.html);
  for (const char* word : {"Young", "Poisson", "m/N", "greenloop-loop"}) {
    CAPTURE(word);
    CHECK_FALSE(has(page, word));
  }
  CHECK(report.missing.empty());
  const std::filesystem::path run = folder.path() / "run.csv";
  const auto refused = doctest::Contains("run.csv: a run of an elastostatic model, but");
  CHECK_THROWS_WITH((void)make_report(file, {.model = "m", .trace = run, .snapshot = {}, .build = {}}), refused);
  CHECK_THROWS_WITH((void)make_report(file, {.model = "m", .trace = {}, .snapshot = run, .build = {}}), refused);
}

TEST_CASE("the frontier has a panel for every pair of figures that two points have") {
  BuildRecord record;
  CHECK_FALSE(has_frontier(record));
  record.frontier.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    record.frontier[i].threshold = 0.1 * static_cast<double>(i + 1);
    record.frontier[i].rms_error = record.frontier[i].threshold;
  }
  record.frontier[0].bytes = 10;
  CHECK_FALSE(has_frontier(record));
  record.frontier[1].bytes = 5;
  REQUIRE(has_frontier(record));
  CHECK(has(frontier_figure(record).svg(), "RMS error"));
  CHECK_FALSE(has(frontier_figure(record).svg(), "patch force error"));
  CHECK_FALSE(has(frontier_figure(record).svg(), ">chosen<"));
  record.threshold = 0.2;
  for (FrontierPoint& point : record.frontier) point.worst_patch_force_error = point.step_work = point.threshold;
  const Figure all = frontier_figure(record);
  CHECK(has(all.svg(), "work of a step"));
  CHECK(has(all.svg(), ">chosen<"));
}

TEST_CASE("every constraint level with two points has a row of size and of speed against its errors") {
  BuildRecord record;
  record.frontier.resize(2);
  CHECK_FALSE(has_level_frontiers(record));
  for (std::size_t i = 0; i < 2; ++i) {
    const double size = 1 + static_cast<double>(i);
    record.frontier[i].threshold = 0.1 * size;
    LevelFrontierPoint point;
    point.rms_error = 0.01 * size;
    point.bytes = point.step_work = 90 / size;
    for (point.level = 1; point.level <= (i == 0 ? 3U : 2U); ++point.level) record.frontier[i].levels.push_back(point);
  }
  REQUIRE(has_level_frontiers(record));
  Figure figure = level_frontiers_figure(record);
  CHECK(has(figure.svg(), "constraint level 1"));
  CHECK(has(figure.svg(), "constraint level 2"));
  CHECK_FALSE(has(figure.svg(), "constraint level 3"));
  const std::string ring = "fill=\"none\" stroke=\"var(--ink)\"";
  CHECK_FALSE(has(figure.svg(), ring));
  CHECK_FALSE(has(figure.caption, "Work"));
  record.threshold = 0.2;
  record.contacts = 16;
  figure = level_frontiers_figure(record);
  CHECK(has(figure.svg(), ring));
  CHECK(has(figure.caption, "Work: 16 contacts"));
  CHECK_FALSE(has(figure.svg(), "nan"));
}

TEST_CASE("level errors of zero have no place in the figure") {
  CHECK_FALSE(has_level_errors({{.level = 0}, {.level = 1}}));
  const Figure figure = level_errors_figure({{.level = 2, .rms = 0.01, .worst_column = 0.03}});
  CHECK(has(figure.svg(), "worst column"));
  CHECK_FALSE(has(figure.svg(), ">worst patch force<"));
  CHECK_FALSE(has(figure.svg(), "nan"));
  CHECK_FALSE(has(figure.svg(), "inf"));
}

TEST_CASE("an output that cannot be written is an error that names it") {
  const TemporaryFolder folder("report_test");
  CHECK(has(message_of([&] { write_text_file(folder.path() / "no" / "such.html", "x"); }),
            "such.html: cannot be written"));
}

}  // namespace greenloop::offline
