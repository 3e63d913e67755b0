#include "runtime/testing/dense_reference.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <map>
#include <utility>

#include "formats/stored_blocks.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// weights between the components of two nodes, by place
class Weights {
 public:
  explicit Weights(Index components) : n_(components) {}

  // weight(k): of element k of an N x N block by columns
  template <class Weight>
  void add(Index row, Index column, Weight weight) {
    for (Index k = 0; k < n_ * n_; ++k) {
      entries_.emplace_back(n_ * row + k % n_, n_ * column + k / n_, weight(static_cast<std::uint32_t>(k)));
    }
  }
  void add_number(Index row, Index column, double weight) {
    for (Index r = 0; r < n_; ++r) entries_.emplace_back(n_ * row + r, n_ * column + r, weight);
  }
  [[nodiscard]] Eigen::SparseMatrix<double> matrix(Index nodes) const {
    Eigen::SparseMatrix<double> result(n_ * nodes, n_ * nodes);
    result.setFromTriplets(entries_.begin(), entries_.end());
    return result;
  }

 private:
  Index n_;
  std::vector<Eigen::Triplet<double>> entries_;
};

// by blocks of node i of a level
void add_blocks(const ModelView& view, const LevelView& level, std::uint32_t i, Weights& predict) {
  for (std::uint32_t k = 0; k < level.predictions.terms; ++k) {
    const std::size_t term = std::size_t{level.predictions.terms} * i + k;
    predict.add(level.domain_begin + i, stored_source(level.predictions, term), [&](std::uint32_t e) {
      return (view.info->components == 1 ? stored_weight<1>(level.predictions, term, e)
                                         : stored_weight<3>(level.predictions, term, e)) /
             4096.0;
    });
  }
}

}  // namespace

Eigen::SparseMatrix<double> inverse_step(const ModelView& view, std::uint32_t q) {
  const LevelView& level = view.level[q];
  const Index nodes = domain_up_to(view, q);
  Weights lift(view.info->components);
  Weights predict(view.info->components);
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    const Index odd = level.domain_begin + i;
    if (level.predictions.weight != nullptr) {
      add_blocks(view, level, i, predict);
      continue;
    }
    const auto add_prediction = [&](std::uint32_t node, double weight) {
      if (node != layout::none && in_domain(view, node)) predict.add_number(odd, domain_place(view, node), weight);
    };
    for (std::uint32_t k = 0; level.stencils != nullptr && k < 4; ++k) {
      add_prediction(level.stencils[i].outer[k], -1.0 / 16);
      add_prediction(k < 2 ? level.stencils[i].wing[k] : layout::none, 1.0 / 8);
    }
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t parent = level.refinement[i].parent[side];
      add_prediction(parent, 0.5);
      if (in_domain(view, parent)) {
        lift.add_number(domain_place(view, parent), odd, -double{level.refinement[i].lift[side]});
      }
    }
  }
  for (Index i = 0; i < nodes; ++i) {
    lift.add_number(i, i, 1);
    predict.add_number(i, i, 1);
  }
  return predict.matrix(nodes) * lift.matrix(nodes);
}

DenseReference::DenseReference(const ModelData& model) : wavelet_(model) {
  for (std::uint32_t c = 0; c < wavelet_.levels(); ++c) {
    compliance_.push_back(decoded_compliance(model, c));
    field_.push_back(field_displacements(model, c));
  }
  for (std::uint32_t c = 0; c < wavelet_.levels(); ++c) {
    finest_compliance_.push_back(averages(c, compliance_.back()));
  }
}

MatrixXd DenseReference::averages(std::uint32_t q, MatrixXd x) const {
  for (std::uint32_t l = wavelet_.levels() - 1; l > q; --l) {
    wavelet_.forward(l, x);
    x.conservativeResize(wavelet_.rows(l - 1), Eigen::NoChange);
  }
  return x;
}

MatrixXd DenseReference::load_field(const ModelView& view, std::uint32_t q) const {
  MatrixXd x = MatrixXd::Zero(Index{3} * view.domain_count, static_cast<Index>(view.loads.size()));
  for (std::uint32_t l = 0; l <= q; ++l) {
    const LevelView& level = view.level[l];
    for (std::uint32_t load = 0; load < view.loads.size(); ++load) {
      for (Index i = 0; i < Index{3} * level.counts->domain_count; ++i) {
        x(Index{3} * level.domain_begin + i, load) = double{level.load_column(load)[i]};
      }
    }
  }
  for (std::uint32_t l = 1; l < view.levels; ++l)
    x.topRows(wavelet_.rows(l)) = inverse_step(view, l) * x.topRows(wavelet_.rows(l));
  return x;
}

namespace {

Eigen::VectorXd load_amounts(const ModelView& view, const Elastostatic::Loads& loads) {
  Eigen::VectorXd amounts = Eigen::VectorXd::Zero(static_cast<Index>(view.loads.size()));
  const Index accelerations = view.has_gravity() ? layout::accelerations : 0;
  if (accelerations > 0) amounts.head<3>() << loads.gravity.x, loads.gravity.y, loads.gravity.z;
  for (std::size_t k = 0; k < loads.pressure.size(); ++k) {
    amounts(accelerations + static_cast<Index>(k)) = double{loads.pressure[k]};
  }
  return amounts;
}

// who stands for a contact
std::uint32_t dense_column(const ModelView& view, std::uint32_t node, std::uint32_t c) {
  const std::uint32_t q = level_of(view, node);
  return make_column(c, domain_place(view, view.representatives[c][q][node - view.level[q].node_begin]));
}

// between two columns, of one level or of the finest and another
Eigen::Matrix3d dense_block(const DenseReference& reference, std::uint32_t i, std::uint32_t j) {
  const Index row = Index{3} * column_place(i);
  const Index column = Index{3} * column_place(j);
  if (column_level(i) == column_level(j)) {
    return reference.compliance(column_level(i)).block<3, 3>(row, column);
  }
  if (column_level(i) < column_level(j)) {
    return reference.finest_compliance(column_level(i)).block<3, 3>(row, column);
  }
  return dense_block(reference, j, i).transpose();
}

}  // namespace

DenseAnswer solve_dense(const ModelView& view, const DenseReference& reference, std::uint32_t level,
                        std::span<const Constraint> constraints, const Elastostatic::Loads& loads) {
  std::map<std::uint32_t, std::vector<std::size_t>> members;
  Eigen::VectorXd known = Eigen::VectorXd::Zero(reference.compliance(level).rows());
  DenseAnswer answer{Eigen::VectorXd(3 * constraints.size()), Eigen::VectorXd::Zero(Index{3} * view.node_count), 1};
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Constraint& constraint = constraints[i];
    const Eigen::Vector3d value(constraint.value[0], constraint.value[1], constraint.value[2]);
    const auto add_force = [&](std::uint32_t node, double part) {
      known.segment<3>(Index{3} * column_place(dense_column(view, node, level))) += part * value;
    };
    if (constraint.kind == Constraint::Kind::hold) {
      members[dense_column(view, constraint.node, level)].push_back(i);
      continue;
    }
    answer.force.segment<3>(3 * static_cast<Index>(i)) = value;
    if (constraint.kind == Constraint::Kind::force) {
      add_force(constraint.node, 1);
      continue;
    }
    const Mask& mask = loads.masks[constraint.node];
    for (std::size_t k = 0; k < mask.node.size(); ++k) add_force(mask.node[k], double{mask.weight[k]});
  }
  const double softness = 1 / double{loads.stiffness};
  const auto n = static_cast<Index>(members.size());
  const Eigen::VectorXd by_loads = softness * (reference.load_field(view, view.levels - 1) * load_amounts(view, loads));
  const Eigen::VectorXd by_known =
      softness * (reference.compliance(level) * known) + reference.averages(level, by_loads);
  MatrixXd capacitance(3 * n, 3 * n);
  Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(3 * n);
  Index j = 0;
  for (const auto& [column, of_column] : members) {
    for (const std::size_t i : of_column) {
      for (Index r = 0; r < 3; ++r) {
        prescribed(3 * j + r) += double{constraints[i].value[r]} / static_cast<double>(of_column.size());
      }
    }
    prescribed.segment<3>(3 * j) -= by_known.segment<3>(Index{3} * column_place(column));
    Index i = 0;
    for (const auto& [row, of_row] : members) {
      capacitance.block<3, 3>(3 * i++, 3 * j) = softness * dense_block(reference, row, column);
    }
    ++j;
  }
  const Eigen::VectorXd force = n > 0 ? capacitance.fullPivLu().solve(prescribed) : prescribed;
  if (n > 0) {
    const Eigen::JacobiSVD<MatrixXd> svd(capacitance);
    answer.condition = svd.singularValues().maxCoeff() / svd.singularValues().minCoeff();
  }
  j = 0;
  for (const auto& [column, of_column] : members) {
    known.segment<3>(Index{3} * column_place(column)) += force.segment<3>(3 * j);
    for (const std::size_t k : of_column) {
      answer.force.segment<3>(3 * static_cast<Index>(k)) =
          force.segment<3>(3 * j) / static_cast<double>(of_column.size());
    }
    ++j;
  }
  const Eigen::VectorXd displacement = softness * (reference.field(level) * known) + by_loads;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const Index count = Index{3} * view.level[q].counts->domain_count;
    answer.displacement.segment(Index{3} * view.level[q].node_begin, count) =
        displacement.segment(Index{3} * view.level[q].domain_begin, count);
  }
  for (const Constraint& constraint : constraints) {
    for (Index r = 0; r < 3 && level + 1 == view.levels && constraint.kind == Constraint::Kind::hold; ++r) {
      answer.displacement(Index{3} * constraint.node + r) = constraint.value[r];
    }
  }
  return answer;
}

}  // namespace greenloop
