#include "offline/cli/verify_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "formats/describe.hpp"
#include "formats/model_file.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

Json verdict_of(const std::filesystem::path& file) {
  AlignedBytes bytes;
  try {
    bytes = load_file(file);
  } catch (const std::runtime_error& error) {
    return {{"ok", false}, {"rule", "unreadable"}, {"section", ""},    {"field", ""},
            {"index", 0},  {"value", nullptr},     {"limit", nullptr}, {"message", error.what()}};
  }
  ModelView view;
  const VerifyResult result = verify(bytes.span(), view);
  const bool in_section = result.kind != layout::SectionKind{};
  return {{"ok", result.ok()},
          {"rule", rule_name(result.rule)},
          {"section", in_section    ? section_name(result.kind, result.a, result.b)
                      : result.ok() ? ""
                                    : "Header"},
          {"field", result.field},
          {"index", result.index},
          {"value", result.value},
          {"limit", result.limit},
          {"message", file.string() + ": " + describe(result)}};
}

}  // namespace

int run_verify(const VerifyArguments& arguments, std::ostream& out) {
  const Json verdict = verdict_of(arguments.file);
  out << (arguments.json ? verdict.dump(2) : verdict["message"].get<std::string>()) << '\n';
  return verdict["ok"].get<bool>() ? 0 : 1;
}

void add_verify(CLI::App& parent, int& exit_code) {
  CLI::App* command = parent.add_subcommand("verify", "Check every field and checksum of a model file");
  const auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("model", arguments->file, "Model file (.gloop)")->required();
  command->add_flag("--json", arguments->json, "Print the verdict as JSON");
  command->callback([arguments, &exit_code] { exit_code = run_verify(*arguments, std::cout); });
}

}  // namespace greenloop::offline
