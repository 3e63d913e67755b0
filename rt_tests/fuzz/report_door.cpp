#include <fstream>
#include <stdexcept>
#include <string>

#include "formats/testing/temporary_folder.hpp"
#include "offline/report/build_record.hpp"
#include "offline/report/loop_figures.hpp"
#include "offline/report/trace.hpp"
#include "rt_tests/fuzz/doors.hpp"

namespace greenloop {
namespace {

const std::string trace_seed =
    "time,x0,y0,z0,x1,y1,z1,force_x0,force_y0,force_z0,force_x1,force_y1,force_z1,force,contacts,level,field_level,"
    "work,"
    "budget,status\n"
    "# by hand\n"
    "0,0,0,0.1,0,0,0,0,0,0,0,0,0,0,0,0,0,10,1000,ok\n"
    "0.001,0,0,0.1,0,0,0,0,0,1.5,0,0,0,1.5,4,2,2,900,1000,ok\n"
    "0.002,0,0,0.1,0,0,0,0,0,1.5,0,0,-2,3.5,4,1,2,1900,1000,held_not_finite\n"
    "0.003,0,0,0.1,0,0,0,0,0,1.5,0,0,-2,3.5,4,1,0,700,1000,coarser\n";

const std::string snapshot_seed = "node,x,y,z\n0,0.001,0,-0.002\n3,1e-9,0,0\n17,0,0,0.02\n";

const std::string record_seed = R"({"scene": "ball", "request": "9f", "bytes": 1200, "stages": [
  {"name": "solve", "seconds": 1.5}, {"name": "compress", "seconds": 0.2}],
  "remesh": {"levels": 3, "smallest_angle_degrees": 31.5, "box": [1, [2, 3]], "inner": {"kept": true}},
  "compression": {"threshold": 0.01, "patches": 40, "frontier_contacts": 16,
  "wavelets": [{"wavelet": "linear", "nodes": 258, "bytes": 4000, "kept_blocks": 90, "step_work": 100}],
  "frontier": [{"threshold": 0.01, "rms_error": 0.01, "worst_patch_force_error": 0.03, "bytes": 2000,
  "step_work": 900, "levels": [{"level": 1, "rms_error": 0.01, "bytes": 400, "step_work": 90}]},
  {"threshold": 0.02, "worst_patch_force_error": 1e9, "levels": []}]}})";

constexpr std::size_t most_figure_bytes = 1 << 20;  // of such short traces

class ReportDoor final : public Door {
 public:
  bool try_one(Random& random) override {
    const std::size_t kind = below(random, 4);
    std::string text = kind == 0 ? trace_seed : kind == 1 ? snapshot_seed : record_seed;
    mutate_text(random, text);
    try {
      read(kind, text);
    } catch (const std::runtime_error&) {
      return false;
    }
    return true;
  }

 private:
  void read(std::size_t kind, const std::string& text) const {
    if (kind == 3) {
      auto groups = offline::facts_of_json(text, "provenance");
      offline::merge_facts(groups, groups);
      return;
    }
    const auto path = folder_.write("input", text);
    if (kind == 0) {
      draw(offline::load_trace(path));
    } else if (kind == 1) {
      (void)offline::load_snapshot(path, 18);
    } else {
      (void)offline::load_build_record(path);
    }
  }

  static void draw(const std::vector<offline::TraceCycle>& trace) {
    for (const offline::Figure& figure :
         {offline::force_figure(trace), offline::work_figure(trace), offline::levels_figure(trace, 3)}) {
      require_right(figure.svg().size() < most_figure_bytes, "a figure is larger than its trace explains");
    }
  }

  TemporaryFolder folder_{"report_door"};
};

}  // namespace

std::unique_ptr<Door> report_door() { return std::make_unique<ReportDoor>(); }

}  // namespace greenloop
