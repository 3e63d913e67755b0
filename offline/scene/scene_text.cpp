#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "formats/write/describe.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {
namespace {

/// The shortest decimal form that reads back as the same double. Zero has no sign, as in TOML's whole numbers, and what
/// is beyond these has a point.
std::string number(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0);
  const std::string text(buffer.data(), result.ptr);
  const bool whole = text.find_first_of(".en") == std::string::npos;
  return whole && std::abs(value) > 9e15 ? text + ".0" : text;
}

/// A TOML basic string.
std::string string(std::string_view value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr std::string_view digits = "0123456789abcdef";
      text += "\\u00";
      text += digits[static_cast<unsigned char>(c) >> 4];
      text += digits[c & 15];
    } else {
      text += c;
    }
  }
  return text + '"';
}

std::string quantity(double value, std::string_view unit) { return string(number(value) + ' ' + std::string(unit)); }

std::string triple(const Eigen::Vector3d& v) {
  return std::string("[") + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + "]";
}

std::string region_text(const HalfSpace& r) {
  return std::string(r.below ? "below" : "above") + " = " + number(r.fraction) + "\naxis = \"" + "xyz"[r.axis] + "\"\n";
}

std::string region_text(const BoxRegion& r) { return "box = [" + triple(r.low) + ", " + triple(r.high) + "]\n"; }

std::string region_text(const SphereRegion& r) {
  return "sphere = { center = " + triple(r.center) +
         ", radius = " + (r.radius_in_metres ? quantity(r.radius, "m") : number(r.radius)) + " }\n";
}

std::string region_text(const NearestRegion& r) {
  return "near = " + triple(r.point) + "\ncount = " + std::to_string(r.count) + "\n";
}

std::string regions_text(const std::string& role, const std::vector<Region>& regions) {
  std::string text;
  for (const auto& region : regions) {
    text += "\n[[" + role + "]]\n" + std::visit([](const auto& shape) { return region_text(shape); }, region);
  }
  return text;
}

std::string wrap_text(const std::optional<WrapSource>& wrap) {
  if (!wrap) return "";
  std::string text = "wrap = ";
  text += wrap->length ? quantity(*wrap->length, "m") : string("auto");
  return text + (wrap->largest_piece ? "\npieces = \"largest\"\n" : "\n");
}

std::string mesh_text(const MeshSource& mesh) {
  const std::string weld =
      !mesh.weld ? "" : "weld = " + (*mesh.weld > 0 ? quantity(*mesh.weld, "m") : std::string("0")) + "\n";
  return std::string(mesh.tetrahedra ? "[volume]" : "[surface]") + "\nfile = " + string(mesh.name) + "\n" +
         (mesh.unit ? "unit = " + quantity(*mesh.unit, "m") : "size = " + quantity(*mesh.size, "m")) + "\n" + weld +
         wrap_text(mesh.wrap) + (mesh.cavities ? "cavities = true\n" : "");
}

std::string remesh_text(const Scene& scene) {
  const auto base = "base_vertices = " + std::to_string(scene.remesh.base_vertices) + "\n";
  return "\n[remesh]\n" + (scene.mesh.tetrahedra ? "" : base) + "levels = " + std::to_string(scene.remesh.levels) +
         "\n";
}

std::string material_text(const Material& material, std::optional<double> density) {
  return "\n[material]\nyoung = " + quantity(material.young, "Pa") + "\npoisson = " + number(material.poisson) + "\n" +
         (density ? "density = " + quantity(*density, "kg/m^3") + "\n" : "");
}

std::string solve_text(Elements elements) {
  return elements == Elements::quadratic ? "\n[solve]\nelements = \"quadratic\"\n" : "";
}

// goals that are not set, by zero, are left out
std::string accuracy_text(const AccuracyGoal& accuracy) {
  const auto goal = [](const std::string& key, double value) {
    return value > 0 ? "\n" + key + " = " + number(value) : std::string();
  };
  return "\n[accuracy]\nrms = " + number(accuracy.rms) + "\nworst_column = " + number(accuracy.worst_column) +
         "\npatch_force = " + number(accuracy.patch_force) + goal("field", accuracy.field) +
         goal("field_peak", accuracy.field_peak) + goal("field_rough", accuracy.field_rough) +
         goal("mesh_error", accuracy.mesh_error.value_or(0)) + "\n";
}

std::string compression_text(std::optional<layout::Wavelet> wavelet, bool ready) {
  const std::string name(wavelet ? wavelet_name(static_cast<std::uint32_t>(*wavelet)) : "auto");
  return "\n[compression]\nwavelet = \"" + name + "\"\n" + (ready ? "ready = true\n" : "");
}

std::string budget_text(const StepBudget& budget) {
  const bool priced = budget.share && !budget.work;
  return "\n[budget]\nrate = " + quantity(budget.rate, "Hz") + "\n" +
         (budget.share ? "share = " + number(*budget.share) + "\n" : "") +
         (budget.work ? "work = " + std::to_string(*budget.work) + "\n" : "") +
         (priced ? "units_per_us = " + number(budget.speed()) + "\n" : "") +
         "contacts = " + std::to_string(budget.contacts) + "\n";
}

std::string loads_text(const Scene& scene) {
  std::string text = scene.gravity ? "\n[[loads]]\ngravity = true\n" : "";
  for (const PressureLoad& load : scene.pressures) {
    text += "\n[[loads]]\nname = " + string(load.name) + "\n" +
            std::visit([](const auto& shape) { return region_text(shape); }, load.region) +
            "direction = " + (load.direction ? triple(*load.direction) : string("normal")) + "\n" +
            (load.mask ? "mask = true\n" : "");
  }
  return text;
}

std::string impulse_text(const SupportImpulse& impulse) {
  std::string text = "\n[[impulses]]\nname = " + string(impulse.name) + "\n";
  if (impulse.speed > 0) {
    text += "velocity = " + quantity(impulse.speed, "m/s") + "\ndirection = " + triple(impulse.direction) + "\n";
  }
  if (impulse.turning != 0) text += "turning = " + number(impulse.turning) + "\n";
  if (impulse.longest) text += "longest = " + quantity(*impulse.longest, "s") + "\n";
  if (!impulse.after) return text;
  text += "after = [";
  for (std::size_t i = 0; i < impulse.after->size(); ++i) text += (i > 0 ? ", " : "") + string((*impulse.after)[i]);
  return text + "]\n";
}

// what is not damped, by zero, is left out
std::string rigid_text(const RigidBox& box) { return "box = [" + triple(box.low) + ", " + triple(box.high) + "]\n"; }

std::string rigid_text(const RigidCylinder& bar) {
  return "cylinder = { from = " + triple(bar.from) + ", to = " + triple(bar.to) +
         ", radius = " + quantity(bar.radius, "m") + " }\n";
}

std::string sheet_text(const Sheet& s) {
  const auto damping = [](const std::string& key, double value) {
    return value > 0 ? key + " = " + quantity(value, "1/s") + "\n" : std::string();
  };
  std::string text = "\n[sheet]\ndensity = " + quantity(s.density, "kg/m^2") +
                     "\nstretch = " + quantity(s.stretch, "N/m") + "\nbend = " + quantity(s.bend, "N m") +
                     "\nthickness = " + quantity(s.thickness, "m") + "\nfriction = " + number(s.friction) + "\n" +
                     damping("damping", s.damping) + damping("air", s.air) + "settling = " + quantity(s.settling, "s") +
                     "\nsubsteps = " + std::to_string(s.substeps) + "\nfiner = " + std::to_string(s.finer) + "\n";
  for (const RigidShape& shape : s.rigid) {
    text += "\n[[rigid]]\n" + std::visit([](const auto& of_kind) { return rigid_text(of_kind); }, shape);
  }
  return text;
}

std::string solid_text(const Simulation& s) {
  const auto damping = [](const std::string& key, double value, std::string_view unit) {
    return value > 0 ? key + " = " + quantity(value, unit) + "\n" : std::string();
  };
  return "strain = " + string(s.corotational ? "corotational" : "linear") + "\nlevel = " + std::to_string(s.level) +
         "\n" + damping("mass_damping", s.mass_damping, "1/s") +
         damping("stiffness_damping", s.stiffness_damping, "s") + "newmark_gamma = " + number(s.newmark_gamma) + "\n";
}

std::string simulation_text(const std::optional<Simulation>& simulation) {
  if (!simulation) return "";
  const Simulation& s = *simulation;
  std::string text = "\n[simulate]\ntime_step = " + quantity(s.time_step, "s") + "\n" + (s.sheet ? "" : solid_text(s)) +
                     "rest = " + quantity(s.rest, "m") + "\nsampling = " + string(s.coverage ? "coverage" : "random") +
                     "\norbits = " + std::to_string(s.orbits) + "\nheld_out = " + std::to_string(s.held_out) +
                     "\nshortest = " + quantity(s.shortest, "s") + "\nlongest = " + quantity(s.longest, "s") +
                     "\nto_rest = " + number(s.to_rest) + "\nlongest_to_rest = " + quantity(s.longest_to_rest, "s") +
                     "\nseed = " + std::to_string(s.seed) + "\n" +
                     (s.replay_goal > 0 ? "replay_goal = " + number(s.replay_goal) + "\n" : "");
  if (s.sheet) text += sheet_text(*s.sheet);
  for (const auto& impulse : s.impulses) text += impulse_text(impulse);
  return text + (s.trajectories_name.empty() ? "" : "\n[trajectories]\nfile = " + string(s.trajectories_name) + "\n");
}

// columns do not follow from the density
std::string tables_of_body(const Scene& scene, std::optional<double> density) {
  const bool sheets = scene.simulation && scene.simulation->sheet;
  return remesh_text(scene) + (sheets ? "" : material_text(scene.material, density)) + solve_text(scene.elements) +
         regions_text("fixed", scene.fixed) + regions_text("touched", scene.touched) + regions_text("read", scene.read);
}

}  // namespace

std::string body_text(const Scene& scene) { return mesh_text(scene.mesh) + tables_of_body(scene, std::nullopt); }

std::string canonical_text(const Scene& scene) {
  const bool motion = scene.simulation && !scene.simulation->trajectories_name.empty();
  return mesh_text(scene.mesh) + (scene.mesh.keep_vertex_map ? "keep_vertex_map = true\n" : "") +
         tables_of_body(scene, scene.density) + loads_text(scene) +
         "\n[constraints]\ncoarsest = " + std::to_string(scene.coarsest_constraints) + "\n" +
         (motion ? "" : accuracy_text(scene.accuracy)) + compression_text(scene.wavelet, scene.ready) +
         budget_text(scene.budget) + (scene.store ? "\n[store]\nfile = " + string(scene.store_name) + "\n" : "") +
         simulation_text(scene.simulation);
}

}  // namespace greenloop::offline
