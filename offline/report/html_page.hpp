#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "offline/report/figure.hpp"
#include "offline/report/model_facts.hpp"

namespace greenloop::offline {

/// A number that stands out at the head of the page.
struct KeyFigure {
  enum class Mood { plain, good, bad };
  std::string value;
  std::string name;
  Mood mood = Mood::plain;
};

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

  void key_figures(const std::vector<KeyFigure>& figures);
  void heading(std::string_view text);
  void paragraph(std::string_view text);
  void figure(const Figure& figure);
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
