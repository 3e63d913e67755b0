#include "formats/testing/synthetic_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace greenloop {
namespace {

using Point = std::array<double, 3>;
using Block = std::array<double, 9>;  // displacement r per force c at 3 c + r
using Triangle = std::array<std::uint32_t, 3>;

constexpr double radius = 0.1;        // m
constexpr double range = 0.05;        // m, of the kernel
constexpr double softness = 1e-3;     // m/N
constexpr double fixed_below = -0.5;  // in radii, as is the next
constexpr double unneeded_below = -0.2;
constexpr Block coupling = {1, 0.2, 0.1, 0.2, 0.9, 0.15, 0.1, 0.15, 0.8};

double distance(const Point& x, const Point& y) { return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]); }

double norm(const Block& block) {
  double sum = 0;
  for (const double value : block) sum += value * value;
  return std::sqrt(sum);
}

void add(Block& to, double weight, const Block& from) {
  for (std::size_t k = 0; k < 9; ++k) to[k] += weight * from[k];
}

// Nodes coarse to fine and, within a level, the domain first.
struct Sphere {
  std::vector<Point> positions;
  std::vector<std::array<std::uint32_t, 2>> parents;
  std::vector<std::uint32_t> begin = {0};  // of each level, then the number of nodes
  std::vector<Triangle> base, finest;
  std::vector<std::uint32_t> flags;
  std::vector<double> areas;

  [[nodiscard]] std::uint32_t levels() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  [[nodiscard]] std::uint32_t count() const { return begin.back(); }
  [[nodiscard]] bool has(std::uint32_t node, layout::NodeFlag flag) const { return (flags[node] & flag) != 0; }
};

std::uint32_t flags_at(double height, bool finest_of_several, double touchable_above) {
  if (height < fixed_below) return layout::node_fixed;
  if (finest_of_several && height < unneeded_below) return 0;
  const bool touchable = height >= touchable_above;
  return layout::node_domain | layout::node_read | (touchable ? static_cast<std::uint32_t>(layout::node_touchable) : 0);
}

// Adds a level's nodes, domain first; returns the new index of each.
std::vector<std::uint32_t> add_level(Sphere& sphere, const std::vector<Point>& points, bool finest_of_several,
                                     double touchable_above) {
  std::vector<std::uint32_t> index(points.size());
  for (const bool domain : {true, false}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint32_t flags = flags_at(points[i][2] / radius, finest_of_several, touchable_above);
      if (((flags & layout::node_domain) != 0) != domain) continue;
      index[i] = static_cast<std::uint32_t>(sphere.positions.size());
      sphere.positions.push_back(points[i]);
      sphere.flags.push_back(flags);
    }
  }
  sphere.begin.push_back(static_cast<std::uint32_t>(sphere.positions.size()));
  return index;
}

void split(Sphere& sphere, bool finest, double touchable_above) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> odd;
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 2>> ends;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = odd.try_emplace({std::min(a, b), std::max(a, b)}, points.size());
    if (is_new) {
      Point x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = sphere.positions[a][k] + sphere.positions[b][k];
      const double scale = radius / distance(x, {});
      for (double& value : x) value *= scale;
      points.push_back(x);
      ends.push_back({found->first.first, found->first.second});
    }
    return found->second;
  };
  std::vector<std::array<std::size_t, 3>> middles;
  for (const Triangle& t : sphere.finest) {
    middles.push_back({middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])});
  }
  const auto index = add_level(sphere, points, finest, touchable_above);
  sphere.parents.resize(sphere.positions.size());
  for (std::size_t i = 0; i < ends.size(); ++i) sphere.parents[index[i]] = ends[i];
  std::vector<Triangle> children;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto [a, b, c] = sphere.finest[i];
    const std::uint32_t ab = index[middles[i][0]], bc = index[middles[i][1]], ca = index[middles[i][2]];
    for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) children.push_back(t);
  }
  sphere.finest = std::move(children);
}

void measure_areas(Sphere& sphere) {
  sphere.areas.assign(sphere.count(), 0);
  for (const Triangle& t : sphere.finest) {
    const double a = distance(sphere.positions[t[0]], sphere.positions[t[1]]);
    const double b = distance(sphere.positions[t[1]], sphere.positions[t[2]]);
    const double c = distance(sphere.positions[t[2]], sphere.positions[t[0]]);
    const double half = (a + b + c) / 2;  // Heron's formula
    const double area = std::sqrt(half * (half - a) * (half - b) * (half - c));
    for (const std::uint32_t node : t) sphere.areas[node] += area / 3;
  }
}

Sphere make_sphere(const SyntheticOptions& options) {
  Sphere sphere;
  const double r = radius;
  const std::vector<Point> corners = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  const auto index = add_level(sphere, corners, false, options.touchable_above);
  for (const auto& t :
       {Triangle{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}) {
    sphere.base.push_back({index[t[0]], index[t[1]], index[t[2]]});
  }
  sphere.finest = sphere.base;
  for (std::uint32_t q = 1; q < options.levels; ++q) split(sphere, q + 1 == options.levels, options.touchable_above);
  measure_areas(sphere);
  return sphere;
}

// The hat of a node of level c, by its values at all nodes.
std::vector<double> hat(const Sphere& sphere, std::uint32_t c, std::uint32_t node) {
  std::vector<double> values(sphere.count(), 0);
  values[node] = 1;
  for (std::uint32_t i = sphere.begin[c + 1]; i < sphere.count(); ++i) {
    values[i] = (values[sphere.parents[i][0]] + values[sphere.parents[i][1]]) / 2;
  }
  return values;
}

// The lifting weight of every node towards its parents.
std::vector<std::array<double, 2>> lifting_weights(const Sphere& sphere) {
  std::vector<double> integral = sphere.areas;
  std::vector<std::array<double, 2>> lift(sphere.count());
  for (std::uint32_t q = sphere.levels() - 1; q > 0; --q) {
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (const std::uint32_t parent : sphere.parents[m]) integral[parent] += integral[m] / 2;
    }
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::uint32_t parent = sphere.parents[m][k];
        const bool lifted = sphere.has(m, layout::node_domain) && sphere.has(parent, layout::node_domain);
        lift[m][k] = lifted ? integral[m] / (2 * integral[parent]) : 0;
      }
    }
  }
  return lift;
}

// The lifted Linear transform in place (docs/theory.md, section 3); blocks outside the domain are and stay zero.
void transform(const Sphere& sphere, const std::vector<std::array<double, 2>>& lift, std::vector<Block>& x) {
  for (std::uint32_t q = sphere.levels() - 1; q > 0; --q) {
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      if (!sphere.has(m, layout::node_domain)) continue;
      for (const std::uint32_t parent : sphere.parents[m]) add(x[m], -0.5, x[parent]);
    }
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (std::size_t k = 0; k < 2; ++k) add(x[sphere.parents[m][k]], lift[m][k], x[m]);
    }
  }
}

void invert(const Sphere& sphere, const std::vector<std::array<double, 2>>& lift, std::vector<Block>& x) {
  for (std::uint32_t q = 1; q < sphere.levels(); ++q) {
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (std::size_t k = 0; k < 2; ++k) add(x[sphere.parents[m][k]], -lift[m][k], x[m]);
    }
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      if (!sphere.has(m, layout::node_domain)) continue;
      for (const std::uint32_t parent : sphere.parents[m]) add(x[m], 0.5, x[parent]);
    }
  }
}

// Displacement of the domain per unit force spread over `weights` (which sum to one).
std::vector<Block> exact_column(const Sphere& sphere, const std::vector<double>& weights) {
  std::vector<Block> column(sphere.count(), Block{});
  for (std::uint32_t i = 0; i < sphere.count(); ++i) {
    if (!sphere.has(i, layout::node_domain)) continue;
    double kernel = 0;
    for (std::uint32_t j = 0; j < sphere.count(); ++j) {
      if (weights[j] == 0) continue;
      kernel += weights[j] * std::exp(-distance(sphere.positions[i], sphere.positions[j]) / range);
    }
    add(column[i], softness * kernel, coupling);
  }
  return column;
}

double largest_norm(const std::vector<Block>& column) {
  double largest = 0;
  for (const Block& block : column) largest = std::max(largest, norm(block));
  return largest;
}

// Appends the blocks of one column and one row level; leaves in `column` what a reader will see.
void quantise(BlocksData& data, std::span<Block> column, double threshold) {
  const double most = data.value_bytes == 1 ? 127 : 32767;
  double largest = 0;
  for (const Block& block : column) {
    for (const double value : block) largest = std::max(largest, std::abs(value));
  }
  const auto scale = static_cast<float>(largest / most);
  for (std::uint32_t i = 0; i < column.size(); ++i) {
    if (!data.dense && norm(column[i]) < threshold) {
      column[i] = {};
      continue;
    }
    if (!data.dense) data.index.push_back(i);
    for (double& value : column[i]) {
      const double quanta = scale > 0 ? std::clamp(std::round(value / scale), -most, most) : 0;
      data.value.push_back(static_cast<std::int16_t>(quanta));
      value = quanta * scale;
    }
  }
  data.begin.push_back(static_cast<std::uint32_t>(data.value.size() / 9));
  data.scale.push_back(scale);
}

struct Errors {
  double error_square = 0, square = 0, worst = 0;

  void measure(const std::vector<Block>& exact, const std::vector<Block>& decoded, double area) {
    double largest_error = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      Block error = decoded[i];
      add(error, -1, exact[i]);
      error_square += std::pow(area * norm(error), 2);
      square += std::pow(area * norm(exact[i]), 2);
      largest_error = std::max(largest_error, norm(error));
    }
    worst = std::max(worst, largest_error / largest_norm(exact));
  }
};

std::vector<std::vector<std::uint32_t>> representatives(const Sphere& sphere,
                                                        const std::vector<layout::ColumnRecord>& columns) {
  std::vector<std::vector<std::uint32_t>> result(sphere.levels());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
      const auto nearer = [&](const layout::ColumnRecord& a, const layout::ColumnRecord& b) {
        return distance(sphere.positions[a.node], sphere.positions[i]) <
               distance(sphere.positions[b.node], sphere.positions[i]);
      };
      const auto nearest = std::min_element(columns.begin(), columns.end(), nearer);
      const bool touchable = sphere.has(i, layout::node_touchable);
      result[q].push_back(touchable ? static_cast<std::uint32_t>(nearest - columns.begin()) : layout::none);
    }
  }
  return result;
}

// The columns of constraint level c: every touchable node of K(c).
void add_columns(LevelData& level, const Sphere& sphere, std::uint32_t c, const SyntheticOptions& options) {
  const auto lift = lifting_weights(sphere);
  BlocksData empty;
  empty.value_bytes = options.value_bytes;
  empty.dense = options.dense;
  empty.begin = {0};
  level.blocks.assign(sphere.levels(), empty);
  Errors errors;
  for (std::uint32_t node = 0; node < sphere.begin[c + 1]; ++node) {
    if (!sphere.has(node, layout::node_touchable)) continue;
    std::vector<double> weights = hat(sphere, c, node);
    double area = 0;
    for (std::uint32_t j = 0; j < sphere.count(); ++j) {
      weights[j] *= sphere.has(j, layout::node_fixed) ? 0 : sphere.areas[j];
      area += weights[j];
    }
    for (double& weight : weights) weight /= area;
    level.columns.push_back({node, static_cast<float>(area)});

    const std::vector<Block> exact = exact_column(sphere, weights);
    std::vector<Block> column = exact;
    transform(sphere, lift, column);
    for (std::uint32_t r = 0; r < sphere.levels(); ++r) {
      std::uint32_t rows = 0;
      while (rows < sphere.begin[r + 1] - sphere.begin[r] && sphere.has(sphere.begin[r] + rows, layout::node_domain)) {
        ++rows;
      }
      const double epsilon =
          r == 0 ? 0 : std::ldexp(options.epsilon, static_cast<int>(r + 1) - static_cast<int>(sphere.levels()));
      quantise(level.blocks[r], std::span(column).subspan(sphere.begin[r], rows), epsilon * largest_norm(exact));
    }
    invert(sphere, lift, column);
    errors.measure(exact, column, area);
  }
  level.representatives = representatives(sphere, level.columns);
  level.counts.rms_error = static_cast<float>(std::sqrt(errors.error_square / errors.square));
  level.counts.worst_column_error = static_cast<float>(errors.worst);
}

LevelData make_level(const Sphere& sphere, std::uint32_t q) {
  LevelData level;
  const auto lift = lifting_weights(sphere);
  for (std::uint32_t i = sphere.begin[q]; i < sphere.begin[q + 1]; ++i) {
    const Point& x = sphere.positions[i];
    level.nodes.push_back({{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
                           static_cast<float>(sphere.areas[i]),
                           sphere.flags[i]});
    if (q == 0) continue;
    level.refinement.push_back({{sphere.parents[i][0], sphere.parents[i][1]},
                                {static_cast<float>(lift[i][0]), static_cast<float>(lift[i][1])}});
  }
  return level;
}

}  // namespace

ModelData synthetic_model(const SyntheticOptions& options) {
  const Sphere sphere = make_sphere(options);
  ModelData model;
  model.info.problem = static_cast<std::uint32_t>(layout::Problem::elastostatic);
  model.info.wavelet = static_cast<std::uint32_t>(layout::Wavelet::lifted_linear);
  model.info.components = 3;
  model.info.young = 1e5;
  model.info.poisson = 0.4;
  model.info.epsilon = options.epsilon;
  model.info.rate = 1000;
  model.info.max_contacts = 16;
  model.info.step_work = 1'000'000;
  model.info.coarsest_constraint_level = options.coarsest_constraint_level;
  model.provenance = R"({"generator": "synthetic sphere"})";
  for (const Triangle& t : sphere.base) model.base_triangles.insert(model.base_triangles.end(), t.begin(), t.end());
  for (std::uint32_t q = 0; q < sphere.levels(); ++q) {
    model.levels.push_back(make_level(sphere, q));
    if (q >= options.coarsest_constraint_level) add_columns(model.levels.back(), sphere, q, options);
  }
  return model;
}

}  // namespace greenloop
