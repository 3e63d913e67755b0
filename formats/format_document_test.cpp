// docs/format.md says what the code does: its worked example is the smallest model's file, its tables name every rule.

#include <doctest/doctest.h>

#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "formats/testing/model_mutant.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/transport/stream.hpp"
#include "formats/write/describe.hpp"

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
