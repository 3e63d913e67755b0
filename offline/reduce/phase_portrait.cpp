#include "offline/reduce/phase_portrait.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using layout::none;
using layout::OrbitRecord;

constexpr double unreachable = std::numeric_limits<double>::infinity();

/// Fills the rows of a portrait one after the other.
class RowWriter {
 public:
  RowWriter(const ReducedFrames& reduced, double time_step, PhasePortrait& portrait)
      : reduced_(reduced), time_step_(time_step), portrait_(portrait) {}

  void begin_orbit() { first_ = row_; }
  void add_rest() { add(reduced_.rest, reduced_.rest_left_out); }
  void add_frame(std::uint64_t frame) {
    const Index column = reduced_.column(frame);
    add(reduced_.coordinates.col(column), reduced_.left_out[static_cast<std::size_t>(column)]);
  }
  void end_orbit() { portrait_.velocity.col(first_) = portrait_.velocity.col(first_ + 1); }

 private:
  void add(const Eigen::VectorXd& position, double left_out) {
    portrait_.position.col(row_) = position;
    if (row_ > first_) portrait_.velocity.col(row_) = (position - portrait_.position.col(row_ - 1)) / time_step_;
    portrait_.left_out.push_back(left_out);
    ++row_;
  }

  const ReducedFrames& reduced_;
  double time_step_;
  PhasePortrait& portrait_;
  Index row_ = 0, first_ = 0;
};

void add_record(std::uint64_t rows, std::uint32_t impulse, bool at_rest, std::uint64_t source,
                PhasePortrait& portrait) {
  OrbitRecord record{};
  record.first_row = portrait.orbits.empty() ? 0 : portrait.orbits.back().first_row + portrait.orbits.back().rows;
  record.rows = static_cast<std::uint32_t>(rows);
  record.impulse = impulse;
  record.next_orbit = record.next_row = none;
  portrait.orbits.push_back(record);
  portrait.at_rest.push_back(at_rest);
  portrait.source_orbit.push_back(source);
}

/// Where an orbit goes on.
struct Link {
  std::size_t orbit = 0;
  Index row = 0;
  double square = unreachable;
};

/// The nearest state of orbit `to` to the end of `from`, if it is nearer than what was found.
void find_nearer(const PhasePortrait& portrait, std::size_t from, std::size_t to, Link& link) {
  const OrbitRecord& source = portrait.orbits[from];
  const OrbitRecord& target = portrait.orbits[to];
  const Index end = Index{source.first_row} + source.rows - 1;
  const Index ahead = std::max<Index>(1, target.rows / 4);
  for (Index row = Index{target.first_row} + 1; row < Index{target.first_row} + target.rows - ahead; ++row) {
    const double square = portrait.squared_distance(end, row);
    if (square < link.square) link = {to, row, square};
  }
}

/// The links of one impulse's orbits, in order of distance from those that come to rest; what is left is farther than
/// the limit.
void link_to_rest(const PhasePortrait& portrait, const std::vector<std::size_t>& orbits, double limit,
                  std::vector<Link>& links, std::vector<bool>& linked) {
  std::vector<std::size_t> open, reached;
  for (const std::size_t orbit : orbits) (portrait.at_rest[orbit] ? reached : open).push_back(orbit);
  for (const std::size_t orbit : reached) linked[orbit] = true;
  while (!reached.empty()) {
    for (const std::size_t orbit : open) {
      for (const std::size_t to : reached) find_nearer(portrait, orbit, to, links[orbit]);
    }
    reached.clear();
    const auto nearest = std::min_element(
        open.begin(), open.end(), [&](std::size_t a, std::size_t b) { return links[a].square < links[b].square; });
    if (nearest == open.end() || links[*nearest].square > limit * limit) return;
    linked[*nearest] = true;
    reached.push_back(*nearest);
    open.erase(nearest);
  }
}

/// The same where none comes to rest: each to the nearest other one that is linked itself; alone, to its own beginning.
void link_in_circles(const PhasePortrait& portrait, std::vector<std::size_t> orbits, double limit,
                     std::vector<Link>& links, std::vector<bool>& linked) {
  for (bool pruned = true; pruned && !orbits.empty();) {
    for (const std::size_t orbit : orbits) {
      links[orbit] = {};
      for (const std::size_t to : orbits) {
        if (to != orbit || orbits.size() == 1) find_nearer(portrait, orbit, to, links[orbit]);
      }
    }
    const auto farthest = std::max_element(
        orbits.begin(), orbits.end(), [&](std::size_t a, std::size_t b) { return links[a].square < links[b].square; });
    pruned = links[*farthest].square > limit * limit;
    if (pruned) orbits.erase(farthest);
  }
  for (const std::size_t orbit : orbits) linked[orbit] = true;
}

/// Moves what stays to the front and forgets the rest.
void keep_orbits(const std::vector<bool>& kept, PhasePortrait& portrait) {
  PhasePortrait left;
  left.balance = portrait.balance;
  std::vector<std::uint32_t> place(kept.size(), none);
  Index rows = 0;
  for (std::size_t k = 0; k < kept.size(); ++k) rows += kept[k] ? Index{portrait.orbits[k].rows} : 0;
  left.position.resize(portrait.position.rows(), rows);
  left.velocity.resize(portrait.position.rows(), rows);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (!kept[k]) continue;
    const OrbitRecord old = portrait.orbits[k];
    place[k] = static_cast<std::uint32_t>(left.orbits.size());
    add_record(old.rows, old.impulse, portrait.at_rest[k], portrait.source_orbit[k], left);
    const Index first = Index{left.orbits.back().first_row};
    left.position.middleCols(first, old.rows) = portrait.position.middleCols(old.first_row, old.rows);
    left.velocity.middleCols(first, old.rows) = portrait.velocity.middleCols(old.first_row, old.rows);
    const auto begin = portrait.left_out.begin() + old.first_row;
    left.left_out.insert(left.left_out.end(), begin, begin + old.rows);
  }
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const OrbitRecord& old = portrait.orbits[k];
    if (!kept[k] || old.next_orbit == none) continue;
    OrbitRecord& record = left.orbits[place[k]];
    record.next_orbit = place[old.next_orbit];
    record.next_row =
        old.next_row - portrait.orbits[old.next_orbit].first_row + left.orbits[record.next_orbit].first_row;
    record.next_distance = old.next_distance;
  }
  portrait = std::move(left);
}

}  // namespace

PhasePortrait phase_portrait(const TrajectoryScene& scene, const ReducedFrames& reduced) {
  PhasePortrait portrait;
  add_record(2, none, true, 0, portrait);
  for (std::size_t k = 0; k < scene.orbits.size(); ++k) {
    const TrajectoryOrbit& orbit = scene.orbits[k];
    if (!orbit.held_out) add_record(orbit.frames + 1, orbit.impulse, orbit.at_rest, k, portrait);
  }
  const Index rows = Index{portrait.orbits.back().first_row} + portrait.orbits.back().rows;
  portrait.position.resize(reduced.modes.cols(), rows);
  portrait.velocity = Eigen::MatrixXd::Zero(reduced.modes.cols(), rows);
  RowWriter writer(reduced, scene.time_step, portrait);
  writer.add_rest();
  writer.add_rest();
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) {
    const TrajectoryOrbit& orbit = scene.orbits[portrait.source_orbit[k]];
    writer.begin_orbit();
    orbit.previous_frame < 0 ? writer.add_rest() : writer.add_frame(static_cast<std::uint64_t>(orbit.previous_frame));
    for (std::uint64_t frame = 0; frame < orbit.frames; ++frame) writer.add_frame(orbit.first_frame + frame);
    writer.end_orbit();
  }
  const double fastest = portrait.velocity.colwise().norm().maxCoeff();
  portrait.balance = fastest > 0 ? portrait.position.colwise().norm().maxCoeff() / fastest : scene.time_step;
  return portrait;
}

std::vector<DeadEnd> continue_orbits(const std::vector<Impulse>& impulses, double limit, PhasePortrait& portrait) {
  const std::size_t count = portrait.orbits.size();
  std::vector<Link> links(count);
  std::vector<bool> linked(count, false);
  linked[0] = true;
  for (std::uint32_t impulse = 0; impulse < impulses.size(); ++impulse) {
    std::vector<std::size_t> orbits;
    for (std::size_t k = 1; k < count; ++k) {
      if (portrait.orbits[k].impulse == impulse) orbits.push_back(k);
    }
    const bool rests = std::any_of(orbits.begin(), orbits.end(), [&](std::size_t k) { return portrait.at_rest[k]; });
    rests ? link_to_rest(portrait, orbits, limit, links, linked)
          : link_in_circles(portrait, orbits, limit, links, linked);
    if (std::none_of(orbits.begin(), orbits.end(), [&](std::size_t k) { return linked[k]; })) {
      throw std::runtime_error("reduction: impulse \"" + impulses[impulse].name +
                               "\" has no orbit that comes to rest or ends near another one; simulate longer ones, or "
                               "raise reduction.dead_end");
    }
  }
  std::vector<DeadEnd> dead_ends;
  for (std::size_t k = 1; k < count; ++k) {
    if (!linked[k]) {
      dead_ends.push_back({portrait.source_orbit[k], std::sqrt(links[k].square)});
    } else if (!portrait.at_rest[k]) {
      portrait.orbits[k].next_orbit = static_cast<std::uint32_t>(links[k].orbit);
      portrait.orbits[k].next_row = static_cast<std::uint32_t>(links[k].row);
      portrait.orbits[k].next_distance = static_cast<float>(std::sqrt(links[k].square));
    }
  }
  keep_orbits(linked, portrait);
  return dead_ends;
}

std::vector<layout::ReferenceRecord> nearest_references(const PhasePortrait& portrait,
                                                        const std::vector<std::uint8_t>& successions,
                                                        std::size_t impulses) {
  std::vector<layout::ReferenceRecord> references(static_cast<std::size_t>(portrait.rows()) * impulses, {none, 0});
  for (const OrbitRecord& orbit : portrait.orbits) {
    const std::size_t before = orbit.impulse == none ? impulses : orbit.impulse;
    for (std::uint32_t row = orbit.first_row; row < orbit.first_row + orbit.rows; ++row) {
      std::vector<double> squares(impulses, unreachable);
      for (std::uint32_t k = 1; k < portrait.orbits.size(); ++k) {
        const std::uint32_t impulse = portrait.orbits[k].impulse;
        if (successions[before * impulses + impulse] == 0) continue;
        const double square = portrait.squared_distance(row, Index{portrait.orbits[k].first_row} + 1);
        if (square >= squares[impulse]) continue;
        squares[impulse] = square;
        references[row * impulses + impulse] = {k, static_cast<float>(std::sqrt(square))};
      }
    }
  }
  return references;
}

}  // namespace greenloop::offline
