#include "offline/cli/verify_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "formats/output/json_text.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "offline/compress/measure/certificate.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

// proves what the model claims about its least eigenvalue
void check_claim(const std::filesystem::path& file, const ModelView& view, Json& verdict) {
  const double lambda_min = view.info->lambda_min;
  Json& found = verdict["certificate"];
  found = {{"lambda_min", lambda_min}};
  const auto conclude = [&](bool holds, const std::string& message) {
    found["holds"] = holds;
    verdict["ok"] = holds;
    verdict["message"] = fmt::format("{}: {}", file.string(), message);
  };
  if (view.problem != layout::Problem::elastostatic) {
    conclude(false, fmt::format("this is a {} model; only the certificate of an elastostatic one can be checked",
                                problem_name(view.problem)));
    return;
  }
  if (view.levels < view.info->levels) {
    conclude(false, "is cut off; the certificate is that of the whole model: check that one");
    return;
  }
  if (!(lambda_min > 0)) {
    conclude(false, "carries no certificate (Info::lambda_min is 0); build the model again");
    return;
  }
  const CompressedCompliance<3> compressed(view);
  const CertificateCheck check = check_certificate(compressed, lambda_min, [](double, std::string_view) {});
  found["unknowns"] = check.unknowns;
  found["shift"] = check.shift;
  conclude(check.holds,
           check.holds
               ? fmt::format("the compliance is positive definite: all {} eigenvalues are above {:.4g} m/N",
                             check.unknowns, lambda_min)
               : fmt::format("the certificate does not hold: not all {} eigenvalues of the compliance are above "
                             "Info::lambda_min = {:.4g} m/N; build the model again",
                             check.unknowns, lambda_min));
}

// what a body of the contacts that the file asks for takes; nothing of problems that have none
Json body_of(std::span<const std::byte> file) {
  const auto opened = Model::open(file);
  if (!opened || opened.model.problem() != layout::Problem::elastostatic) return nullptr;
  const auto limits = Elastostatic::intended(opened.model).limits;
  const auto need = Elastostatic::required(opened.model, limits);
  return {{"contacts", limits.max_contacts},
          {"cached_factors", limits.cached_factors},
          {"bytes", need.bytes},
          {"least_work", need.least_work},
          {"worst_work", need.worst_work[opened.model.level_count() - 1]}};
}

Json verdict_of(const std::filesystem::path& file, bool certificate) {
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
  Json verdict = {{"ok", result.ok()},
                  {"rule", rule_name(result.rule)},
                  {"section", in_section    ? section_name(result.kind, result.a, result.b)
                              : result.ok() ? ""
                                            : "Header"},
                  {"field", result.field},
                  {"index", result.index},
                  {"value", result.value},
                  {"limit", result.limit},
                  {"message", file.string() + ": " + describe(result)}};
  if (result.ok()) verdict["body"] = body_of(bytes.span());
  if (result.ok() && certificate) check_claim(file, view, verdict);
  return verdict;
}

}  // namespace

int run_verify(const VerifyArguments& arguments, std::ostream& out) {
  Json verdict = verdict_of(arguments.file, arguments.certificate);
  const bool holds = verdict["ok"].get<bool>();
  verdict["verdict"] = holds ? "HELD" : "VIOLATED";
  out << (arguments.json ? json_text(verdict) : verdict["message"].get<std::string>()) << '\n';
  if (!arguments.json && verdict.contains("body") && verdict["body"].is_object()) {
    const Json& body = verdict["body"];
    out << fmt::format("a body of {} contacts and {} factors takes {:.1f} MB and at most {} units a step\n",
                       body["contacts"].get<std::uint64_t>(), body["cached_factors"].get<std::uint64_t>(),
                       body["bytes"].get<double>() / 1e6, body["worst_work"].get<std::uint64_t>());
  }
  return holds ? 0 : 1;
}

void add_verify(CLI::App& parent, int& exit_code) {
  CLI::App* command = parent.add_subcommand("verify", "Check every field and checksum of a model file");
  const auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("model", arguments->file, "Model file (.gloop)")->required();
  command->add_flag(
      "--certificate", arguments->certificate,
      "Also prove that the compliance is positive definite: a Cholesky factorisation in double precision, "
      "72 bytes times the square of the domain nodes");
  command->add_flag("--json", arguments->json, "Print the verdict as JSON");
  command->callback([arguments, &exit_code] {
    std::ostringstream out;
    exit_code = run_verify(*arguments, out);
    print_result(out.str());
  });
}

}  // namespace greenloop::offline
