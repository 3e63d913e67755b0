/* What the work of a step is made of: counts of what it does, times prices (docs/budgets.md). For C and C++.
 *
 *   ROW(name, x86_64, cortex_m7, what)
 *     x86_64, cortex_m7   instructions of these processors (gcc, optimised), rounded
 *     what                it is the price of; N: components of a node
 *
 * The numbers are fitted to counted instructions; rt_tests/calibrate/fit_price_list.sh writes them anew.
 */
#ifndef GREENLOOP_PRICE_LIST_H
#define GREENLOOP_PRICE_LIST_H

#define GREENLOOP_PRICES(ROW)                                                                    \
  /* whatever is held; contacts and columns */                                                   \
  ROW(step, 88.9, 240, "a step")                                                                 \
  ROW(level, 601, 1310, "a level that is planned")                                               \
  ROW(factor, 4330, 2640, "a factor that is made")                                               \
  ROW(batch, 62.7, 181, "a batch of rows of a capacitance matrix")                               \
  ROW(field, 539, 112, "a field")                                                                \
  ROW(checked_contact, 9.63, 11.3, "a contact that is checked")                                  \
  ROW(resolved_contact, 58.1, 91.7, "a contact that is resolved at a level")                     \
  ROW(sorted, 3.14, 0.652, "a value in a pass of a sort")                                        \
  ROW(resolved_column, 11.4, 20.5, "a column of a resolved set")                                 \
  ROW(solved_contact, 221, 69.5, "a contact that is solved for")                                 \
  ROW(solved_column, 280, 58.1, "a column that is solved for")                                   \
  ROW(blended_contact, 8.92, 10.5, "a contact whose force glides and is remembered")             \
  /* factors that there are */                                                                   \
  ROW(cached_factor, 24.2, 92.3, "a factor that is looked at for a set")                         \
  ROW(cached_column, 6.25, 12, "a column that is compared with it")                              \
  ROW(near_factor, 15.5, 168, "a factor that is compared for changes")                           \
  ROW(near_column, 35.1, 70.3, "a column of it")                                                 \
  /* coefficients that forces reach */                                                           \
  ROW(visit, 4.88, 18.9, "a visit of finding them")                                              \
  ROW(touched, 4.55, 16.7, "a coefficient that is found")                                        \
  ROW(counted, 3.12, 9.86, "a coefficient whose blocks are counted")                             \
  ROW(dropped, 3.74, 10.9, "a coefficient of a batch that is given up")                          \
  /* capacitance matrices */                                                                     \
  ROW(listed_visit, 4.46, 8.99, "a visit of the computed rows, listed")                          \
  ROW(set_visit, 6.03, 14.5, "a visit of the set, listed")                                       \
  ROW(slot, 898, 999, "a coefficient with its scaled diagonal block")                            \
  ROW(cleared, 1.22, 3.09, "a sum that is cleared")                                              \
  ROW(functional_visit, 7.16, 7.12, "a visit of a functional, found")                            \
  ROW(functional, 2.23, 2.83, "a coefficient of a functional, a transform")                      \
  ROW(stored_block, 20.3, 26.7, "a stored block whose row is looked up")                         \
  ROW(scaled_block, 151, 442, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 24.3, 48, "a block times a weight of a functional")                               \
  ROW(meeting_by_blocks, 58.2, 195, "the same where weights are blocks")                         \
  ROW(pair_visit, 15.9, 144, "a visit of the inverse transform of two rows")                     \
  ROW(pair_visit_by_blocks, 53, 360, "the same where weights are blocks")                        \
  ROW(panel_row, 114, 321, "a row that two coefficients' couplings are handed to")               \
  ROW(stored_entry, 74.7, 15.5, "an entry of the matrix, N x N, that is stored")                 \
  /* factors that are made */                                                                    \
  ROW(eliminated, 1.53, 2.11, "a multiply-add of a factorisation")                               \
  ROW(passed, 1.12, 0.234, "an entry of a matrix in a pass over it")                             \
  ROW(substituted, 1.02, 8.73, "a multiply-add of a solution")                                   \
  ROW(appended, 2.54, 4.05, "a multiply-add of bordering")                                       \
  ROW(removed, 2.7, 4.53, "a multiply-add of a rank-one update")                                 \
  ROW(placed_column, 0.387, 0.621, "a column whose place in a factor is found")                  \
  /* fields */                                                                                   \
  ROW(force_visit, 4.8, 12.8, "a visit of the transform of forces")                              \
  ROW(force_visit_by_blocks, 41.9, 61.3, "the same where weights are blocks")                    \
  ROW(force_column, 32.3, 6.7, "a column or contact whose force or displacement is entered")     \
  ROW(coefficient, 1030, 547, "a coefficient whose couplings are summed")                        \
  ROW(summed_block, 16.5, 54.1, "a block in a sum")                                              \
  ROW(scaled_sum, 13.4, 14.2, "a coefficient whose sum is scaled")                               \
  ROW(detail, 8.36, 12.1, "a coefficient whose detail is added")                                 \
  ROW(node, 1.14, 7.07, "a displaced node")                                                      \
  ROW(linear_node, 30, 136, "a node that is predicted from its parents")                         \
  ROW(butterfly_node, 63.5, 163, "a node that is predicted by a stencil")                        \
  ROW(block_node, 82.9, 511, "a node that is predicted by blocks")                               \
  ROW(block_term, 5.73, 18.4, "a block that it is predicted by")                                 \
  /* unilateral contacts */                                                                      \
  ROW(law, 350, 350, "a unilateral contact whose law is set up")                                 \
  ROW(law_block, 13, 13, "a block of their compliance, in one direction")                        \
  ROW(swept_law, 850, 850, "a contact in a pair of sweeps")                                      \
  ROW(projected_law, 200, 200, "a contact that is projected onto its cone")                      \
  ROW(frozen_law, 600, 600, "a contact in a Newton step")                                        \
  ROW(law_vector, 350, 350, "a contact in a vector of it")

#endif
