// docs/format.md says what the code does: its worked example is the smallest model's file, its tables name every rule,
// its chapters every kind of section.

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/synthetic_multigrid.hpp"
#include "formats/transport/stream.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/ready_file.hpp"

namespace greenloop {
namespace {

std::string document() {
  std::ifstream file(GREENLOOP_FORMAT_DOCUMENT);
  REQUIRE_MESSAGE(file.good(), "cannot read ", GREENLOOP_FORMAT_DOCUMENT);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The bytes of a dump as `hexdump -C` prints it, indented by four; what a line of "*" stands for is zero here.
std::vector<std::byte> dumped_bytes(const std::string& text) {
  std::vector<std::byte> bytes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.size() < 12 || line.find("    0") != 0 || line.find_first_not_of("0123456789abcdef", 4) < 12) continue;
    bytes.resize(std::stoul(line.substr(4, 8), nullptr, 16));
    std::istringstream numbers(line.substr(12, line.find('|') - 12));
    for (std::string number; numbers >> number;) {
      bytes.push_back(static_cast<std::byte>(std::stoul(number, nullptr, 16)));
    }
  }
  return bytes;
}

TEST_CASE("docs/format.md: the worked example is the smallest model, byte for byte, and is accepted") {
  const auto file = encode(smallest_model());
  CHECK(dumped_bytes(document()) == file);
  ModelMutant mutant(file);
  CHECK(mutant.verdict().ok());
  CHECK(mutant.view().node_count == 3);
  CHECK(mutant.view().level[0].couplings[0].columns == 2);
}

// "Couplings" of "Couplings(q, layer)   layer = 0 .. 3    kind 11": what stands before the first bracket or blank.
std::string first_word(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  return line.substr(begin, line.find_first_of("( ,", begin) - begin);
}

// how many indices a name is written with: two in "Couplings(q, layer)"
std::uint32_t indices_of(const std::string& line) {
  const std::size_t name_end = line.find_first_not_of(' ') + first_word(line).size();
  if (line.size() == name_end || line[name_end] != '(') return 0;
  const std::string list = line.substr(name_end, line.find(')', name_end) - name_end);
  return 1 + static_cast<std::uint32_t>(std::count(list.begin(), list.end(), ','));
}

// The lines of "Order of the sections" that name a kind.
std::vector<std::string> order_lines() {
  std::istringstream lines(document());
  std::vector<std::string> order;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("    ", 0) == 0 && line.find("  kind ") != std::string::npos) order.push_back(line);
  }
  return order;
}

const layout::SectionForm& form_named(const std::string& name) {
  const auto* form = std::find_if(std::begin(layout::section_forms), std::end(layout::section_forms),
                                  [&](const layout::SectionForm& one) { return one.name == name; });
  REQUIRE_MESSAGE(form != std::end(layout::section_forms), "no kind is named ", name);
  return *form;
}

TEST_CASE("docs/format.md: the order of the sections names every kind with its number and its indices, and no other") {
  std::set<std::string> named;
  for (const std::string& line : order_lines()) {
    CAPTURE(line);
    const layout::SectionForm& form = form_named(first_word(line));
    CHECK(std::stoul(line.substr(line.find("  kind ") + 7)) == static_cast<std::uint32_t>(form.kind));
    CHECK(indices_of(line) == form.indices);
    named.insert(form.name);
  }
  CHECK(named.size() == std::size(layout::section_forms));
}

TEST_CASE("docs/format.md: every kind has a chapter, which says how long an element is") {
  std::istringstream lines(document());
  std::set<std::string> described;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("### ", 0) != 0) continue;
    const std::string heading = line.substr(4);
    for (const layout::SectionForm& form : layout::section_forms) {
      if (first_word(heading) != form.name) continue;
      CAPTURE(heading);
      CHECK(indices_of(heading) == form.indices);
      const std::string length = ", " + std::to_string(form.element_bytes) + " bytes × ";
      CHECK((form.element_bytes == 1 || heading.find(length) != std::string::npos));
      described.insert(form.name);
    }
  }
  CHECK(described.size() == std::size(layout::section_forms));
}

TEST_CASE("docs/format.md: the sections of a level stand in the order it says, and every kind in some file") {
  std::vector<std::uint32_t> order;
  for (const std::string& line : order_lines()) {
    order.push_back(static_cast<std::uint32_t>(form_named(first_word(line)).kind));
  }
  const auto place = [&](std::uint32_t kind) { return std::find(order.begin(), order.end(), kind) - order.begin(); };
  std::set<std::uint32_t> seen;
  for (const layout::Wavelet wavelet : layout::wavelets) {
    ModelMutant plain(SyntheticOptions{.levels = 2, .wavelet = wavelet, .vertices = 5, .gravity = true});
    REQUIRE(plain.verdict().ok());
    ModelMutant file(ready_file(plain.bytes(), std::vector<std::uint8_t>(plain.view().domain_count, 1)));
    std::uint32_t before = 0;
    for (const layout::SectionEntry& entry : file.table()) {
      const bool next_level = entry.kind == static_cast<std::uint32_t>(layout::SectionKind::level);
      CHECK((next_level || place(entry.kind) >= place(before) || before == 0));
      before = entry.kind;
      seen.insert(entry.kind);
    }
  }
  std::uint32_t before = 0;
  ModelMutant moving(encoded_file(synthetic_motion({.transfer_modes = 2})).bytes.span());
  for (const layout::SectionEntry& entry : moving.table()) {
    const bool next_level = entry.kind == static_cast<std::uint32_t>(layout::SectionKind::level);
    CHECK((next_level || place(entry.kind) >= place(before) || before == 0));
    before = entry.kind;
    seen.insert(entry.kind);
  }
  before = 0;
  ModelMutant elastic(encoded_file(synthetic_multigrid({})).bytes.span());
  for (const layout::SectionEntry& entry : elastic.table()) {
    const bool next_grid = entry.kind == static_cast<std::uint32_t>(layout::SectionKind::grid);
    CHECK((next_grid || place(entry.kind) >= place(before) || before == 0));
    before = entry.kind;
    seen.insert(entry.kind);
  }
  CHECK(seen.size() == std::size(layout::section_forms));
}

TEST_CASE("docs/format.md: names every rule by which a file can be refused") {
  const std::string text = document();
  for (int i = 1; i <= static_cast<int>(VerifyRule::inconsistent); ++i) {
    const std::string row = "| `" + std::string(rule_name(static_cast<VerifyRule>(i))) + "` |";
    CAPTURE(row);
    CHECK(text.find(row) != std::string::npos);
  }
}

TEST_CASE("docs/format.md: names every rule by which a transport form can be refused") {
  const std::string text = document();
  for (int i = 1; i <= static_cast<int>(transport::StreamRule::not_a_model); ++i) {
    const std::string row = "| `" + std::string(rule_name(static_cast<transport::StreamRule>(i))) + "` |";
    CAPTURE(row);
    CHECK(text.find(row) != std::string::npos);
  }
}

}  // namespace
}  // namespace greenloop
