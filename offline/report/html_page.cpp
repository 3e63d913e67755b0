#include "offline/report/html_page.hpp"

#include <fmt/format.h>

#include "offline/report/theme.hpp"

namespace greenloop::offline {
namespace {

constexpr std::string_view style = R"(
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,
"Helvetica Neue",Arial,sans-serif;-webkit-text-size-adjust:100%}
main{max-width:920px;margin:0 auto;padding:44px 28px 72px}
header{border-bottom:2px solid var(--ink);padding-bottom:14px;margin-bottom:26px}
h1{font-size:29px;line-height:1.2;margin:0;letter-spacing:-.01em;overflow-wrap:anywhere}
header p{margin:6px 0 0;color:var(--muted)}
h2{font-size:20px;margin:44px 0 12px;line-height:1.3}
p{max-width:46em}
.keys{display:grid;grid-template-columns:repeat(auto-fit,minmax(128px,1fr));gap:12px;margin:0 0 8px;padding:0}
.key{background:var(--panel);border-radius:6px;padding:13px 15px 11px;border-left:4px solid var(--rule)}
.key.good{border-left-color:var(--green)}
.key.bad{border-left-color:var(--vermilion)}
.key b{display:block;font-size:22px;line-height:1.25;font-weight:600;font-variant-numeric:tabular-nums}
.key span{font-size:13.5px;color:var(--muted);line-height:1.35;display:block}
figure{margin:14px 0 34px}
figure svg{display:block;width:100%;height:auto}
figcaption{color:var(--muted);font-size:14.5px;margin-top:10px;max-width:56em}
.groups{columns:330px 2;column-gap:44px}
.groups>div{break-inside:avoid;padding-top:1px}
.groups h3,.text h3{font-size:13px;margin:18px 0 4px;text-transform:uppercase;letter-spacing:.06em;color:var(--muted)}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums}
td,th{padding:5px 0 5px 14px;border-bottom:1px solid var(--grid);text-align:right;vertical-align:top;font-weight:400}
td:first-child,th:first-child{text-align:left;padding-left:0}
thead th{color:var(--muted);font-size:13px;line-height:1.3;vertical-align:bottom;border-bottom:1.5px solid var(--rule)}
.text pre{background:var(--panel);border-radius:6px;padding:12px 16px}
.groups th{color:var(--muted)}
.groups td{overflow-wrap:anywhere}
.wide{overflow-x:auto}
.missing{background:var(--panel);border-left:4px solid var(--orange);border-radius:6px;padding:4px 20px 10px;margin:20px 0}
.missing p{margin:10px 0 2px}
pre{margin:2px 0 10px;font:13.5px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace;white-space:pre-wrap;
overflow-wrap:anywhere}
@media print{@page{margin:16mm}.keys{grid-template-columns:repeat(3,1fr)}body{font-size:10.5pt}main{max-width:none;padding:0}
figure,.missing,.keys,tr{break-inside:avoid}h2,h3{break-after:avoid}
.key,.missing{border:1px solid var(--rule);border-left-width:4px;-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)";

const char* mood_class(KeyFigure::Mood mood) {
  switch (mood) {
    case KeyFigure::Mood::good:
      return " good";
    case KeyFigure::Mood::bad:
      return " bad";
    case KeyFigure::Mood::plain:
      break;
  }
  return "";
}

}  // namespace

HtmlPage::HtmlPage(std::string_view title, std::string_view subtitle) : title_(title) {
  body_ = fmt::format("<header><h1>{}</h1><p>{}</p></header>\n", escape_markup(title), escape_markup(subtitle));
}

void HtmlPage::key_figures(const std::vector<KeyFigure>& figures) {
  body_ += "<div class=\"keys\">\n";
  for (const KeyFigure& figure : figures) {
    body_ += fmt::format("<div class=\"key{}\"><b>{}</b><span>{}</span></div>\n", mood_class(figure.mood),
                         escape_markup(figure.value), escape_markup(figure.name));
  }
  body_ += "</div>\n";
}

void HtmlPage::heading(std::string_view text) { body_ += fmt::format("<h2>{}</h2>\n", escape_markup(text)); }

void HtmlPage::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", escape_markup(text)); }

void HtmlPage::figure(const Figure& figure) {
  heading(figure.title);
  body_ += fmt::format("<figure id=\"{}\">\n{}<figcaption>{}</figcaption></figure>\n", escape_markup(figure.name),
                       figure.svg, escape_markup(figure.caption));
}

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
  body_ += "<figure><div class=\"wide\"><table>\n<thead><tr>";
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
