#include "offline/scene/sheet_parser.hpp"

#include <algorithm>
#include <string>

namespace greenloop::offline {
namespace {

constexpr std::size_t most_rigid = 1000;

/// Three lengths in metres.
std::optional<Eigen::Vector3d> metres(const toml::node* node) {
  const auto* array = node != nullptr ? node->as_array() : nullptr;
  if (array == nullptr || array->size() != 3) return std::nullopt;
  Eigen::Vector3d result;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*array)[i].is_number()) return std::nullopt;
    result[static_cast<Eigen::Index>(i)] = *(*array)[i].value<double>();
  }
  return result.allFinite() ? std::optional(result) : std::nullopt;
}

void read_box(const Table& table, std::vector<RigidShape>& rigid) {
  const auto* array = table.find("box")->as_array();
  const bool two = array != nullptr && array->size() == 2;
  const auto low = two ? metres(array->get(0)) : std::nullopt, high = two ? metres(array->get(1)) : std::nullopt;
  if (!low || !high || !(low->array() < high->array()).all()) {
    table.refuse("box", "expected two corners in metres, the lower one first, such as [[0, -1, -0.04], [1, 0, 0]]");
    return;
  }
  rigid.emplace_back(RigidBox{*low, *high});
}

void read_cylinder(const Table& table, std::vector<RigidShape>& rigid) {
  const auto cylinder = section(table, "cylinder", {"from", "to", "radius"});
  if (!cylinder) return;
  cylinder->require("radius", "radius = \"8 mm\"");
  const auto from = metres(cylinder->find("from")), to = metres(cylinder->find("to"));
  const auto radius = cylinder->quantity("radius", Dimension::length);
  if (!from || !to || *from == *to) {
    table.refuse("cylinder", "expected two places in metres, such as from = [0, 0, 0], to = [0, 0, 0.07]");
  } else if (radius) {
    rigid.emplace_back(RigidCylinder{*from, *to, *radius});
  }
}

void read_shape(const Table& table, std::vector<RigidShape>& rigid) {
  if (table.has("box") == table.has("cylinder")) {
    table.refuse_table("expected either a box or a cylinder");
  } else if (table.has("box")) {
    read_box(table, rigid);
  } else {
    read_cylinder(table, rigid);
  }
}

void read_rigid(const Table& scene, std::vector<RigidShape>& rigid) {
  const auto* node = scene.find("rigid");
  if (node == nullptr) return;
  const auto* array = node->as_array();
  const bool tables = array != nullptr && array->size() <= most_rigid &&
                      std::all_of(array->begin(), array->end(), [](const toml::node& item) { return item.is_table(); });
  if (!tables) {
    scene.refuse("rigid", "expected tables [[rigid]], such as [[rigid]] box = [[0, -1, -0.04], [1, 0, 0]]");
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    read_shape(
        Table(*(*array)[i].as_table(), "rigid[" + std::to_string(i) + "]", {"box", "cylinder"}, scene.problems()),
        rigid);
  }
}

}  // namespace

std::optional<Sheet> read_sheet(const Table& scene) {
  const auto table = section(
      scene, "sheet",
      {"density", "stretch", "bend", "thickness", "friction", "damping", "air", "settling", "substeps", "finer"});
  if (!table) {
    if (scene.has("rigid")) scene.refuse("rigid", "belong to a [sheet] section, which is missing");
    return std::nullopt;
  }
  Sheet sheet;
  table->require("density", "density = \"0.2 kg/m^2\"");
  table->require("stretch", "stretch = \"500 N/m\"");
  table->require("bend", "bend = \"0.1 mN m\"");
  table->require("thickness", "thickness = \"3 mm\"");
  set_if(sheet.density, table->quantity("density", Dimension::sheet_density));
  set_if(sheet.stretch, table->quantity("stretch", Dimension::tension));
  set_if(sheet.bend, table->quantity("bend", Dimension::torque));
  set_if(sheet.thickness, table->quantity("thickness", Dimension::length));
  set_if(sheet.friction, table->number("friction", fraction));
  set_if(sheet.damping, table->quantity("damping", Dimension::rate));
  set_if(sheet.air, table->quantity("air", Dimension::rate));
  set_if(sheet.settling, table->quantity("settling", Dimension::time));
  set_if(sheet.substeps, table->integer("substeps", 1, 1000));
  set_if(sheet.finer, table->integer("finer", 0, 4));
  read_rigid(scene, sheet.rigid);
  return sheet;
}

}  // namespace greenloop::offline
