#include "runtime/compliance/capacitance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <vector>

#include "formats/testing/dense_wavelet.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t most = 24;

// `count` places of K(c): neighbours in the file, or anywhere
std::vector<std::uint32_t> choose_places(const ModelView& view, std::uint32_t c, std::uint32_t count, bool scattered,
                                         std::mt19937_64& random) {
  std::vector<std::uint32_t> places(domain_up_to(view, c));
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    places[i] = i;
  }
  if (scattered) {
    std::shuffle(places.begin(), places.end(), random);
  }
  const std::size_t first = scattered ? 0 : random() % places.size();
  std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(first), places.end());
  places.resize(std::min<std::size_t>(places.size(), count));
  return places;
}

// a set of places of one level, touched
template <unsigned N>
struct TouchedSet {
  TouchedSet(Rooms<N>& of, std::uint32_t c, const std::vector<std::uint32_t>& places) : rooms(of) {
    for (const std::uint32_t place : places) {
      column.push_back(make_column(c, place));
    }
    set = {static_cast<std::uint32_t>(column.size()), column.data()};
    rooms.touch_set(set);
  }

  [[nodiscard]] CapacitanceCounts counts(std::uint32_t rows) const {
    SetCounts counts;
    counts.columns = set.count;
    count_factor({rows, set.column + (set.count - rows)}, rooms.touched, rooms.cost, rooms.stored.data(), counts);
    CapacitanceCounts result = capacitance_counts(rooms.counts, counts);
    result.rows = rows;
    return result;
  }

  Rooms<N>& rooms;
  std::vector<std::uint32_t> column;
  ColumnSet set{};
};

// worst difference over the largest entry of row node `j`, up to the diagonal; entry(r, k): of its row r and column k
template <unsigned N, class Entry>
double row_error(const Eigen::MatrixXd& exact, const std::vector<std::uint32_t>& places, std::uint32_t j, Entry entry) {
  double worst = 0;
  for (std::uint32_t k = 0; k < N * (j + 1); ++k) {
    for (std::uint32_t r = 0; r < N; ++r) {
      const double wanted = exact(Eigen::Index{N} * places[j] + r, Eigen::Index{N} * places[k / N] + k % N);
      worst = std::max(worst, std::abs(double{entry(r, k)} - wanted));
    }
  }
  return worst / exact.cwiseAbs().maxCoeff();
}

constexpr double rounding = 2e-6;

template <unsigned N>
void check_whole(const TouchedSet<N>& touched, const Eigen::MatrixXd& exact, const std::vector<std::uint32_t>& places) {
  Rooms<N>& rooms = touched.rooms;
  const std::uint32_t stride = rooms.cache.stride();
  std::vector<Float4> matrix(std::size_t{stride} * stride / 4);
  assemble_capacitance<N>(rooms.refinement, touched.set, rooms.touched, rooms.capacitance, rooms.force, stride,
                          matrix.data());
  const auto* entry = reinterpret_cast<const float*>(matrix.data());
  for (std::uint32_t j = 0; j < touched.set.count; ++j) {
    CHECK(row_error<N>(exact, places, j, [&](std::uint32_t r, std::uint32_t k) {
            return entry[std::size_t{k} * stride + N * j + r];
          }) <= rounding);
  }
}

// in pieces of at least `allowance`
template <unsigned N>
void check_rows(const TouchedSet<N>& touched, const Eigen::MatrixXd& exact, const std::vector<std::uint32_t>& places,
                std::uint32_t rows, std::uint64_t allowance) {
  Rooms<N>& rooms = touched.rooms;
  const CapacitanceCounts counts = touched.counts(rows);
  PartialCapacitance partial;
  partial.set = touched.set;
  partial.computed = rows;
  partial.panel = has_panel(counts.room, counts.slots, rows);
  begin_capacitance<N>(rooms.refinement, rooms.touched, rooms.capacitance, rooms.force, partial);
  CHECK(partial.slots == counts.slots);
  CHECK(partial.own_visits <= counts.visits);
  std::uint64_t work = 0;
  while (partial.has_blocks_left()) {
    const std::uint64_t spent =
        add_capacitance_blocks(rooms.refinement, rooms.touched, rooms.capacitance, allowance, partial);
    REQUIRE(spent <= allowance);
    work += spent;
    allowance = spent > 0 ? allowance : 2 * allowance;
  }
  CHECK(work <= add_capacitance_blocks_work(counts));
  const std::uint32_t stride = rooms.cache.stride();
  std::vector<Float4> row(std::size_t{N} * stride / 4);
  const auto* entry = reinterpret_cast<const float*>(row.data());
  for (std::uint32_t t = 0; t < rows; ++t) {
    store_capacitance_row(rooms.capacitance, partial, t, stride, row.data());
    CHECK(row_error<N>(exact, places, touched.set.count - rows + t, [&](std::uint32_t r, std::uint32_t k) {
            return entry[std::size_t{r} * stride + k];
          }) <= rounding);
  }
  release_capacitance(partial, rooms.capacitance);
  CHECK(std::all_of(rooms.capacitance.slot, rooms.capacitance.slot + rooms.view.domain_count,
                    [](std::uint32_t slot) { return slot == layout::none; }));
}

TEST_CASE_TEMPLATE("the capacitance matrix is T^-1 S T^-T of the stored couplings, whole and by its last rows",
                   Components, One, Three) {
  constexpr unsigned N = Components::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    const ModelData data = synthetic_model({.components = N, .levels = 5, .wavelet = kind, .touchable_above = 0.5});
    const TestModel model(encode(data));
    Rooms<N> rooms(model.view(), most);
    std::mt19937_64 random(7);
    int with_panel = 0;
    int with_functionals = 0;
    for (std::uint32_t c = 0; c < rooms.view.levels; ++c) {
      const Eigen::MatrixXd exact = decoded_compliance(data, c);
      for (const std::uint32_t count : {1U, 2U, 7U, most}) {
        for (const bool scattered : {false, true}) {
          const auto places = choose_places(rooms.view, c, count, scattered, random);
          const TouchedSet<N> touched(rooms, c, places);
          check_whole(touched, exact, places);
          for (const std::uint32_t rows : {1U, 3U, 16U}) {
            const std::uint32_t last = std::min(rows, touched.set.count);
            const bool panel = has_panel(rooms.capacitance.room, count_slots(touched.set, rooms.touched), last);
            ++(panel ? with_panel : with_functionals);
            check_rows(touched, exact, places, last, rows == 3 ? 1 : any_budget);
          }
        }
      }
    }
    CHECK(with_panel > 20);
    CHECK(with_functionals > 2);
  }
}

TEST_CASE("what bounds the work of any set bounds that of each, with a panel and without") {
  Prediction prediction;
  SUBCASE("numbers") {}
  SUBCASE("numbers, lifted") { prediction.lifted = true; }
  SUBCASE("numbers, scalar") { prediction = prediction_of(TestModel({.components = 1, .levels = 2}).view()); }
  SUBCASE("blocks") {
    prediction = prediction_of(TestModel({.levels = 2, .wavelet = layout::Wavelet::equilibrated}).view());
  }
  SUBCASE("blocks, scalar") {
    prediction =
        prediction_of(TestModel({.components = 1, .levels = 2, .wavelet = layout::Wavelet::equilibrated}).view());
  }
  const Prices prices;
  CapacitanceCounts bounds{.prices = &prices,
                           .prediction = prediction,
                           .columns = 40,
                           .rows = 40,
                           .slots = 900,
                           .set_visits = 2000,
                           .stored = 50000,
                           .visits = 2400,
                           .coefficients = 1200,
                           .meetings = 200000,
                           .room = 900 * 8,
                           .bounds = true};
  for (std::uint64_t slots = 1; slots <= bounds.slots; slots += 7) {
    for (std::uint64_t rows = (slots + 29) / 30; rows <= std::min<std::uint64_t>(bounds.rows, slots); rows += 3) {
      CapacitanceCounts counts = bounds;
      counts.slots = slots;
      counts.columns = counts.rows = rows;
      counts.visits = 60 * rows;
      counts.coefficients = 30 * rows;
      counts.set_visits = std::min(50 * rows, prediction.lifted ? 50 * rows : rows + prediction.length * slots);
      counts.bounds = false;
      CHECK(begin_capacitance_work(counts) <= begin_capacitance_work(bounds));
      CHECK(add_capacitance_blocks_work(counts) <= add_capacitance_blocks_work(bounds));
      CHECK(assemble_capacitance_work(counts) <= assemble_capacitance_work(bounds));
    }
  }
}

}  // namespace
}  // namespace greenloop
