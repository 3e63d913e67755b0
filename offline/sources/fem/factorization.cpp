#include "offline/sources/fem/factorization.hpp"

#include <dmumps_c.h>
#include <metis.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "offline/single_threaded_blas.hpp"

namespace greenloop::offline {
namespace {

constexpr int kUseComm = -987654;
enum Job : int { kInitialize = -1, kEnd = -2, kAnalyse = 1, kFactorize = 2, kSolve = 3 };

std::string explain(int code, int detail) {
  switch (code) {
    case -10:
    case -40:
      return "the matrix is not positive definite: some part of the body can still move freely. Fix at least three "
             "nodes that are not on one line in every connected piece";
    case -6:
      return "the matrix is singular in structure (rank " + std::to_string(detail) +
             "): some nodes belong to no tetrahedron";
    case -5:
    case -7:
    case -13:
      return "out of memory (MUMPS asked for " + std::to_string(detail) + (detail < 0 ? " million" : "") +
             " entries); use fewer levels or coarser interior elements";
    case -8:
    case -9:
    case -11:
    case -14:
      return "MUMPS' estimate of its memory was too small (" + std::to_string(detail) + " missing)";
    default:
      return "MUMPS failed with INFOG(1) = " + std::to_string(code) + ", INFOG(2) = " + std::to_string(detail) +
             "; see the MUMPS manual, section Error diagnostics";
  }
}

/// Adjacency of the blocks, both directions, without the diagonal.
std::vector<std::pair<idx_t, idx_t>> block_edges(const Eigen::SparseMatrix<double>& lower, int block) {
  std::vector<std::pair<idx_t, idx_t>> edges;
  for (int c = 0; c < lower.outerSize(); c += block) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, c); it; ++it) {
      const idx_t row = static_cast<idx_t>(it.row() / block), column = c / block;
      if (row != column) edges.insert(edges.end(), {{row, column}, {column, row}});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Nested dissection of the blocks: the position of every unknown in the pivot order, from 1. Deterministic, which
/// MUMPS' own choice (threaded SCOTCH) is not.
std::vector<MUMPS_INT> pivot_order(const Eigen::SparseMatrix<double>& lower, int block) {
  const auto edges = block_edges(lower, block);
  idx_t count = static_cast<idx_t>(lower.rows()) / block;
  std::vector<idx_t> start(count + 1, 0), neighbour, order(count), position(count);
  neighbour.reserve(edges.size());
  for (const auto& [from, to] : edges) {
    ++start[from + 1];
    neighbour.push_back(to);
  }
  for (idx_t b = 0; b < count; ++b) {
    start[b + 1] += start[b];
    position[b] = b;
  }
  std::array<idx_t, METIS_NOPTIONS> options{};
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = 1;
  if (!edges.empty() && METIS_NodeND(&count, start.data(), neighbour.data(), nullptr, options.data(), order.data(),
                                     position.data()) != METIS_OK) {
    throw std::runtime_error("factorisation: METIS found no ordering; is memory exhausted?");
  }
  std::vector<MUMPS_INT> pivots(lower.rows());
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    pivots[i] = static_cast<MUMPS_INT>(position[i / block]) * block + static_cast<MUMPS_INT>(i % block) + 1;
  }
  return pivots;
}

bool lacks_workspace(int code) { return code == -8 || code == -9 || code == -11 || code == -14; }

}  // namespace

struct Factorization::Solver {
  DMUMPS_STRUC_C mumps{};
  std::vector<MUMPS_INT> rows, columns, pivots;
  std::vector<double> values;

  Solver() {
    mumps.par = 1;
    mumps.sym = 1;
    mumps.comm_fortran = kUseComm;
    run(kInitialize);
    for (int control : {1, 2, 3}) icntl(control) = -1;
    icntl(4) = 0;
  }
  ~Solver() {
    mumps.job = kEnd;
    dmumps_c(&mumps);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /// Numbered from 1 as in the manual.
  MUMPS_INT& icntl(int number) { return mumps.icntl[number - 1]; }

  int attempt(Job job) {
    const SingleThreadedBlas single_threaded;
    mumps.job = job;
    dmumps_c(&mumps);
    return mumps.infog[0];
  }

  void run(Job job) {
    if (attempt(job) < 0) throw std::runtime_error("factorisation: " + explain(mumps.infog[0], mumps.infog[1]));
  }

  void load(const Eigen::SparseMatrix<double>& lower, int block) {
    pivots = pivot_order(lower, block);
    rows.reserve(lower.nonZeros());
    columns.reserve(lower.nonZeros());
    values.reserve(lower.nonZeros());
    for (int c = 0; c < lower.outerSize(); ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(lower, c); it; ++it) {
        rows.push_back(static_cast<MUMPS_INT>(it.row()) + 1);
        columns.push_back(c + 1);
        values.push_back(it.value());
      }
    }
    mumps.n = static_cast<MUMPS_INT>(lower.rows());
    mumps.nnz = static_cast<MUMPS_INT8>(values.size());
    mumps.irn = rows.data();
    mumps.jcn = columns.data();
    mumps.a = values.data();
    constexpr int kGivenOrder = 1;
    icntl(7) = kGivenOrder;
    mumps.perm_in = pivots.data();
  }

  void factorize() {
    constexpr int kMostExtraMemory = 800;  // per cent
    while (lacks_workspace(attempt(kFactorize)) && icntl(14) < kMostExtraMemory) icntl(14) = 2 * icntl(14) + 20;
    if (mumps.infog[0] < 0) run(kFactorize);
    constexpr int kNegativePivots = 11;
    if (mumps.infog[kNegativePivots] > 0) throw std::runtime_error("factorisation: " + explain(-40, 0));
    // the matrix itself is no longer needed
    for (auto* list : {&rows, &columns, &pivots}) std::vector<MUMPS_INT>().swap(*list);
    std::vector<double>().swap(values);
  }
};

Factorization::Factorization(const Eigen::SparseMatrix<double>& lower, int block)
    : solver_(std::make_unique<Solver>()) {
  if (lower.rows() == 0 || lower.rows() != lower.cols() || lower.rows() % block != 0) {
    throw std::invalid_argument("factorisation: a matrix of " + std::to_string(lower.rows()) + " rows and " +
                                std::to_string(lower.cols()) + " columns, blocks of " + std::to_string(block));
  }
  solver_->load(lower, block);
  solver_->run(kAnalyse);
  solver_->factorize();
}

Factorization::~Factorization() = default;
Factorization::Factorization(Factorization&&) noexcept = default;
Factorization& Factorization::operator=(Factorization&&) noexcept = default;

void Factorization::solve(const Eigen::SparseMatrix<double>& right_hand_sides, Eigen::MatrixXd& solutions) {
  auto& mumps = solver_->mumps;
  if (right_hand_sides.rows() != mumps.n) {
    throw std::invalid_argument("factorisation: right-hand sides of " + std::to_string(right_hand_sides.rows()) +
                                " rows for a matrix of " + std::to_string(mumps.n));
  }
  solutions.resize(right_hand_sides.rows(), right_hand_sides.cols());
  std::vector<MUMPS_INT> start, row;
  std::vector<double> value;
  for (int c = 0; c < right_hand_sides.outerSize(); ++c) {
    start.push_back(static_cast<MUMPS_INT>(value.size()) + 1);
    for (Eigen::SparseMatrix<double>::InnerIterator it(right_hand_sides, c); it; ++it) {
      row.push_back(static_cast<MUMPS_INT>(it.row()) + 1);
      value.push_back(it.value());
    }
  }
  start.push_back(static_cast<MUMPS_INT>(value.size()) + 1);
  mumps.nrhs = static_cast<MUMPS_INT>(right_hand_sides.cols());
  mumps.lrhs = mumps.n;
  mumps.nz_rhs = static_cast<MUMPS_INT>(value.size());
  mumps.irhs_ptr = start.data();
  mumps.irhs_sparse = row.data();
  mumps.rhs_sparse = value.data();
  mumps.rhs = solutions.data();
  constexpr int kSparse = 1;
  solver_->icntl(20) = kSparse;
  solver_->icntl(27) = mumps.nrhs;
  solver_->run(kSolve);
}

void Factorization::solve(Eigen::MatrixXd& sides) {
  auto& mumps = solver_->mumps;
  if (sides.rows() != mumps.n) {
    throw std::invalid_argument("factorisation: right-hand sides of " + std::to_string(sides.rows()) +
                                " rows for a matrix of " + std::to_string(mumps.n));
  }
  mumps.nrhs = static_cast<MUMPS_INT>(sides.cols());
  mumps.lrhs = mumps.n;
  mumps.rhs = sides.data();
  constexpr int kDense = 0;
  solver_->icntl(20) = kDense;
  solver_->icntl(27) = mumps.nrhs;
  solver_->run(kSolve);
}

std::int64_t Factorization::factor_entries() const {
  const auto entries = solver_->mumps.infog[8];
  return entries >= 0 ? entries : -1'000'000LL * entries;
}

double Factorization::factor_operations() const { return solver_->mumps.rinfog[2]; }

}  // namespace greenloop::offline
