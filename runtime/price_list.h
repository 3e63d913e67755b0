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
  ROW(step, 88.9, 241, "a step")                                                                 \
  ROW(level, 601, 1230, "a level that is planned")                                               \
  ROW(factor, 4330, 2750, "a factor that is made")                                               \
  ROW(batch, 62.7, 167, "a batch of rows of a capacitance matrix")                               \
  ROW(field, 539, 112, "a field")                                                                \
  ROW(checked_contact, 9.63, 11.1, "a contact that is checked")                                  \
  ROW(resolved_contact, 58.1, 75.6, "a contact that is resolved at a level")                     \
  ROW(sorted, 3.14, 0.652, "a value in a pass of a sort")                                        \
  ROW(resolved_column, 11.4, 17.9, "a column of a resolved set")                                 \
  ROW(solved_contact, 221, 95.4, "a contact that is solved for")                                 \
  ROW(solved_column, 280, 58, "a column that is solved for")                                     \
  ROW(blended_contact, 8.92, 10.2, "a contact whose force glides and is remembered")             \
  /* factors that there are */                                                                   \
  ROW(cached_factor, 24.2, 87.8, "a factor that is looked at for a set")                         \
  ROW(cached_column, 6.25, 11.3, "a column that is compared with it")                            \
  ROW(near_factor, 15.5, 166, "a factor that is compared for changes")                           \
  ROW(near_column, 35.1, 67.5, "a column of it")                                                 \
  /* coefficients that forces reach */                                                           \
  ROW(visit, 4.88, 20.1, "a visit of finding them")                                              \
  ROW(touched, 4.55, 17.2, "a coefficient that is found")                                        \
  ROW(counted, 3.12, 10.1, "a coefficient whose blocks are counted")                             \
  ROW(dropped, 3.74, 12.2, "a coefficient of a batch that is given up")                          \
  /* capacitance matrices */                                                                     \
  ROW(listed_visit, 4.46, 8.63, "a visit of the computed rows, listed")                          \
  ROW(set_visit, 6.03, 11, "a visit of the set, listed")                                         \
  ROW(slot, 898, 1060, "a coefficient with its scaled diagonal block")                           \
  ROW(cleared, 1.22, 2.46, "a sum that is cleared")                                              \
  ROW(functional_visit, 7.16, 7.77, "a visit of a functional, found")                            \
  ROW(functional, 2.23, 3.03, "a coefficient of a functional, a transform")                      \
  ROW(stored_block, 20.3, 23.7, "a stored block whose row is looked up")                         \
  ROW(scaled_block, 151, 441, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 24.3, 47, "a block times a weight of a functional")                               \
  ROW(meeting_by_blocks, 58.2, 188, "the same where weights are blocks")                         \
  ROW(pair_visit, 15.9, 145, "a visit of the inverse transform of two rows")                     \
  ROW(pair_visit_by_blocks, 53, 355, "the same where weights are blocks")                        \
  ROW(panel_row, 114, 278, "a row that two coefficients' couplings are handed to")               \
  ROW(stored_entry, 74.7, 15.5, "an entry of the matrix, N x N, that is stored")                 \
  /* factors that are made */                                                                    \
  ROW(eliminated, 1.53, 2.3, "a multiply-add of a factorisation")                                \
  ROW(passed, 1.12, 0.23, "an entry of a matrix in a pass over it")                              \
  ROW(substituted, 1.02, 8.68, "a multiply-add of a solution")                                   \
  ROW(appended, 2.54, 4.55, "a multiply-add of bordering")                                       \
  ROW(removed, 2.7, 4.3, "a multiply-add of a rank-one update")                                  \
  ROW(placed_column, 0.387, 0.621, "a column whose place in a factor is found")                  \
  /* fields */                                                                                   \
  ROW(force_visit, 4.8, 12.2, "a visit of the transform of forces")                              \
  ROW(force_visit_by_blocks, 41.9, 58.5, "the same where weights are blocks")                    \
  ROW(force_column, 32.3, 6.69, "a column or contact whose force or displacement is entered")    \
  ROW(coefficient, 1030, 579, "a coefficient whose couplings are summed")                        \
  ROW(summed_block, 16.5, 52.7, "a block in a sum")                                              \
  ROW(scaled_sum, 13.4, 11.7, "a coefficient whose sum is scaled")                               \
  ROW(detail, 8.36, 11.1, "a coefficient whose detail is added")                                 \
  ROW(node, 1.14, 7.06, "a displaced node")                                                      \
  ROW(linear_node, 30, 148, "a node that is predicted from its parents")                         \
  ROW(butterfly_node, 63.5, 176, "a node that is predicted by a stencil")                        \
  ROW(block_node, 82.9, 527, "a node that is predicted by blocks")                               \
  ROW(block_term, 5.73, 18.7, "a block that it is predicted by")

#endif
