#include "offline/scene/multigrid_scene.hpp"

#include <string>

#include "formats/layout/multigrid.hpp"
#include "offline/scene/toml_source.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {
namespace {

constexpr Interval poisson_ratio{-1, 0.5, true, true};

void read_strain(const Table& table, MultigridBody& body) {
  const auto name = table.string("strain");
  if (!name) return;
  using Strain = MultigridBody::Strain;
  constexpr std::array<const char*, 3> names{"linear", "corotational", "green"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (*name == names[i]) {
      body.strain = static_cast<Strain>(i);
      return;
    }
  }
  table.refuse("strain", "\"" + *name + R"(" is none of "linear", "corotational", "green")");
}

void read_gravity(const Table& table, Eigen::Vector3d& gravity) {
  if (!table.has("gravity")) return;
  const auto* array = table.find("gravity")->as_array();
  bool valid = array != nullptr && array->size() == 3;
  for (std::size_t i = 0; valid && i < 3; ++i) {
    valid = (*array)[i].is_number();
    gravity[static_cast<Eigen::Index>(i)] = (*array)[i].value<double>().value_or(0);
  }
  if (!valid || !(gravity.cwiseAbs().maxCoeff() <= 1e6)) {
    table.refuse("gravity", "expected three accelerations in m/s^2, such as [0, 0, -9.81]");
  }
}

void read_part(const Table& table, MatterPart part, std::vector<MatterPart>& parts) {
  table.require("box", "box = [[0, 0, 0], [1, 0.5, 1]]");
  const auto* box = table.has("box") ? table.find("box")->as_array() : nullptr;
  set_if(part.material.young, table.quantity("young", Dimension::pressure));
  set_if(part.material.poisson, table.number("poisson", poisson_ratio));
  set_if(part.density, table.quantity("density", Dimension::density));
  if (box == nullptr || box->size() != 2) {
    if (table.has("box")) table.refuse("box", "expected two corners, such as [[0, 0, 0], [1, 0.5, 1]]");
    return;
  }
  const auto low = table.fractions("box", (*box)[0]), high = table.fractions("box", (*box)[1]);
  if (!low || !high) return;
  part.box = {*low, *high};
  parts.push_back(part);
}

void read_parts(const Table& multigrid, const Scene& scene, std::vector<MatterPart>& parts) {
  const auto* node = multigrid.find("parts");
  if (node == nullptr) return;
  const auto* array = node->as_array();
  if (array == nullptr || !array->is_array_of_tables() || array->size() >= layout::most_matters) {
    multigrid.refuse("parts", "expected at most 255 tables [[multigrid.parts]] with a box and a material");
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    read_part(Table(*(*array)[i].as_table(), "multigrid.parts[" + std::to_string(i) + "]",
                    {"box", "young", "poisson", "density"}, multigrid.problems()),
              {{}, scene.material, scene.density.value_or(0)}, parts);
  }
}

void read_body(const Table& table, MultigridBody& body) {
  read_strain(table, body);
  read_gravity(table, body.gravity);
  body.time_step = 1 / body.scene.budget.rate;
  set_if(body.time_step, table.quantity("time_step", Dimension::time));
  body.level = body.scene.remesh.levels;
  set_if(body.level, table.integer("level", 0, most_levels));
  if (body.level > body.scene.remesh.levels) {
    table.refuse("level",
                 "is finer than the finest level; remesh.levels is " + std::to_string(body.scene.remesh.levels));
  }
  set_if(body.mass_damping, table.quantity("mass_damping", Dimension::rate));
  set_if(body.stiffness_damping, table.quantity("stiffness_damping", Dimension::time));
  set_if(body.numerical_damping, table.number("numerical_damping", {0, 1}));
  set_if(body.coarsest, table.integer("coarsest", 8, layout::most_coarsest_vertices));
  read_parts(table, body.scene, body.parts);
  if (!body.scene.density) {
    table.refuse_table("needs the body's mass: write for example [material] density = \"1000 kg/m^3\"");
  }
  if (body.scene.mesh.tetrahedra) {
    table.refuse_table("goes with [surface], whose inside it fills with tetrahedra");
  }
}

}  // namespace

std::optional<MultigridBody> parse_multigrid_scene(std::string_view text, const std::filesystem::path& file) {
  const auto toml = parse_toml(text, file);
  const auto* table = toml.contains("multigrid") ? toml["multigrid"].as_table() : nullptr;
  if (table == nullptr) return std::nullopt;
  MultigridBody body{.scene = parse_scene(text, file)};
  Problems problems(file.string());
  read_body(Table(*table, "multigrid",
                  {"strain", "time_step", "level", "mass_damping", "stiffness_damping", "numerical_damping", "gravity",
                   "coarsest", "parts"},
                  problems),
            body);
  problems.throw_if_any();
  return body;
}

std::optional<MultigridBody> read_multigrid_scene(const std::filesystem::path& file) {
  return parse_multigrid_scene(scene_file_text(file), file);
}

}  // namespace greenloop::offline
