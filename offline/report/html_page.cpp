#include "offline/report/html_page.hpp"

#include <fmt/format.h>

#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

constexpr std::string_view style = R"(
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,
"Helvetica Neue",Arial,sans-serif;-webkit-text-size-adjust:100%}
main{max-width:940px;margin:0 auto;padding:40px 28px 72px}
header{border-bottom:2px solid var(--ink);padding-bottom:12px;margin-bottom:20px}
h1{font-size:28px;line-height:1.2;margin:0;letter-spacing:-.01em;overflow-wrap:anywhere}
header p{margin:6px 0 0;color:var(--muted)}
h2,summary{font-size:20px;font-weight:650;line-height:1.3}
h2{margin:40px 0 12px}
h3{font-size:16px;margin:0 0 6px}
p{max-width:46em}
.verdict{border:1px solid var(--rule);border-left:6px solid var(--rule);border-radius:6px;padding:4px 18px 12px;background:var(--panel)}
.verdict.good{border-left-color:var(--green)}
.verdict.bad{border-left-color:var(--vermilion)}
.verdict p{font-size:18px;font-weight:600;line-height:1.4;margin:12px 0}
.verdict td,.verdict th{border-color:var(--rule)}
.verdict .mark{font-weight:700;padding-left:10px;width:1.8em}
.verdict .good .mark{color:var(--green)}
.verdict .bad .mark{color:var(--vermilion)}
.verdict .bad td{font-weight:650}
.figures,.panels{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,330px),1fr));gap:8px 28px;align-items:start}
figure{margin:0 0 24px}
figure svg{display:block;width:100%;height:auto}
figcaption{color:var(--muted);font-size:15px;line-height:1.45;margin-top:8px;max-width:56em}
details{border-top:1px solid var(--rule);margin-top:14px}
details:last-of-type{border-bottom:1px solid var(--rule)}
summary{cursor:pointer;padding:12px 0}
.groups{columns:330px 2;column-gap:44px}
.groups>div{break-inside:avoid;padding-top:1px}
.groups h3,.text h3{font-size:14px;margin:18px 0 4px;text-transform:uppercase;letter-spacing:.05em;color:var(--muted)}
table{border-collapse:collapse;width:100%;font-size:15px;font-variant-numeric:tabular-nums}
td,th{padding:5px 0 5px 14px;border-bottom:1px solid var(--grid);text-align:right;vertical-align:top;font-weight:400}
td:first-child,th:first-child{text-align:left;padding-left:0}
thead th{color:var(--muted);font-size:14px;line-height:1.3;vertical-align:bottom;border-bottom:1.5px solid var(--rule)}
.text pre{background:var(--panel);border-radius:6px;padding:12px 16px}
.groups th{color:var(--muted)}
.groups td{overflow-wrap:anywhere}
.wide{overflow-x:auto}
.wide .many{min-width:640px}
.missing{background:var(--panel);border-left:4px solid var(--orange);border-radius:6px;padding:4px 20px 10px;margin:20px 0}
.missing p{margin:10px 0 2px}
pre{margin:2px 0 10px;font:14px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace;white-space:pre-wrap;
overflow-wrap:anywhere}
@media screen and (max-width:600px){main{padding:18px 12px 48px}.verdict{padding:2px 10px 8px}td,th{padding-left:8px}}
@media print{@page{margin:16mm}body{font-size:10.5pt}main{max-width:none;padding:0}
figure,.missing,.verdict,tr{break-inside:avoid}h2,h3,summary{break-after:avoid}
.verdict,.missing{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)";

const char* mood(const std::optional<bool>& held) { return !held ? "" : *held ? "good" : "bad"; }

const char* mark(const std::optional<bool>& held) { return !held ? "" : *held ? "✓" : "✗"; }

}  // namespace

HtmlPage::HtmlPage(std::string_view title, std::string_view subtitle) : title_(title) {
  body_ = fmt::format("<header><h1>{}</h1><p>{}</p></header>\n", escape_markup(title), escape_markup(subtitle));
}

void HtmlPage::verdict(const Verdict& verdict) {
  body_ += fmt::format("<section class=\"verdict {}\">\n<p>{}</p>\n<table>\n", mood(verdict.good),
                       escape_markup(verdict.sentence));
  body_ +=
      "<thead><tr><th></th><th scope=\"col\">asked</th><th scope=\"col\">reached</th><th></th></tr></thead>\n<tbody>\n";
  for (const Judgement& row : verdict.rows) {
    body_ += fmt::format("<tr class=\"{}\"><td>{}</td><td>{}</td><td>{}</td><td class=\"mark\">{}</td></tr>\n",
                         mood(row.held), escape_markup(row.what), escape_markup(row.asked), escape_markup(row.reached),
                         mark(row.held));
  }
  body_ += "</tbody></table>\n</section>\n";
}

void HtmlPage::heading(std::string_view text) { body_ += fmt::format("<h2>{}</h2>\n", escape_markup(text)); }

void HtmlPage::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", escape_markup(text)); }

void HtmlPage::figure(const Figure& figure) {
  body_ += fmt::format(
      "<figure id=\"{}\">\n<h3>{}</h3>\n<div class=\"panels\">\n{}</div>\n<figcaption>{}</figcaption></figure>\n",
      escape_markup(figure.name), escape_markup(figure.title), figure.svg(), escape_markup(figure.caption));
}

void HtmlPage::figures(const std::vector<Figure>& figures) {
  if (figures.empty()) return;
  body_ += "<div class=\"figures\">\n";
  for (const Figure& figure : figures) this->figure(figure);
  body_ += "</div>\n";
}

void HtmlPage::begin_fold(std::string_view title) {
  body_ += fmt::format("<details>\n<summary>{}</summary>\n", escape_markup(title));
}

void HtmlPage::end_fold() { body_ += "</details>\n"; }

void HtmlPage::facts(const std::vector<FactGroup>& groups) {
  std::string texts;
  body_ += "<div class=\"groups\">\n";
  for (const FactGroup& group : groups) {
    body_ += fmt::format("<div><h3>{}</h3><table>\n", escape_markup(group.title));
    for (const Fact& fact : group.facts) {
      const std::string name = escape_markup(fact.name), value = escape_markup(fact.value);
      if (fact.value.find('\n') != std::string::npos) {
        texts += fmt::format("<div class=\"text\"><h3>{}</h3><pre>{}</pre></div>\n", name, value);
      } else {
        body_ += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, value);
      }
    }
    body_ += "</table></div>\n";
  }
  body_ += "</div>\n" + texts;
}

void HtmlPage::table(const Table& table, std::string_view caption) {
  constexpr std::size_t few = 4;  // columns that a telephone holds
  body_ += fmt::format("<figure><div class=\"wide\"><table{}>\n<thead><tr>",
                       table.head.size() > few ? " class=\"many\"" : "");
  for (const std::string& cell : table.head) body_ += fmt::format("<th scope=\"col\">{}</th>", escape_markup(cell));
  body_ += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) body_ += fmt::format("<td>{}</td>", escape_markup(cell));
    body_ += "</tr>\n";
  }
  body_ += fmt::format("</tbody></table></div><figcaption>{}</figcaption></figure>\n", escape_markup(caption));
}

void HtmlPage::missing(const std::vector<MissingInput>& inputs) {
  if (inputs.empty()) return;
  heading("Not in this report");
  body_ += "<div class=\"missing\">\n";
  for (const MissingInput& input : inputs) {
    body_ +=
        fmt::format("<p>{}. To get it:</p><pre>{}</pre>\n", escape_markup(input.what), escape_markup(input.command));
  }
  body_ += "</div>\n";
}

std::string HtmlPage::str() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      escape_markup(title_), theme_css(), style, body_);
}

}  // namespace greenloop::offline
