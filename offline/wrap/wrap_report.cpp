#include <fmt/format.h>

#include "offline/wrap/wrap.hpp"

namespace greenloop::offline {
namespace {

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string deviation_text(const Deviation& d, const std::string& unit) {
  return fmt::format("{:.2g} {} at most, {:.2g} {} RMS", d.greatest, unit, d.rms, unit);
}

}  // namespace

std::vector<std::string> describe_wrap(const WrapReport& report, const std::string& unit) {
  std::vector<std::string> text;
  const auto note = [&](bool when, const std::string& sentence) {
    if (when) text.push_back(sentence);
  };
  const bool sheet = report.plate_thickness.has_value();
  text.push_back(fmt::format("wrapped at {:.3g} {} in {} triangles", report.length, unit, report.triangles));
  note(report.rounding > 0,
       fmt::format("rounded: parts thinner than {0:.2g} {1} thickened to it, gaps narrower than that closed, edges "
                   "rounded",
                   2 * report.rounding, unit));
  note(sheet, fmt::format("an open sheet ({:.0f} % of its area has nothing behind it) made a plate {:.3g} {} thick",
                          100 * report.sheet_share, report.plate_thickness.value_or(0), unit));
  note(!sheet && report.boundary_loops > 0,
       counted(report.boundary_loops, "boundary of open faces", "boundaries of open faces") + " closed");
  note(!sheet && report.sheet_share > 0.0005,
       fmt::format("{:.2g} % of the area has nothing behind it and was dropped", 100 * report.sheet_share));
  note(report.inner_share > 0.0005,
       fmt::format("{:.2g} % of the area lies inside the body and was dropped", 100 * report.inner_share));
  note(report.filled_shells > 0, counted(report.filled_shells, "inner shell", "inner shells") + " filled");
  note(report.pieces_dropped > 0, counted(report.pieces_dropped, "smaller piece", "smaller pieces") +
                                      fmt::format(" of {:.2g} % of the volume dropped", 100 * report.dropped_share));
  note(!report.crossing_pairs, "more faces cross than were counted");
  note(report.crossing_pairs.value_or(0) > 0,
       counted(report.crossing_pairs.value_or(0), "pair of faces crosses", "pairs of faces cross"));
  note(report.misoriented_edges > 0,
       counted(report.misoriented_edges, "edge along which", "edges along which") + " faces look to different sides");
  note(report.useless_faces > 0,
       counted(report.useless_faces, "face", "faces") + " without an area, or that occur twice, dropped");
  note(report.thin_share > 0.0005,
       fmt::format("{:.2g} % of the area belongs to parts or gaps thinner than the length", 100 * report.thin_share));
  text.push_back("the original lies " + deviation_text(report.from_original, unit) + " off the wrap, which lies " +
                 deviation_text(report.to_original, unit) + " off it");
  text.push_back(report.volume_before
                     ? fmt::format("volume {:.4g} before, {:.4g} {}^3 now", *report.volume_before, report.volume, unit)
                     : fmt::format("volume {:.4g} {}^3", report.volume, unit));
  return text;
}

}  // namespace greenloop::offline
