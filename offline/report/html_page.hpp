#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "offline/report/figure.hpp"
#include "offline/report/model_facts.hpp"
#include "offline/report/verdict.hpp"

namespace greenloop::offline {

/// Something the report could show but was not given.
struct MissingInput {
  std::string what;     ///< "force over time"
  std::string command;  ///< that makes it
};

/// Writes one HTML page that needs nothing else: styles and drawings inside, no script, no address to fetch from.
/// All text is escaped. Sections appear in the order of the calls.
class HtmlPage {
 public:
  HtmlPage(std::string_view title, std::string_view subtitle);

  /// The sentence, and what was asked beside what is reached.
  void verdict(const Verdict& verdict);
  void heading(std::string_view text);
  void paragraph(std::string_view text);
  /// Figures of one panel side by side where there is room.
  void figures(const std::vector<Figure>& figures);
  /// One figure, its panels side by side where there is room.
  void figure(const Figure& figure);
  /// What is added up to end_fold is shown where the reader opens `title`.
  void begin_fold(std::string_view title);
  void end_fold();
  /// Groups of facts side by side; values of several lines stand below them.
  void facts(const std::vector<FactGroup>& groups);
  void table(const Table& table, std::string_view caption);
  void missing(const std::vector<MissingInput>& inputs);

  /// The complete document.
  [[nodiscard]] std::string str() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace greenloop::offline
