#include "runtime/testing/dense_reference.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <map>

#include "runtime/domain.hpp"

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

std::uint32_t row_of(const CouplingsView& view, std::uint32_t column, std::uint32_t b) {
  if (view.index_bytes == 0) {
    return b - view.begin[column];
  }
  return view.index_bytes == 2 ? static_cast<const std::uint16_t*>(view.index)[b]
                               : static_cast<const std::uint32_t*>(view.index)[b];
}

int value_of(const CouplingsView& view, std::size_t block, std::size_t k) {
  const auto byte = [&view](std::size_t i) { return std::to_integer<int>(view.value[i]); };
  if (view.value_bits == 4) {
    const int nibble = byte(5 * block + k / 2) >> (4 * (k % 2)) & 15;
    return nibble < 8 ? nibble : nibble - 16;
  }
  if (view.value_bits == 8) {
    return static_cast<std::int8_t>(byte(9 * block + k));
  }
  return static_cast<std::int16_t>(byte(18 * block + 2 * k) | byte(18 * block + 2 * k + 1) << 8);
}

Eigen::Matrix3d symmetric(const float (&r)[6]) {
  Eigen::Matrix3d m;
  m << r[0], r[1], r[2], r[1], r[3], r[4], r[2], r[4], r[5];
  return m;
}

// the stored blocks of `layers` layers, scaled back: columns by rows transposed, that is 3 columns x 3 rows
MatrixXd decode(const CouplingsView (&layer)[layout::strengths], std::uint32_t layers, std::uint32_t columns,
                std::uint32_t rows, const layout::Scale* of_column, const layout::Scale* of_row) {
  MatrixXd m = MatrixXd::Zero(3 * columns, 3 * rows);
  for (std::uint32_t s = 0; s < layers; ++s) {
    const CouplingsView& view = layer[s];
    for (std::uint32_t j = 0; j < view.columns; ++j) {
      for (std::uint32_t b = view.begin[j]; b < view.begin[j + 1]; ++b) {
        Eigen::Matrix3d block;
        for (std::size_t k = 0; k < 9; ++k) {
          block(static_cast<Index>(k % 3), static_cast<Index>(k / 3)) = double{view.quantum} * value_of(view, b, k);
        }
        const std::uint32_t i = row_of(view, j, b);
        m.block<3, 3>(3 * j, 3 * i) += (symmetric(of_row[i].root) * block * symmetric(of_column[j].root)).transpose();
      }
    }
  }
  return m;
}

void add_diagonal(const layout::Scale* scale, MatrixXd& m) {
  for (Index i = 0; i < m.rows() / 3; ++i) {
    m.block<3, 3>(3 * i, 3 * i) += symmetric(scale[i].root) * symmetric(scale[i].diagonal) * symmetric(scale[i].root);
  }
}

}  // namespace

Eigen::SparseMatrix<double> inverse_step(const ModelView& view, std::uint32_t q) {
  const LevelView& level = view.level[q];
  const Index n = 3 * domain_up_to(view, q);
  std::vector<Eigen::Triplet<double>> lift;
  std::vector<Eigen::Triplet<double>> predict;
  for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
    const Index odd = level.domain_begin + i;
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t parent = level.refinement[i].parent[side];
      for (Index r = 0; in_domain(view, parent) && r < 3; ++r) {
        const Index even = Index{3} * domain_place(view, parent) + r;
        lift.emplace_back(even, 3 * odd + r, -double{level.refinement[i].lift[side]});
        predict.emplace_back(3 * odd + r, even, 0.5);
      }
    }
  }
  for (Index i = 0; i < n; ++i) {
    lift.emplace_back(i, i, 1);
    predict.emplace_back(i, i, 1);
  }
  Eigen::SparseMatrix<double> undo_lifting(n, n);
  Eigen::SparseMatrix<double> interpolate(n, n);
  undo_lifting.setFromTriplets(lift.begin(), lift.end());
  interpolate.setFromTriplets(predict.begin(), predict.end());
  return interpolate * undo_lifting;
}

DenseReference::DenseReference(const ModelView& view) : view_(view), inverse_(view.levels) {
  const auto domain = [&view](std::uint32_t q) { return view.level[q].counts->domain_count; };
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    inverse_[q] = inverse_step(view, q);
  }
  for (std::uint32_t layers = 1; layers <= layout::strengths; ++layers) {
    auto& compliance = compliance_[layers - 1];
    auto& coupled = coupled_[layers - 1];
    coupled.resize(view.levels);
    const LevelView& base = view.level[0];
    const MatrixXd half = decode(base.couplings[2], layers, domain(0), domain(0), base.averages, base.averages);
    compliance.push_back(half + half.transpose());
    add_diagonal(base.averages, compliance[0]);
    for (std::uint32_t q = 1; q < view.levels; ++q) {
      const LevelView& level = view.level[q];
      const std::uint32_t m = q < 2 ? 0 : q - 2;
      coupled[q].resize(3 * domain(q), 3 * domain_up_to(view, q - 1));
      const Index split = 3 * domain_up_to(view, m);
      coupled[q].leftCols(split) =
          decode(level.couplings[0], layers, domain(q), domain_up_to(view, m), level.details, view.level[m].averages);
      MatrixXd b = coupled[q];
      if (q > 1) {
        const LevelView& parents = view.level[q - 1];
        coupled[q].rightCols(3 * domain(q - 1)) =
            decode(level.couplings[1], layers, domain(q), domain(q - 1), level.details, parents.details);
        b = (inverse_[q - 1] * coupled[q].transpose()).transpose();
      }
      const MatrixXd lower = decode(level.couplings[2], layers, domain(q), domain(q), level.details, level.details);
      MatrixXd a = lower + lower.transpose();
      add_diagonal(level.details, a);
      MatrixXd form(inverse_[q].rows(), inverse_[q].cols());
      form << compliance[q - 1], b.transpose(), b, a;
      // symmetric: columns and rows may change places
      compliance.push_back(inverse_[q] * MatrixXd(inverse_[q] * form).transpose());
    }
  }
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    field_.push_back(field(c, view.info->field_layers));
  }
}

MatrixXd DenseReference::field(std::uint32_t c, std::uint32_t layers) const {
  MatrixXd x = compliance(c, layers);
  const Index columns = x.cols();
  for (std::uint32_t q = c + 1; q < view_.levels; ++q) {
    const Index details = 3 * view_.level[q].counts->domain_count;
    MatrixXd form = MatrixXd::Zero(x.rows() + details, columns);
    form.topRows(x.rows()) = x;
    if (q == c + 1) {
      form.bottomRows(details) = q > 1 ? MatrixXd((inverse_[q - 1] * coupled_[layers - 1][q].transpose()).transpose())
                                       : coupled_[layers - 1][q];
    } else if (q == c + 2) {
      form.bottomRows(details) = coupled_[layers - 1][q].leftCols(columns);
    }
    x = inverse_[q] * form;
  }
  return x;
}

MatrixXd DenseReference::averages(std::uint32_t q, MatrixXd x) const {
  for (std::uint32_t l = view_.levels - 1; l > q; --l) {
    const LevelView& level = view_.level[l];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (const std::uint32_t parent : level.refinement[i].parent) {
        if (in_domain(view_, parent)) {
          x.middleRows<3>(3 * (level.domain_begin + i)) -= 0.5 * x.middleRows<3>(3 * domain_place(view_, parent));
        }
      }
    }
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t parent = level.refinement[i].parent[side];
        if (in_domain(view_, parent)) {
          x.middleRows<3>(3 * domain_place(view_, parent)) +=
              double{level.refinement[i].lift[side]} * x.middleRows<3>(3 * (level.domain_begin + i));
        }
      }
    }
    x.conservativeResize(3 * domain_up_to(view_, l - 1), Eigen::NoChange);
  }
  return x;
}

DenseAnswer solve_dense(const ModelView& view, const DenseReference& reference, std::uint32_t c,
                        std::span<const Contact> contacts) {
  std::map<Index, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t q = level_of(view, contacts[i].node);
    const std::uint32_t node = view.representatives[c][q][contacts[i].node - view.level[q].node_begin];
    members[domain_place(view, node)].push_back(i);
  }
  const auto n = static_cast<Index>(members.size());
  MatrixXd capacitance(3 * n, 3 * n);
  MatrixXd used(Index{3} * view.domain_count, 3 * n);
  Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(3 * n);
  const MatrixXd& field = reference.field(c);
  Index j = 0;
  for (const auto& [place, of_place] : members) {
    used.middleCols<3>(3 * j) = field.middleCols<3>(3 * place);
    for (const std::size_t i : of_place) {
      for (Index r = 0; r < 3; ++r) {
        prescribed(3 * j + r) += double{contacts[i].displacement[r]} / static_cast<double>(of_place.size());
      }
    }
    Index i = 0;
    for (const auto& [row, of_row] : members) {
      capacitance.block<3, 3>(3 * i++, 3 * j) =
          reference.compliance(c, layout::strengths).block<3, 3>(3 * row, 3 * place);
    }
    ++j;
  }
  const Eigen::JacobiSVD<MatrixXd> svd(capacitance);
  const Eigen::VectorXd force = capacitance.fullPivLu().solve(prescribed);
  const Eigen::VectorXd displacement = used * force;
  DenseAnswer answer{Eigen::VectorXd(3 * contacts.size()), Eigen::VectorXd::Zero(Index{3} * view.node_count),
                     svd.singularValues().maxCoeff() / svd.singularValues().minCoeff()};
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const Index count = 3 * view.level[q].counts->domain_count;
    answer.displacement.segment(Index{3} * view.level[q].node_begin, count) =
        displacement.segment(Index{3} * view.level[q].domain_begin, count);
  }
  j = 0;
  for (const auto& [place, of_place] : members) {
    for (const std::size_t k : of_place) {
      answer.force.segment<3>(3 * static_cast<Index>(k)) =
          force.segment<3>(3 * j) / static_cast<double>(of_place.size());
      if (c + 1 == view.levels) {
        for (Index r = 0; r < 3; ++r) {
          answer.displacement(Index{3} * contacts[k].node + r) = contacts[k].displacement[r];
        }
      }
    }
    ++j;
  }
  return answer;
}

}  // namespace greenloop
