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
  ROW(step, 87.9, 172, "a step")                                                                 \
  ROW(level, 660, 889, "a level that is planned")                                                \
  ROW(factor, 1890, 1300, "a factor that is made")                                        \
  ROW(batch, 66.3, 678, "a batch of rows of a capacitance matrix")                               \
  ROW(field, 506, 40, "a field")                                                                 \
  ROW(checked_contact, 15.8, 35.7, "a contact that is checked")                                  \
  ROW(resolved_contact, 49.9, 19, "a contact that is resolved at a level")                       \
  ROW(sorted, 4.24, 3.81, "a value in a pass of a sort")                                         \
  ROW(resolved_column, 16.5, 14.3, "a column of a resolved set")                                 \
  ROW(ranked_contact, 277, 469, "a contact whose group is ranked")                               \
  ROW(solved_contact, 123, 165, "a contact that is solved for")                                  \
  ROW(solved_column, 308, 176, "a column that is solved for")                                    \
  ROW(blended_contact, 15, 15, "a contact whose force glides and is remembered")                 \
  /* factors that there are */                                                                   \
  ROW(cached_factor, 21.7, 8.95, "a factor that is looked at for a set")                         \
  ROW(cached_column, 5.72, 9.37, "a column that is compared with it")                            \
  ROW(near_factor, 287, 722, "a factor that is compared for changes")                            \
  ROW(near_column, 23.8, 18.8, "a column of it")                                                 \
  /* coefficients that forces reach */                                                           \
  ROW(visit, 9.75, 24.9, "a visit of finding them")                                              \
  ROW(touched, 69.9, 6.7, "a coefficient that is found")                                         \
  ROW(counted, 3.97, 4.4, "a coefficient whose blocks are counted")                              \
  ROW(dropped, 4.08, 10.2, "a coefficient of a batch that is given up")                          \
  /* capacitance matrices */                                                                     \
  ROW(listed_visit, 15, 24.7, "a visit of the computed rows, listed")                            \
  ROW(set_visit, 6, 40.6, "a visit of the set, listed")                                          \
  ROW(slot, 1010, 553, "a coefficient with its scaled diagonal block")                       \
  ROW(cleared, 1.8, 22, "a sum that is cleared")                                                 \
  ROW(functional_visit, 10, 1.99, "a visit of a functional, found")                              \
  ROW(functional, 30, 4, "a coefficient of a functional, a transform")                           \
  ROW(stored_block, 24.2, 39.2, "a stored block whose row is looked up")                         \
  ROW(scaled_block, 131, 415, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 24.8, 53.4, "a block times a weight of a functional")                             \
  ROW(meeting_by_blocks, 59.5, 194, "the same where weights are blocks")                         \
  ROW(pair_visit, 28.1, 142, "a visit of the inverse transform of two rows")                     \
  ROW(pair_visit_by_blocks, 86.9, 364, "the same where weights are blocks")                      \
  ROW(panel_row, 55.9, 151, "a row that two coefficients' couplings are handed to")              \
  ROW(stored_entry, 72.4, 30.9, "an entry of the matrix, N x N, that is stored")                 \
  /* factors that are made */                                                                    \
  ROW(eliminated, 1.33, 4.08, "a multiply-add of a factorisation")                               \
  ROW(passed, 1.5, 0.515, "an entry of a matrix in a pass over it")                              \
  ROW(substituted, 1.28, 7.17, "a multiply-add of a solution")                                   \
  ROW(appended, 1.3, 2.38, "a multiply-add of bordering")                                        \
  ROW(removed, 0.7, 2, "a multiply-add of a rank-one update")                                    \
  ROW(placed_column, 4.12, 0.845, "a column whose place in a factor is found")                   \
  /* fields */                                                                                   \
  ROW(force_visit, 6, 10.3, "a visit of the transform of forces")                                \
  ROW(force_visit_by_blocks, 36.7, 66.4, "the same where weights are blocks")                    \
  ROW(force_column, 23.8, 6.07, "a column or contact whose force or displacement is entered")    \
  ROW(coefficient, 991, 424, "a coefficient whose couplings are summed")                         \
  ROW(summed_block, 16.9, 60, "a block in a sum")                                                \
  ROW(scaled_sum, 20.2, 59.8, "a coefficient whose sum is scaled")                               \
  ROW(detail, 10.3, 39.3, "a coefficient whose detail is added")                                 \
  ROW(node, 1.14, 7.74, "a displaced node")                                                      \
  ROW(linear_node, 25.1, 74.6, "a node that is predicted from its parents")                      \
  ROW(butterfly_node, 60.3, 151, "a node that is predicted by a stencil")                        \
  ROW(block_node, 74.1, 110, "a node that is predicted by blocks")                               \
  ROW(block_term, 5.38, 110, "a block that it is predicted by")

#endif
