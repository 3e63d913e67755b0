#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/write/model_file.hpp"
#include "offline/report/figure.hpp"
#include "offline/report/html_page.hpp"

namespace greenloop::offline {

/// The files a report is made of; all but the model may be absent.
struct ReportInputs {
  std::filesystem::path model;
  std::optional<std::filesystem::path> trace;        ///< of greenloop-loop --trace
  std::optional<std::filesystem::path> snapshot;     ///< of greenloop-loop --snapshot
  std::optional<std::filesystem::path> build;        ///< of greenloop build
  std::vector<std::filesystem::path> more_traces{};  ///< of other runs
  std::optional<std::filesystem::path> stability{};  ///< of greenloop-loop --stability
  bool provenance = false;                           ///< shown as well
  std::optional<double> mask{};                      ///< m, radius of masks whose stiffness is shown
};

/// A finished report.
struct Report {
  std::string html;
  std::vector<Figure> figures;
  std::vector<MissingInput> missing;
};

/// Draws and writes the whole report of a verified model; what an absent input would have shown is listed with the
/// command that makes it. Throws std::runtime_error naming file, field and value if an input is wrong. Work: linear in
/// the inputs, plus rendering; a few seconds. The same inputs give the same bytes.
[[nodiscard]] Report make_report(const ModelFile& model, const ReportInputs& inputs);

/// Where write_figures puts one.
[[nodiscard]] std::filesystem::path figure_path(const std::filesystem::path& folder, const Figure& figure);

/// Writes every figure as a file of its own into `folder`, which is made if need be.
void write_figures(const std::filesystem::path& folder, const std::vector<Figure>& figures);

}  // namespace greenloop::offline
