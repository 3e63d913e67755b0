#include "offline/pipeline/model_quality.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "offline/scene/scene.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
Json known(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json provenance_of(const ModelView& view) {
  return Json::parse(view.provenance.begin(), view.provenance.end(), nullptr, false);
}

std::optional<AccuracyGoal> asked_of(const Json& provenance) {
  if (!provenance.is_object() || !provenance.contains("scene_text") || !provenance["scene_text"].is_string()) return {};
  try {
    return parse_scene(provenance["scene_text"].get<std::string>(), "scene_text").accuracy;
  } catch (const std::exception&) {
    return {};  // of another version
  }
}

// of the patterns that field_rough bounds
Json rough_error(const LevelView& finest) {
  constexpr std::uint32_t most_accurate_contacts = 64;
  std::optional<double> worst;
  for (const layout::PatternRecord& record : finest.patterns) {
    const bool rough = layout::is_rough(static_cast<layout::PatternKind>(record.kind));
    if (rough && record.contacts <= most_accurate_contacts) {
      worst = std::max(worst.value_or(0), double{record.field_error[2]});
    }
  }
  return known(worst);
}

// what is not known is null
Json judged(const std::optional<double>& asked, const Json& reached) {
  constexpr double of_single_precision = 1 + 1e-6;
  Json error = {{"asked", known(asked)}, {"reached", reached}, {"held", nullptr}};
  if (asked && reached.is_number()) error["held"] = reached.get<double>() <= of_single_precision * *asked;
  return error;
}

Json compression_errors(const LevelView& finest, const std::optional<AccuracyGoal>& asked) {
  const layout::Level& level = *finest.counts;
  const auto goal = [&](double AccuracyGoal::*of) { return asked ? std::optional((*asked).*of) : std::nullopt; };
  const auto of_patterns = [&](double error) { return finest.patterns.empty() ? Json(nullptr) : Json(error); };
  return {{"rms", judged(goal(&AccuracyGoal::rms), level.rms_error)},
          {"worst_column", judged(goal(&AccuracyGoal::worst_column), level.worst_column_error)},
          {"patch_force", judged(goal(&AccuracyGoal::patch_force), level.patch_force_error)},
          {"field", judged(goal(&AccuracyGoal::field), of_patterns(level.field_error))},
          {"field_peak", judged(goal(&AccuracyGoal::field_peak), of_patterns(level.field_peak))},
          {"field_rough", judged(goal(&AccuracyGoal::field_rough), rough_error(finest))}};
}

Json mesh_error(const Json& provenance, const std::optional<AccuracyGoal>& asked) {
  const auto force = Json::json_pointer("/mesh_error/force");
  const bool known = provenance.is_object() && provenance.contains(force) && provenance[force].is_number();
  return judged(asked ? asked->mesh_error : std::nullopt, known ? provenance[force] : Json(nullptr));
}

std::string percent(const Json& value) {
  return value.is_number() ? fmt::format("{:.3g} %", 100 * value.get<double>()) : "not known";
}

// of a mesh error that nobody asked about and that is more than is asked of forces; else null
Json warning_of(const Json& mesh_error, const AccuracyGoal& asked) {
  const Json& reached = mesh_error["reached"];
  const bool judged = mesh_error["held"].is_boolean();
  if (judged || !reached.is_number() || reached.get<double>() <= asked.tolerated_mesh_error()) return nullptr;
  return fmt::format("the tetrahedra make forces of pressed patches up to {} too large (mesh error, not judged)",
                     percent(reached));
}

using Named = std::vector<std::pair<std::string, Json>>;

constexpr std::array names{"rms", "worst_column", "patch_force", "field", "field_peak", "field_rough"};

Named judged_errors(const Json& quality) {
  Named errors;
  for (const std::string name : names) {
    const Json& error = quality["compression_error"][name];
    if (error["held"].is_boolean()) errors.emplace_back("compression error (" + name + ")", error);
  }
  if (quality["mesh_error"]["held"].is_boolean()) errors.emplace_back("mesh error", quality["mesh_error"]);
  return errors;
}

void judge(Json& quality) {
  const Named errors = judged_errors(quality);
  std::vector<std::string> violated;
  for (const auto& [name, error] : errors) {
    if (!error["held"].get<bool>()) {
      violated.push_back(
          fmt::format("the {} is {} where {} is asked", name, percent(error["reached"]), percent(error["asked"])));
    }
  }
  quality["verdict"] = errors.empty() ? "NOT JUDGED" : violated.empty() ? "HELD" : "VIOLATED";
  const char* const rest = violated.size() < errors.size() ? "; all other errors are within what is asked" : "";
  const std::string found = errors.empty()     ? "the scene that the model was built from is not known"
                            : violated.empty() ? "all errors are within what is asked"
                                               : fmt::format("{}{}", fmt::join(violated, ", "), rest);
  const Json& warning = quality["warning"];
  quality["sentence"] = warning.is_null() ? found : found + "; warning: " + warning.get<std::string>();
}

std::string us_text(const Json& us) {
  return us.is_number() ? fmt::format("{:.4g} us", us.get<double>()) : "not known";
}

}  // namespace

Json quality_of(const ModelView& view, const StepCost& cost) {
  const Json provenance = provenance_of(view);
  const auto asked = asked_of(provenance);
  const Json mesh = mesh_error(provenance, asked);
  Json quality = {{"verdict", ""},
                  {"sentence", ""},
                  {"warning", warning_of(mesh, asked.value_or(AccuracyGoal{}))},
                  {"compression_error", compression_errors(view.level[view.levels - 1], asked)},
                  {"mesh_error", mesh},
                  {"step_us", {{"asked", known(cost.asked_us)}, {"reached", known(cost.us)}, {"by", cost.speed}}},
                  {"arena_bytes", known(cost.arena_bytes)}};
  judge(quality);
  return quality;
}

void print_quality(const Json& quality, std::ostream& out) {
  const auto row = [&](std::string_view name, const std::string& asked, const std::string& reached) {
    fmt::print(out, "  {:<36}{:>12}{:>14}\n", name, asked, reached);
  };
  fmt::print(out, "{}: {}\n", quality["verdict"].get<std::string>(), quality["sentence"].get<std::string>());
  row("", "asked", "reached");
  for (const std::string name : names) {
    const Json& error = quality["compression_error"][name];
    row("compression error, " + name, percent(error["asked"]), percent(error["reached"]));
  }
  const Json& mesh = quality["mesh_error"];
  row("mesh error", mesh["asked"].is_null() ? "-" : percent(mesh["asked"]), percent(mesh["reached"]));
  const Json& step = quality["step_us"];
  const std::string by = step["by"].get<std::string>();
  row("a step" + (by.empty() ? "" : ", " + by), us_text(step["asked"]), us_text(step["reached"]));
  const Json& arena = quality["arena_bytes"];
  row("RAM of a body", "", arena.is_number() ? fmt::format("{:.2f} MB", arena.get<double>() / 1e6) : "not known");
}

}  // namespace greenloop::offline
