// inspect, verify and convert, through the functions that the program registers.

#include <doctest/doctest.h>

#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/volume_io.hpp"
#include "formats/output/output_file.hpp"
#include "formats/testing/model_mutant.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/write/model_file.hpp"
#include "offline/cli/convert_command.hpp"
#include "offline/cli/inspect_command.hpp"
#include "offline/cli/verify_command.hpp"
#include "offline/compress/encode/compressed_compliance.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::json;

// a folder with sphere.gloop, gone with the test
class Folder {
 public:
  explicit Folder(const std::string& name, const SyntheticOptions& options = {})
      : path_(std::filesystem::temp_directory_path() / ("greenloop_" + name)) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
    write_file(path_ / "sphere.gloop", encode(synthetic_model(options)));
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

Json inspect_json(const std::filesystem::path& file) {
  std::ostringstream out;
  CHECK(run_inspect({file, true}, out) == 0);
  return Json::parse(out.str());
}

TEST_CASE("inspect: says how many vertices the model's vertex map has") {
  const Folder with("inspect_vertices", {.levels = 2, .vertices = 7}), without("inspect_no_vertices", {.levels = 2});
  CHECK(inspect_json(with / "sphere.gloop")["vertices"] == 7);
  CHECK(inspect_json(with / "sphere.gloop")["version"] == "4.2");
  CHECK(inspect_json(without / "sphere.gloop")["vertices"] == 0);
  std::ostringstream out;
  CHECK(run_inspect({with / "sphere.gloop", false}, out) == 0);
  CHECK(out.str().find("vertex map          7 vertices\n") != std::string::npos);
}

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string convert_refusal(const ConvertArguments& arguments) {
  std::ostringstream out;
  try {
    run_convert(arguments, out);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("inspect --json: every agreed key, with the model's numbers") {
  const Folder folder("inspect_json", {.levels = 3, .coarsest_constraint_level = 1});
  const Json found = inspect_json(folder / "sphere.gloop");
  CHECK(found["version"] == "4.1");
  CHECK(found["nodes"] == 66);
  CHECK(found["domain_nodes"] == 41);
  CHECK(found["levels"] == 3);
  CHECK(found["bytes"] == std::filesystem::file_size(folder / "sphere.gloop"));
  CHECK(found["dense_blocks"] == 41 * 41);
  CHECK(found["dense_bytes"] == 36 * 41 * 41);
  CHECK(found["kept_blocks"] > 41);
  CHECK(found["kept_blocks"] < 41 * 41);
  CHECK(found["rms_error"] > 0);
  CHECK(found["rms_error"] < 0.03);
  CHECK(found["worst_column_error"] > 0);
  CHECK(found["worst_patch_force_error"] == 0);
  CHECK(found["field_blocks"] > 41);
  CHECK(found["longest_field_column"] > 1);
  CHECK(found["longest_field_column"] <= found["field_blocks"]);
  CHECK(found["field_rms_error"] > 0);
  CHECK(found["field_column_error"] > 0);
  CHECK(found["lambda_min"] == 0);
  CHECK(found["certificate"] == false);
  CHECK(found["wavelet"] == "lifted linear");
  CHECK(found["frontier"].empty());
  CHECK(found["material"] == Json{{"young", 1e5}, {"poisson", 0.4}});
  CHECK(found["provenance"]["generator"] == "synthetic sphere");
  CHECK(found["units"]["compliance"] == "m/N");

  REQUIRE(found["constraint_levels"].size() == 2);
  const Json& finest = found["constraint_levels"][1];
  CHECK(finest["level"] == 2);
  CHECK(finest["columns"] == 41);
  CHECK(finest["rms_error"] == found["rms_error"]);
  CHECK(finest["worst_column_error"] == found["worst_column_error"]);
  CHECK(finest["kept_blocks"] == found["kept_blocks"]);
  CHECK(finest["dense_blocks"] == found["dense_blocks"]);
  CHECK(finest["worst_patch_force_error"] == 0);

  // Info, Provenance, 3 x (Level, Nodes, triangles or refinement), 2 + 4 Representatives, 3 Scales, 3 x 4 Couplings,
  // 2 Patterns
  REQUIRE(found["sections"].size() == 2 + 3 * 3 + 2 + 4 + 3 + 3 * 4 + 2);
  CHECK(found["sections"][0] == Json{{"kind", "Info"}, {"a", 0}, {"b", 0}, {"offset", 1152}, {"bytes", 256}});
  CHECK(found["sections"].back()["kind"] == "Patterns(2)");
  CHECK(found["patterns"] == Json::array());
}

TEST_CASE("inspect: what people do, of every level that was measured; the worst of each kind in the table") {
  const Folder folder("inspect_patterns");
  ModelData data = synthetic_model({.levels = 3, .coarsest_constraint_level = 1});
  data.levels[1].patterns = {synthetic_patterns().front()};
  data.levels[2].patterns = synthetic_patterns();
  write_file(folder / "sphere.gloop", encode(data));
  const Json found = inspect_json(folder / "sphere.gloop")["patterns"];
  REQUIRE(found.size() == 1 + synthetic_patterns().size());
  const auto quantiles = [](const float(&error)[3]) {
    return Json{{"median", error[0]}, {"p95", error[1]}, {"worst", error[2]}};
  };
  const layout::PatternRecord turned = synthetic_patterns()[3], pinch = synthetic_patterns()[4];
  CHECK(found[0]["level"] == 1);
  CHECK(found[4] == Json{{"kind", "turned"},
                         {"contacts", 16},
                         {"level", 2},
                         {"samples", turned.samples},
                         {"field_error", quantiles(turned.field_error)},
                         {"field_peak", quantiles(turned.field_peak)},
                         {"force_error", quantiles(turned.force_error)},
                         {"total_force_error", nullptr}});
  CHECK(found[5]["kind"] == "pinch");
  CHECK(found[5]["total_force_error"] == quantiles(pinch.total_force_error));

  std::ostringstream out;
  CHECK(run_inspect({folder / "sphere.gloop", false}, out) == 0);
  CHECK(out.str().find("what people do, resolved at level 2: the worst compression error of each kind") !=
        std::string::npos);
  CHECK(out.str().find("  patch        4, 16 ") != std::string::npos);
  CHECK(out.str().find(" -\n") != std::string::npos);
}

TEST_CASE("inspect --json: wavelet, bits, certificate and frontier are the file's own") {
  const Folder folder("inspect_own");
  ModelData data = synthetic_model({.levels = 3, .wavelet = layout::Wavelet::linear});
  data.info.lambda_min = 2.5e-6;
  data.provenance = R"({"frontier": [{"threshold": 0.5}]})";
  std::uint64_t blocks[17] = {};
  for (LevelData& level : data.levels) {
    level.counts.patch_force_error = 0.25;
    level.counts.force_error = 0.125;
    level.counts.cut_error = 0.5;
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      blocks[layout::value_bits[layer]] += level.couplings[layer].index.size();
    }
  }
  write_file(folder / "own.gloop", encode(data));
  const Json found = inspect_json(folder / "own.gloop");
  CHECK(found["wavelet"] == "linear");
  std::uint64_t couplings = 0;
  for (const std::uint64_t of_bits : blocks) couplings += of_bits;
  CHECK(found["field_blocks"] == 2 * couplings + found["domain_nodes"].get<std::uint64_t>());
  CHECK(found["field_rms_error"] >= found["rms_error"]);
  CHECK(found["lambda_min"] == 2.5e-6);
  CHECK(found["certificate"] == true);
  CHECK(found["worst_patch_force_error"] == 0.25);
  CHECK(found["version"] == "4.2");
  CHECK(found["constraint_levels"][0]["force_error"] == 0.125);
  CHECK(found["constraint_levels"][0]["cut_error"] == 0.5);
  CHECK(found["frontier"] == Json::parse(R"([{"threshold": 0.5}])"));
  CHECK(found["bits"] == Json{{"4", blocks[4]}, {"8", blocks[8]}, {"16", blocks[16]}});
}

TEST_CASE("inspect: the table for people says the same") {
  const Folder folder("inspect_text");
  std::ostringstream out;
  CHECK(run_inspect({folder / "sphere.gloop", false}, out) == 0);
  for (const char* part :
       {"66, 41 of them in the domain", "3 of 3", "times fewer than the dense matrix (60.5 kB)",
        "Young's modulus 100000.0 Pa", "worst column", "compression error, level by level", "NOT JUDGED: the scene",
        "mesh error ", "1000000 units a step, ", "100 % of a period at 1000 Hz is 1000 us", "units per us, by "}) {
    CAPTURE(part);
    CHECK(out.str().find(part) != std::string::npos);
  }
}

TEST_CASE("inspect: provenance that is not JSON is shown as text") {
  const Folder folder("inspect_provenance");
  ModelData data = synthetic_model({.levels = 1});
  data.provenance = "by hand";
  write_file(folder / "plain.gloop", encode(data));
  CHECK(inspect_json(folder / "plain.gloop")["provenance"] == "by hand");
}

TEST_CASE("inspect: a file that is not valid is an error that names it") {
  const Folder folder("inspect_wrong");
  write_file(folder / "wrong.gloop", std::as_bytes(std::span("nothing like a model")));
  std::ostringstream out;
  CHECK_THROWS_AS(run_inspect({folder / "wrong.gloop", true}, out), std::runtime_error);
  CHECK(out.str().empty());
}

TEST_CASE("verify: exit code 0 only for a valid file, and the first fault in words and JSON") {
  const Folder folder("verify_command");
  std::ostringstream good, bad, absent;
  CHECK(run_verify({folder / "sphere.gloop", false, true}, good) == 0);
  CHECK(Json::parse(good.str())["ok"] == true);
  CHECK(Json::parse(good.str())["verdict"] == "HELD");
  CHECK(Json::parse(good.str())["rule"] == "ok");

  ModelMutant mutant(SyntheticOptions{});
  mutant.records<layout::NodeRecord>(layout::SectionKind::nodes, 1)[2].area = -3;
  (void)mutant.verdict();
  write_file(folder / "bad.gloop", mutant.bytes());
  CHECK(run_verify({folder / "bad.gloop", false, true}, bad) == 1);
  const Json verdict = Json::parse(bad.str());
  CHECK(verdict["ok"] == false);
  CHECK(verdict["verdict"] == "VIOLATED");
  CHECK(verdict["rule"] == "out_of_range");
  CHECK(verdict["section"] == "Nodes(1)");
  CHECK(verdict["field"] == "area");
  CHECK(verdict["index"] == 2);
  CHECK(verdict["value"] == -3);
  CHECK(verdict["message"].get<std::string>().find("bad.gloop: Nodes(1), field `area`, index 2") != std::string::npos);

  CHECK(run_verify({folder / "absent.gloop", false, true}, absent) == 1);
  CHECK(Json::parse(absent.str())["rule"] == "unreadable");
  std::ostringstream text;
  CHECK(run_verify({folder / "sphere.gloop", false, false}, text) == 0);
  CHECK(text.str().starts_with((folder / "sphere.gloop").string() + ": the file is valid\na body of "));
}

// m/N, of the compliance that the model stands for, by its dense matrix
double least_eigenvalue(const ModelData& data) {
  const AlignedBytes bytes(encode(data));
  ModelView view;
  REQUIRE(verify(bytes.span(), view).ok());
  const CompressedCompliance<3> compressed(view);
  const auto rows = static_cast<Eigen::Index>(compressed.rows(compressed.finest()));
  Eigen::MatrixXd dense(3 * rows, 3 * rows);
  for (Eigen::Index j = 0; j < rows; ++j) {
    const std::vector<double> column = compressed.column(compressed.finest(), static_cast<std::size_t>(j));
    for (Eigen::Index i = 0; i < rows; ++i) {
      dense.block<3, 3>(3 * i, 3 * j) = Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
    }
  }
  CHECK((dense - dense.transpose()).norm() <= 1e-12 * dense.norm());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues()[0];
}

TEST_CASE("verify --certificate: holds just below the least eigenvalue, not just above, not if absent or cut off") {
  const Folder folder("verify_certificate");
  ModelData data = synthetic_model({.levels = 3});
  const double least = least_eigenvalue(data);
  REQUIRE(least > 0);
  const auto verdict = [&](double lambda_min, const std::string& file, int exit_code) {
    data.info.lambda_min = lambda_min;
    write_file(folder / file, encode(data));
    std::ostringstream out;
    CHECK(run_verify({folder / file, true, true}, out) == exit_code);
    return Json::parse(out.str());
  };
  const Json right = verdict(0.999 * least, "right.gloop", 0);
  CHECK(right["ok"] == true);
  CHECK(right["certificate"]["holds"] == true);
  CHECK(right["certificate"]["lambda_min"] == 0.999 * least);
  CHECK(right["certificate"]["unknowns"] == 3 * 41);
  CHECK(right["certificate"]["shift"] >= 0.999 * least);

  const Json boast = verdict(1.001 * least, "boast.gloop", 1);
  CHECK(boast["ok"] == false);
  CHECK(boast["rule"] == "ok");
  CHECK(boast["certificate"]["holds"] == false);
  CHECK(boast["message"].get<std::string>().find("does not hold") != std::string::npos);
  std::ostringstream unasked;
  CHECK(run_verify({folder / "boast.gloop", false, true}, unasked) == 0);
  CHECK_FALSE(Json::parse(unasked.str()).contains("certificate"));

  const Json none = verdict(0, "none.gloop", 1);
  CHECK(none["message"].get<std::string>().find("carries no certificate") != std::string::npos);

  std::ostringstream out;
  CHECK(run_convert({folder / "right.gloop", folder / "cut.gloop", 2, {}}, out) == 0);
  out.str("");
  CHECK(run_verify({folder / "cut.gloop", true, true}, out) == 1);
  CHECK(Json::parse(out.str())["message"].get<std::string>().find("is cut off") != std::string::npos);
}

TEST_CASE("convert: a model becomes C source, header and definition") {
  const Folder folder("convert_c");
  std::ostringstream out;
  CHECK(run_convert({folder / "sphere.gloop", folder / "left-hand.h", {}, {}}, out) == 0);
  const auto text = [&](const std::string& name) {
    const AlignedBytes bytes = load_file(folder / name);
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  CHECK(text("left-hand.h").find("extern const unsigned char left_hand_") != std::string::npos);
  CHECK(text("left-hand.c").find("#include \"left-hand.h\"") == 0);
}

TEST_CASE("convert: a model becomes a coarser model") {
  const Folder folder("convert_cut");
  std::ostringstream out;
  CHECK(run_convert({folder / "sphere.gloop", folder / "coarse.gloop", 2, {}}, out) == 0);
  const ModelFile model = open_model_file(folder / "coarse.gloop");
  CHECK(model.view.levels == 2);
  CHECK(model.view.node_count == 18);
  const Json found = inspect_json(folder / "coarse.gloop");
  CHECK(found["complete_levels"] == 3);
  CHECK(found["constraint_levels"].size() == 2);
}

TEST_CASE("convert: a model becomes ready and plain again, and a coarser one is as it was asked for") {
  const Folder folder("convert_ready");
  const auto plain = folder / "sphere.gloop", ready = folder / "ready.gloop", back = folder / "back.gloop";
  std::ostringstream out;
  const auto converted = [&](const ConvertArguments& arguments) {
    CHECK(run_convert(arguments, out) == 0);
    return inspect_json(arguments.output);
  };
  const Json found = converted({.input = plain, .output = ready, .levels = {}, .ready = true});
  CHECK(found["ready"] == true);
  CHECK(found["version"] == "4.4");
  CHECK(found["bytes"].get<std::size_t>() ==
        std::filesystem::file_size(plain) + found["ready_bytes"].get<std::size_t>());
  CHECK(found["sections"].back()["kind"] == "MirroredCouplings(3)");
  CHECK(converted({.input = ready, .output = back, .levels = {}, .ready = false})["ready"] == false);
  CHECK(read_all(back) == read_all(plain));
  CHECK(converted({.input = ready, .output = back, .levels = 2, .ready = {}})["ready"] == false);
  CHECK(converted({.input = ready, .output = back, .levels = 2, .ready = true})["ready"] == true);
  const auto stream = folder / "ready.gloopz";
  CHECK(run_convert({.input = ready, .output = stream, .levels = {}, .ready = {}}, out) == 0);
  CHECK(converted({.input = stream, .output = back, .levels = {}, .ready = {}})["ready"] == false);
  CHECK(read_all(back) == read_all(plain));
  CHECK(converted({.input = stream, .output = back, .levels = {}, .ready = true})["ready"] == true);
  CHECK(read_all(back) == read_all(ready));
  CHECK(convert_refusal({.input = plain, .output = stream, .levels = {}, .ready = true}).find("--ready") !=
        std::string::npos);
  CHECK(convert_refusal({.input = folder / "a.off", .output = folder / "b.obj", .levels = {}, .ready = true})
            .find("are for models") != std::string::npos);
  std::ostringstream table;
  CHECK(run_inspect({ready, false}, table) == 0);
  CHECK(table.str().find("ready               yes, ") != std::string::npos);
}

TEST_CASE("convert: a model becomes its surface, at any level, and that another format") {
  const Folder folder("convert_surface");
  std::ostringstream out;
  CHECK(run_convert({folder / "sphere.gloop", folder / "fine.obj", {}, {}}, out) == 0);
  CHECK(run_convert({folder / "sphere.gloop", folder / "base.off", 1, {}}, out) == 0);
  CHECK(run_convert({folder / "fine.obj", folder / "fine.ply", {}, {}}, out) == 0);
  const TriangleMesh fine = read_surface(folder / "fine.ply");
  CHECK(fine.vertices.size() == 66);
  CHECK(fine.triangles.size() == 128);
  CHECK(read_surface(folder / "base.off").triangles.size() == 8);
  CHECK(read_surface(folder / "fine.obj").vertices == fine.vertices);
}

TEST_CASE("convert: a volume becomes another format") {
  const Folder folder("convert_volume");
  const TetrahedralMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  write_volume(folder / "one.msh", one);
  std::ostringstream out;
  CHECK(run_convert({folder / "one.msh", folder / "one.mesh", {}, {}}, out) == 0);
  const TetrahedralMesh back = read_volume(folder / "one.mesh");
  CHECK(back.vertices == one.vertices);
  CHECK(back.tetrahedra == one.tetrahedra);
  CHECK(convert_refusal({folder / "one.msh", folder / "one.obj", {}, {}}).find("a volume becomes") !=
        std::string::npos);
}

std::vector<std::byte> contents(const std::filesystem::path& file) {
  const AlignedBytes bytes = load_file(file);
  return {bytes.span().begin(), bytes.span().end()};
}

TEST_CASE("convert: a model becomes its transport form and comes back, whole or cut") {
  const Folder folder("convert_transport", {.quantum = 0.01});
  const auto sphere = folder / "sphere.gloop", stream = folder / "sphere.gloopz", coarse = folder / "coarse.gloop";
  std::ostringstream out;
  CHECK(run_convert({sphere, stream, {}}, out) == 0);
  CHECK(out.str().find("wrote " + stream.string()) != std::string::npos);
  CHECK(5 * std::filesystem::file_size(stream) < 3 * std::filesystem::file_size(sphere));
  CHECK(run_convert({stream, folder / "back.gloop", {}}, out) == 0);
  CHECK(contents(folder / "back.gloop") == contents(sphere));

  CHECK(run_convert({sphere, coarse, 2}, out) == 0);
  CHECK(run_convert({stream, folder / "unpacked.gloop", 2}, out) == 0);
  CHECK(contents(folder / "unpacked.gloop") == contents(coarse));
  CHECK(run_convert({sphere, folder / "coarse.gloopz", 2}, out) == 0);
  CHECK(run_convert({folder / "coarse.gloopz", folder / "again.gloop", {}, {}}, out) == 0);
  CHECK(contents(folder / "again.gloop") == contents(coarse));

  CHECK(run_convert({stream, folder / "fine.off", {}}, out) == 0);
  CHECK(read_surface(folder / "fine.off").triangles.size() == 128);
  CHECK(run_convert({stream, folder / "sphere.h", 1}, out) == 0);
  CHECK(std::filesystem::exists(folder / "sphere.c"));
  CHECK(convert_refusal({stream, folder / "b.gloop", 4}).find("--levels 4, but the model has 3") != std::string::npos);
  CHECK(convert_refusal({stream, folder / "b.gloop", 0}).find("--levels 0, but the model has 3") != std::string::npos);
  CHECK(convert_refusal({stream, folder / "b.gloopz", {}}).find("--levels") != std::string::npos);
  CHECK(convert_refusal({folder / "fine.off", folder / "b.gloopz", {}, {}}).find("a surface becomes") !=
        std::string::npos);
}

TEST_CASE("convert: a truncated transport form is refused, its whole levels are given when asked for") {
  const Folder folder("convert_truncated");
  const auto sphere = folder / "sphere.gloop", stream = folder / "sphere.gloopz", cut = folder / "cut.gloopz";
  std::ostringstream out;
  REQUIRE(run_convert({sphere, stream, {}}, out) == 0);
  REQUIRE(run_convert({sphere, folder / "coarse.gloop", 2}, out) == 0);
  const std::vector<std::byte> whole = contents(stream);
  write_file(cut, std::span(whole).first(whole.size() - 1));
  const std::string refusal = convert_refusal({cut, folder / "b.gloop", {}});
  CHECK(refusal.find(cut.string()) != std::string::npos);
  CHECK(refusal.find("TRUNCATED after level 1: 2 of 3 mesh levels are whole (packet 2, offset ") != std::string::npos);
  CHECK(refusal.find("fetch the rest, or take the coarser model with --levels 2") != std::string::npos);
  CHECK(convert_refusal({cut, folder / "b.gloop", 3}).find("TRUNCATED after level 1") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "b.gloop"));
  CHECK(run_convert({cut, folder / "taken.gloop", 2}, out) == 0);
  CHECK(contents(folder / "taken.gloop") == contents(folder / "coarse.gloop"));

  write_file(cut, std::span(whole).first(100));
  CHECK(convert_refusal({cut, folder / "b.gloop", 1}).find("TRUNCATED before its coarsest") != std::string::npos);
}

TEST_CASE("convert: a corrupted transport form is refused with the place") {
  const Folder folder("convert_corrupted");
  const auto stream = folder / "sphere.gloopz";
  std::ostringstream out;
  REQUIRE(run_convert({folder / "sphere.gloop", stream, {}}, out) == 0);
  std::vector<std::byte> bytes = contents(stream);
  bytes[bytes.size() - 100] ^= std::byte{1};
  write_file(stream, bytes);
  const std::string refusal = convert_refusal({stream, folder / "b.gloop", {}});
  CHECK(refusal.find(stream.string()) != std::string::npos);
  CHECK(refusal.find("packet 2, offset ") != std::string::npos);
  CHECK(refusal.find("(packet_checksum)") != std::string::npos);
  CHECK(run_convert({stream, folder / "coarse.gloop", 2}, out) == 0);
}

TEST_CASE("convert: refuses what makes no sense, and says what would") {
  const Folder folder("convert_refuse");
  const auto sphere = folder / "sphere.gloop", obj = folder / "a.obj";
  std::ostringstream out;
  REQUIRE(run_convert({sphere, obj, {}}, out) == 0);
  CHECK(convert_refusal({sphere, folder / "b.gloop", {}}).find("--levels") != std::string::npos);
  CHECK(convert_refusal({sphere, folder / "b.gloop", 4}).find("--levels 4, but the model has 3") != std::string::npos);
  CHECK(convert_refusal({sphere, folder / "b.gloop", 0}).find("--levels 0") != std::string::npos);
  CHECK(convert_refusal({sphere, folder / "b.xyz", {}}).find("a model becomes") != std::string::npos);
  CHECK(convert_refusal({obj, folder / "b.gloop", {}}).find("greenloop build") != std::string::npos);
  CHECK(convert_refusal({obj, folder / "b.off", 1}).find("--levels is for models") != std::string::npos);
  CHECK(convert_refusal({folder / "a.xyz", obj, {}}).find("do not know \".xyz\"") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "b.gloop"));
}

TEST_CASE("the commands register themselves and set the exit code") {
  const Folder folder("register");
  CLI::App app;
  int exit_code = 7;
  add_inspect(app, exit_code);
  add_verify(app, exit_code);
  add_convert(app, exit_code);
  app.parse("verify " + (folder / "absent.gloop").string() + " --json", false);
  CHECK(exit_code == 1);
  app.parse("convert " + (folder / "sphere.gloop").string() + " -o " + (folder / "c.gloop").string() + " --levels 1",
            false);
  CHECK(exit_code == 0);
  CHECK(std::filesystem::exists(folder / "c.gloop"));
  const std::string ready = (folder / "r.gloop").string(), copy = (folder / "copy.gloop").string();
  app.parse("convert " + (folder / "sphere.gloop").string() + " --ready -o " + ready, false);
  CHECK(inspect_json(ready)["ready"] == true);
  CLI::App without;
  add_convert(without, exit_code);
  CHECK_THROWS_AS(without.parse("convert " + ready + " -o " + copy, false), std::runtime_error);
  app.parse("convert " + ready + " --no-ready -o " + copy, false);
  CHECK(inspect_json(copy)["ready"] == false);
  CHECK_THROWS_AS(app.parse("inspect", false), CLI::RequiredError);
}

}  // namespace
}  // namespace greenloop::offline
