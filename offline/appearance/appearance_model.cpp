#include "offline/appearance/appearance_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

#include "offline/appearance/radial_basis.hpp"
#include "offline/appearance/shown_states.hpp"
#include "offline/appearance/state_clusters.hpp"
#include "offline/appearance/transfer_basis.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXf;

constexpr std::uint32_t first_states = 8;
constexpr double share_of_truncation = 0.5;  // of the goal
constexpr std::uint64_t seed = 1;

/// Transfers of rows, each computed once.
class Transfers {
 public:
  Transfers(const ImpulseResponseData& model, const std::vector<Eigen::Array3f>& reflectance, const TransferGoal& goal)
      : states_(model), goal_(goal) {
    surface_.reflectance = reflectance;
    for (std::size_t t = 0; t + 2 < model.triangles.size(); t += 3)
      surface_.triangles.push_back({model.triangles[t], model.triangles[t + 1], model.triangles[t + 2]});
  }

  [[nodiscard]] const ShownStates& states() const { return states_; }
  [[nodiscard]] bool has(Index row) const { return of_.contains(row); }
  const VectorXf& of(Index row) {
    const auto at = of_.find(row);
    return at != of_.end() ? at->second : of_.emplace(row, computed(row, goal_)).first->second;
  }
  VectorXf computed(Index row, const TransferGoal& goal) {
    surface_.positions = states_.positions(row);
    return radiance_transfer(surface_, goal).reshaped();
  }

 private:
  ShownStates states_;
  TransferGoal goal_;
  LitSurface surface_;
  std::map<Index, VectorXf> of_;
};

/// Rows that differ, in any order: the first so many of them are held out.
std::vector<Index> shuffled_rows(const MatrixXd& coordinates) {
  std::vector<Index> rows;
  for (Index row = 0; row < coordinates.cols(); ++row) {
    if (row == 0 || coordinates.col(row) != coordinates.col(row - 1)) rows.push_back(row);
  }
  std::mt19937_64 random(seed);
  for (std::size_t i = rows.size(); i > 1; --i) std::swap(rows[i - 1], rows[random() % i]);
  return rows;
}

MatrixXd columns_of(const MatrixXd& all, const std::vector<Index>& chosen) {
  MatrixXd columns(all.rows(), static_cast<Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) columns.col(static_cast<Index>(k)) = all.col(chosen[k]);
  return columns;
}

SampledError measured(Transfers& transfers, const std::vector<Index>& held_out, const TransferBasis& basis,
                      const RadialBasis& between) {
  double error = 0, variation = 0, whole = 0;
  for (const Index row : held_out) {
    const VectorXf& truth = transfers.of(row);
    const Eigen::VectorXd coordinates = between.at(transfers.states().coordinates().col(row));
    const VectorXf difference = truth - basis.mean;
    error += (difference - basis.modes * coordinates.cast<float>()).squaredNorm();
    variation += difference.squaredNorm();
    whole += truth.squaredNorm();
  }
  SampledError sampled;
  sampled.rank = static_cast<std::uint32_t>(basis.modes.cols());
  sampled.truncation = basis.truncation(basis.modes.cols());
  sampled.error = variation > 0 ? std::sqrt(error / variation) : 0;
  sampled.of_transfer = whole > 0 ? std::sqrt(error / whole) : 0;
  return sampled;
}

double noise_of(Transfers& transfers, Index row, TransferGoal goal) {
  goal.rays *= 4;
  ++goal.seed;
  const VectorXf finer = transfers.computed(row, goal);
  return static_cast<double>((transfers.of(row) - finer).norm() / finer.norm());
}

}  // namespace

Appearance appearance_of(const ImpulseResponseData& model, const std::vector<Eigen::Array3f>& reflectance,
                         const AppearanceGoal& goal,
                         const std::function<void(std::uint32_t, std::uint32_t)>& progress) {
  Transfers transfers(model, reflectance, goal.transfer);
  const MatrixXd& coordinates = transfers.states().coordinates();
  std::vector<Index> rows = shuffled_rows(coordinates);
  if (rows.size() < 3) throw std::runtime_error("appearance: the model has fewer than three states that differ");
  const auto held = std::min<std::size_t>(goal.held_out, rows.size() / 3);
  const std::vector<Index> held_out(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(held));
  rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(held));
  const MatrixXd candidates = columns_of(coordinates, rows);
  const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(goal.states, rows.size()));
  Appearance appearance;
  for (std::uint32_t states = std::min(first_states, most);; states = std::min(2 * states, most)) {
    std::vector<Index> chosen;
    for (const Index k : representatives(candidates, states, seed)) chosen.push_back(rows[static_cast<std::size_t>(k)]);
    std::vector<const VectorXf*> of_chosen;
    for (const Index row : chosen) {
      progress(static_cast<std::uint32_t>(of_chosen.size()), static_cast<std::uint32_t>(chosen.size()));
      of_chosen.push_back(&transfers.of(row));
    }
    const TransferBasis basis = transfer_basis(of_chosen, goal.rank, share_of_truncation * goal.error);
    const RadialBasis between(columns_of(coordinates, chosen), basis.coordinates);
    SampledError error = measured(transfers, held_out, basis, between);
    error.states = static_cast<std::uint32_t>(chosen.size());
    appearance.sampling.push_back(error);
    if (error.error > goal.error && states < most) continue;

    MatrixXd of_rows(basis.modes.cols(), coordinates.cols());
    for (Index row = 0; row < coordinates.cols(); ++row) of_rows.col(row) = between.at(coordinates.col(row));
    appearance.data = quantised(basis, of_rows);
    appearance.data.states = error.states;
    appearance.data.error = static_cast<float>(error.error);
    appearance.singular_values = basis.singular_values;
    if (!held_out.empty()) appearance.noise = noise_of(transfers, held_out.front(), goal.transfer);
    return appearance;
  }
}

}  // namespace greenloop::offline
