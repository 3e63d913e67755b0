/* What the work of a step is made of: counts of what it does, times prices (docs/budgets.md). For C and C++.
 *
 *   ROW(name, x86_64, cortex_m7, what)
 *     x86_64, cortex_m7   instructions of these processors (gcc, optimised), rounded
 *     what                it is the price of; N: components of a node
 *
 * The numbers are fitted to counted instructions, those of the Cortex-M7 raised by 2 %, so that no step is counted too
 * short; rt_tests/calibrate/fit_price_list.sh fits them anew.
 */
#ifndef GREENLOOP_PRICE_LIST_H
#define GREENLOOP_PRICE_LIST_H

#define GREENLOOP_PRICES(ROW)                                                                    \
  /* whatever is held; contacts and columns */                                                   \
  ROW(step, 80, 148, "a step")                                                                   \
  ROW(level, 849, 1200, "a level that is planned")                                               \
  ROW(factor, 2740, 2550, "a factor that is made")                                               \
  ROW(batch, 48.4, 99, "a batch of rows of a capacitance matrix")                                \
  ROW(field, 543, 99.6, "a field")                                                               \
  ROW(checked_contact, 7.61, 12.9, "a contact that is checked")                                  \
  ROW(resolved_contact, 109, 92.9, "a contact that is resolved at a level")                      \
  ROW(sorted, 3.21, 3.72, "a value in a pass of a sort")                                         \
  ROW(resolved_column, 9.71, 21.6, "a column of a resolved set")                                 \
  ROW(solved_contact, 224, 97.1, "a contact that is solved for")                                 \
  ROW(solved_column, 196, 191, "a column that is solved for")                                    \
  ROW(blended_contact, 6.79, 11.7, "a contact whose force glides and is remembered")             \
  /* factors that there are */                                                                   \
  ROW(cached_factor, 24.1, 42.7, "a factor that is looked at for a set")                         \
  ROW(cached_column, 6.9, 12.6, "a column that is compared with it")                             \
  ROW(near_factor, 14.4, 90.7, "a factor that is compared for changes")                          \
  ROW(near_column, 37.7, 86.1, "a column of it")                                                 \
  /* coefficients that forces reach */                                                           \
  ROW(visit, 9.28, 24.1, "a visit of finding them")                                              \
  ROW(touched, 6.58, 16.9, "a coefficient that is found")                                        \
  ROW(counted, 4.05, 9.5, "a coefficient whose blocks are counted")                              \
  ROW(dropped, 3.75, 11.7, "a coefficient of a batch that is given up")                          \
  /* capacitance matrices */                                                                     \
  ROW(listed_visit, 4.28, 9.1, "a visit of the computed rows, listed")                           \
  ROW(set_visit, 5.96, 15.9, "a visit of the set, listed")                                       \
  ROW(slot, 396, 767, "a coefficient that has a place in the panel or the sums")                 \
  ROW(layer, 264, 260, "a layer of it whose blocks are looked up")                               \
  ROW(diagonal, 179, 277, "its scaled diagonal block")                                           \
  ROW(cleared, 2.34, 4.09, "a sum that is cleared")                                              \
  ROW(functional_visit, 34.8, 39.1, "a visit of a functional, found")                            \
  ROW(functional, 3.55, 6.13, "a coefficient of a functional, a transform")                      \
  ROW(stored_block, 4.13, 5.5, "a stored block whose row is looked up")                          \
  ROW(scaled_block, 132, 303, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 21.8, 54.4, "a block times a weight of a functional")                             \
  ROW(meeting_by_blocks, 58.7, 125, "the same where weights are blocks")                         \
  ROW(pair_visit, 10.7, 54.4, "a visit of the inverse transform of two rows")                    \
  ROW(pair_visit_by_blocks, 52, 217, "the same where weights are blocks")                        \
  ROW(panel_row, 123, 117, "a row that two coefficients' couplings are handed to")               \
  ROW(stored_entry, 43.1, 49, "an entry of the matrix, N x N, that is stored")                   \
  /* factors that are made */                                                                    \
  ROW(eliminated, 1.84, 3.59, "a multiply-add of a factorisation")                               \
  ROW(passed, 2.16, 0.163, "an entry of a matrix in a pass over it")                             \
  ROW(substituted, 1.21, 7.24, "a multiply-add of a solution")                                   \
  ROW(appended, 2.94, 3.53, "a multiply-add of bordering")                                       \
  ROW(removed, 2.96, 4.8, "a multiply-add of a rank-one update")                                 \
  ROW(placed_column, 0.41, 0.626, "a column whose place in a factor is found")                   \
  /* fields */                                                                                   \
  ROW(force_visit, 6.65, 9.77, "a visit of the transform of forces")                             \
  ROW(force_visit_by_blocks, 40.7, 97.3, "the same where weights are blocks")                    \
  ROW(force_column, 48.5, 7.26, "a column or contact whose force or displacement is entered")    \
  ROW(coefficient, 972, 697, "a coefficient whose couplings are summed")                         \
  ROW(summed_block, 17.3, 52.8, "a block in a sum")                                              \
  ROW(scaled_sum, 13.5, 22.3, "a coefficient whose sum is scaled")                               \
  ROW(detail, 8.46, 14.7, "a coefficient whose detail is added")                                 \
  ROW(node, 1.16, 1.72, "a displaced node")                                                      \
  ROW(resting_field, 63, 103, "a field of a body at rest")                                       \
  ROW(resting_node, 0.895, 7.06, "a node of it")                                                 \
  ROW(linear_node, 30.4, 144, "a node that is predicted from its parents")                       \
  ROW(butterfly_node, 60, 179, "a node that is predicted by a stencil")                          \
  ROW(block_node, 80.6, 464, "a node that is predicted by blocks")                               \
  ROW(block_term, 5.83, 15.8, "a block that it is predicted by")                                 \
  /* unilateral contacts */                                                                      \
  ROW(law, 350, 1090, "a unilateral contact whose law is set up")                                \
  ROW(law_block, 13, 31.1, "a block of their compliance, in one direction")                      \
  ROW(swept_law, 850, 340, "a contact in a pair of sweeps")                                      \
  ROW(projected_law, 200, 354, "a contact that is projected onto its cone")                      \
  ROW(frozen_law, 600, 1510, "a contact in a Newton step")                                       \
  ROW(law_vector, 350, 972, "a contact in a vector of it")

#endif
