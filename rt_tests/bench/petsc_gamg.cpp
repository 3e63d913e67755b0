#include "rt_tests/bench/petsc_gamg.hpp"

#include "runtime/hosted/thread_clock.hpp"
#ifdef GREENLOOP_HAS_PETSC
#include <petscksp.h>
#endif

namespace greenloop::bench {

#ifdef GREENLOOP_HAS_PETSC
namespace {

using offline::BlockMatrix;
using offline::Double4;
using offline::DoubleBlock;

constexpr PetscInt kMostIterations = 2000;

/// PETSc from the first solution to the end of the program.
struct Petsc {
  Petsc() { (void)PetscInitializeNoArguments(); }
  ~Petsc() { (void)PetscFinalize(); }
};

Mat petsc_matrix(const BlockMatrix& matrix) {
  const auto rows = static_cast<PetscInt>(matrix.rows());
  std::vector<PetscInt> row_lengths;
  for (PetscInt v = 0; v < rows; ++v) {
    for (int i = 0; i < 3; ++i)
      row_lengths.push_back(3 * static_cast<PetscInt>(matrix.start[v + 1] - matrix.start[v] + 1));
  }
  Mat result = nullptr;
  (void)MatCreateSeqAIJ(PETSC_COMM_SELF, 3 * rows, 3 * rows, 0, row_lengths.data(), &result);
  (void)MatSetBlockSize(result, 3);
  const auto add = [&](PetscInt row, PetscInt column, const DoubleBlock& block) {
    PetscScalar values[9];
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) values[3 * i + j] = block.column[j][i];
    }
    (void)MatSetValuesBlocked(result, 1, &row, 1, &column, values, INSERT_VALUES);
  };
  for (PetscInt v = 0; v < rows; ++v) {
    add(v, v, matrix.diagonal[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) {
      add(v, static_cast<PetscInt>(matrix.column[k]), matrix.block[k]);
    }
  }
  (void)MatAssemblyBegin(result, MAT_FINAL_ASSEMBLY);
  (void)MatAssemblyEnd(result, MAT_FINAL_ASSEMBLY);
  (void)MatSetOption(result, MAT_SPD, PETSC_TRUE);
  return result;
}

Vec petsc_vector(std::size_t vertices) {
  Vec result = nullptr;
  (void)VecCreateSeq(PETSC_COMM_SELF, 3 * static_cast<PetscInt>(vertices), &result);
  (void)VecSetBlockSize(result, 3);
  return result;
}

template <class Value>
Vec petsc_vector(std::size_t vertices, const Value& value) {
  Vec result = petsc_vector(vertices);
  PetscScalar* numbers = nullptr;
  (void)VecGetArray(result, &numbers);
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t i = 0; i < 3; ++i) numbers[3 * v + i] = value(v, i);
  }
  (void)VecRestoreArray(result, &numbers);
  return result;
}

/// Names the rigid motions of a body to the matrix.
void set_rigid_motions(Mat matrix, const TetrahedralMesh& mesh, const offline::FreeVertices& free) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (free.number[v] >= 0) points.push_back(mesh.vertices[v]);
  }
  Vec coordinates = petsc_vector(points.size(),
                                 [&](std::size_t v, std::size_t i) { return points[v][static_cast<Eigen::Index>(i)]; });
  MatNullSpace motions = nullptr;
  (void)MatNullSpaceCreateRigidBody(coordinates, &motions);
  (void)MatSetNearNullSpace(matrix, motions);
  (void)MatNullSpaceDestroy(&motions);
  (void)VecDestroy(&coordinates);
}

KSP solver_of(Mat matrix, double tolerance) {
  KSP solver = nullptr;
  PC preconditioner = nullptr;
  (void)KSPCreate(PETSC_COMM_SELF, &solver);
  (void)KSPSetOperators(solver, matrix, matrix);
  (void)KSPSetType(solver, KSPCG);
  (void)KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED);
  (void)KSPSetTolerances(solver, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, kMostIterations);
  (void)KSPGetPC(solver, &preconditioner);
  (void)PCSetType(preconditioner, PCGAMG);
  // which also sets the defaults of GAMG; without, its set-up takes three times as long
  (void)KSPSetFromOptions(solver);
  return solver;
}

double seconds() { return 1e-9 * static_cast<double>(thread_nanoseconds()); }

}  // namespace

bool PetscGamg::available() { return true; }

PetscGamg::Answer PetscGamg::solve(const BlockMatrix& matrix, const TetrahedralMesh& mesh,
                                   const offline::FreeVertices& free, std::span<const Double4> b, double tolerance) {
  static const Petsc petsc;
  Mat operator_matrix = petsc_matrix(matrix);
  set_rigid_motions(operator_matrix, mesh, free);
  Vec right = petsc_vector(b.size(), [&](std::size_t v, std::size_t i) { return b[v][i]; });
  Vec found = petsc_vector(b.size());
  KSP solver = solver_of(operator_matrix, tolerance);

  Answer answer;
  const double start = seconds();
  (void)KSPSetUp(solver);
  const double ready = seconds();
  (void)KSPSolve(solver, right, found);
  answer.solve_s = seconds() - ready;
  answer.setup_s = ready - start;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  (void)KSPGetConvergedReason(solver, &reason);
  (void)KSPGetIterationNumber(solver, &iterations);
  answer.solved = reason > 0;
  answer.iterations = static_cast<int>(iterations);
  const PetscScalar* numbers = nullptr;
  (void)VecGetArrayRead(found, &numbers);
  for (std::size_t v = 0; v < b.size(); ++v) {
    answer.x.push_back(Double4{numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2], 0.0});
  }
  (void)VecRestoreArrayRead(found, &numbers);
  (void)KSPDestroy(&solver);
  (void)VecDestroy(&found);
  (void)VecDestroy(&right);
  (void)MatDestroy(&operator_matrix);
  return answer;
}
#else
bool PetscGamg::available() { return false; }

PetscGamg::Answer PetscGamg::solve(const offline::BlockMatrix&, const TetrahedralMesh&, const offline::FreeVertices&,
                                   std::span<const offline::Double4>, double) {
  return {};
}
#endif

}  // namespace greenloop::bench
