#include "offline/report/stability_figure.hpp"

#include <doctest/doctest.h>

#include <string>

#include "formats/testing/temporary_folder.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

const std::string header = "rate,delay,stiffness,bound,early,late,stable\n";

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_CASE("a stability map has a panel for each rate, and says how the simulation stands to the bound") {
  const TemporaryFolder folder("stability_figure_test");
  const auto points = load_stability(folder.write("map.csv", header + "500,0,100,200,1e-3,0,1\n"
                                                                      "500,0,400,200,1e-3,2e-3,0\n"
                                                                      "1000,0,300,400,1e-3,0,1\n"
                                                                      "1000,0.002,900,80,1e-3,0,1\n"));
  const Figure figure = stability_figure(points);
  CHECK(figure.name == "stability");
  CHECK(figure.panels.size() == 2);
  CHECK(has(figure.caption, "Of 2 loops below it 2 come to rest, of 2 above it 1."));
  CHECK(has(figure.svg(), "1000"));
}

TEST_CASE("a stability map that is none is refused by name") {
  const TemporaryFolder folder("stability_figure_test");
  const auto refused = [&](const std::string& text) {
    return message_of([&] { static_cast<void>(load_stability(folder.write("map.csv", text))); });
  };
  CHECK(has(refused(header), "without a single loop"));
  CHECK(has(refused(header + "500,0,100,200,0,0,1\n500,0,0,200,0,0,1\n"), "line 3"));
  CHECK(has(refused(header + "500,0,100,200,0,0,2\n"), "stable"));
  CHECK(has(refused("rate,delay\n1,2\n"), "stiffness"));
}

}  // namespace
}  // namespace greenloop::offline
