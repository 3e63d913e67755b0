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
  ROW(step, 79, 240, "a step")                                                                   \
  ROW(level, 809, 1310, "a level that is planned")                                               \
  ROW(factor, 3830, 2640, "a factor that is made")                                               \
  ROW(batch, 49.4, 181, "a batch of rows of a capacitance matrix")                               \
  ROW(field, 524, 112, "a field")                                                                \
  ROW(checked_contact, 8.36, 11.3, "a contact that is checked")                                  \
  ROW(resolved_contact, 76.9, 91.7, "a contact that is resolved at a level")                     \
  ROW(sorted, 2.46, 0.652, "a value in a pass of a sort")                                        \
  ROW(resolved_column, 11.2, 20.5, "a column of a resolved set")                                 \
  ROW(solved_contact, 211, 69.5, "a contact that is solved for")                                 \
  ROW(solved_column, 272, 58.1, "a column that is solved for")                                   \
  ROW(blended_contact, 7.49, 10.5, "a contact whose force glides and is remembered")             \
  /* factors that there are */                                                                   \
  ROW(cached_factor, 22.4, 92.3, "a factor that is looked at for a set")                         \
  ROW(cached_column, 6.85, 12, "a column that is compared with it")                              \
  ROW(near_factor, 13.7, 168, "a factor that is compared for changes")                           \
  ROW(near_column, 33.3, 70.3, "a column of it")                                                 \
  /* coefficients that forces reach */                                                           \
  ROW(visit, 7.03, 18.9, "a visit of finding them")                                              \
  ROW(touched, 5.48, 16.7, "a coefficient that is found")                                        \
  ROW(counted, 3.57, 9.86, "a coefficient whose blocks are counted")                             \
  ROW(dropped, 3.95, 10.9, "a coefficient of a batch that is given up")                          \
  /* capacitance matrices */                                                                     \
  ROW(listed_visit, 3.41, 8.99, "a visit of the computed rows, listed")                          \
  ROW(set_visit, 5.54, 14.5, "a visit of the set, listed")                                       \
  ROW(slot, 510, 500, "a coefficient that has a place in the panel or the sums")                 \
  ROW(layer, 198, 90, "a layer of it whose blocks are looked up")                                \
  ROW(diagonal, 163, 139, "its scaled diagonal block")                                           \
  ROW(cleared, 1.34, 3.09, "a sum that is cleared")                                              \
  ROW(functional_visit, 13.3, 7.12, "a visit of a functional, found")                            \
  ROW(functional, 2.32, 2.83, "a coefficient of a functional, a transform")                      \
  ROW(stored_block, 14.2, 26.7, "a stored block whose row is looked up")                         \
  ROW(scaled_block, 123, 442, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 25.4, 48, "a block times a weight of a functional")                               \
  ROW(meeting_by_blocks, 65.8, 195, "the same where weights are blocks")                         \
  ROW(pair_visit, 12.9, 144, "a visit of the inverse transform of two rows")                     \
  ROW(pair_visit_by_blocks, 51.4, 360, "the same where weights are blocks")                      \
  ROW(panel_row, 135, 321, "a row that two coefficients' couplings are handed to")               \
  ROW(stored_entry, 43, 15.5, "an entry of the matrix, N x N, that is stored")                   \
  /* factors that are made */                                                                    \
  ROW(eliminated, 1.82, 2.11, "a multiply-add of a factorisation")                               \
  ROW(passed, 0.781, 0.234, "an entry of a matrix in a pass over it")                            \
  ROW(substituted, 0.984, 8.73, "a multiply-add of a solution")                                  \
  ROW(appended, 2.67, 4.05, "a multiply-add of bordering")                                       \
  ROW(removed, 2.96, 4.53, "a multiply-add of a rank-one update")                                \
  ROW(placed_column, 0.344, 0.621, "a column whose place in a factor is found")                  \
  /* fields */                                                                                   \
  ROW(force_visit, 6.69, 12.8, "a visit of the transform of forces")                             \
  ROW(force_visit_by_blocks, 9.05, 61.3, "the same where weights are blocks")                    \
  ROW(force_column, 38.2, 6.7, "a column or contact whose force or displacement is entered")     \
  ROW(coefficient, 971, 547, "a coefficient whose couplings are summed")                         \
  ROW(summed_block, 18.2, 54.1, "a block in a sum")                                              \
  ROW(scaled_sum, 13, 14.2, "a coefficient whose sum is scaled")                                 \
  ROW(detail, 8.23, 12.1, "a coefficient whose detail is added")                                 \
  ROW(node, 1.14, 7.07, "a displaced node")                                                      \
  ROW(resting_field, 62, 20, "a field of a body at rest")                                        \
  ROW(resting_node, 0.877, 7.07, "a node of it")                                                 \
  ROW(linear_node, 27.7, 136, "a node that is predicted from its parents")                       \
  ROW(butterfly_node, 58, 163, "a node that is predicted by a stencil")                          \
  ROW(block_node, 96.8, 511, "a node that is predicted by blocks")                               \
  ROW(block_term, 6.02, 18.4, "a block that it is predicted by")                                 \
  /* unilateral contacts */                                                                      \
  ROW(law, 350, 350, "a unilateral contact whose law is set up")                                 \
  ROW(law_block, 13, 13, "a block of their compliance, in one direction")                        \
  ROW(swept_law, 850, 850, "a contact in a pair of sweeps")                                      \
  ROW(projected_law, 200, 200, "a contact that is projected onto its cone")                      \
  ROW(frozen_law, 600, 600, "a contact in a Newton step")                                        \
  ROW(law_vector, 350, 350, "a contact in a vector of it")

#endif
