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

#define GREENLOOP_PRICES(ROW)                                                                  \
  /* whatever is held; contacts and columns */                                                 \
  ROW(step, 0, 0, "a step")                                                                    \
  ROW(level, 0, 0, "a level that is planned")                                                  \
  ROW(factor, 0, 0, "a factor that is made")                                                   \
  ROW(batch, 0, 0, "a batch of rows of a capacitance matrix")                                  \
  ROW(field, 0, 0, "a field")                                                                  \
  ROW(checked_contact, 4, 4, "a contact that is checked")                                      \
  ROW(resolved_contact, 4, 4, "a contact that is resolved at a level")                         \
  ROW(sorted, 1, 1, "a value in a pass of a sort")                                             \
  ROW(resolved_column, 4, 4, "a column of a resolved set")                                     \
  ROW(ranked_contact, 24, 24, "a contact whose group is ranked")                               \
  ROW(solved_contact, 6, 6, "a contact that is solved for")                                    \
  ROW(solved_column, 12, 12, "a column that is solved for")                                    \
  ROW(blended_contact, 32, 32, "a contact whose force glides and is remembered")               \
  /* factors that there are */                                                                 \
  ROW(cached_factor, 1, 1, "a factor that is looked at for a set")                             \
  ROW(cached_column, 2, 2, "a column that is compared with it")                                \
  ROW(near_factor, 16, 16, "a factor that is compared for changes")                            \
  ROW(near_column, 2, 2, "a column of it")                                                     \
  /* coefficients that forces reach */                                                         \
  ROW(visit, 2, 2, "a visit of finding them")                                                  \
  ROW(touched, 8, 8, "a coefficient that is found")                                            \
  ROW(counted, 1, 1, "a coefficient whose blocks are counted")                                 \
  ROW(dropped, 2, 2, "a coefficient of a batch that is given up")                              \
  /* capacitance matrices */                                                                   \
  ROW(listed_visit, 4, 4, "a visit of the computed rows, listed")                              \
  ROW(set_visit, 2, 2, "a visit of the set, listed")                                           \
  ROW(slot, 60, 60, "a coefficient with its scaled diagonal block")                            \
  ROW(cleared, 1, 1, "a sum that is cleared")                                                  \
  ROW(functional_visit, 2, 2, "a visit of a functional, found")                                \
  ROW(functional, 16, 16, "a coefficient of a functional, a transform")                        \
  ROW(stored_block, 4, 4, "a stored block whose row is looked up")                             \
  ROW(scaled_block, 84, 84, "a block between coefficients that are reached, scaled and added") \
  ROW(meeting, 9, 9, "a block times a weight of a functional")                                 \
  ROW(meeting_by_blocks, 48, 48, "the same where weights are blocks")                          \
  ROW(pair_visit, 18, 18, "a visit of the inverse transform of two rows")                      \
  ROW(pair_visit_by_blocks, 84, 84, "the same where weights are blocks")                       \
  ROW(panel_row, 6, 6, "a row that two coefficients' couplings are handed to")                 \
  ROW(stored_entry, 9, 9, "an entry of the matrix, N x N, that is stored")                     \
  /* factors that are made */                                                                  \
  ROW(eliminated, 1, 1, "a multiply-add of a factorisation")                                   \
  ROW(passed, 1, 1, "an entry of a matrix in a pass over it")                                  \
  ROW(substituted, 1, 1, "a multiply-add of a solution")                                       \
  ROW(appended, 1, 1, "a multiply-add of bordering")                                           \
  ROW(removed, 1, 1, "a multiply-add of a rank-one update")                                    \
  ROW(placed_column, 1, 1, "a column whose place in a factor is found")                        \
  /* fields */                                                                                 \
  ROW(force_visit, 3, 3, "a visit of the transform of forces")                                 \
  ROW(force_visit_by_blocks, 44, 44, "the same where weights are blocks")                      \
  ROW(force_column, 4, 4, "a column or contact whose force or displacement is entered")        \
  ROW(coefficient, 60, 60, "a coefficient whose couplings are summed")                         \
  ROW(summed_block, 12, 12, "a block in a sum")                                                \
  ROW(scaled_sum, 14, 14, "a coefficient whose sum is scaled")                                 \
  ROW(detail, 8, 8, "a coefficient whose detail is added")                                     \
  ROW(node, 1, 1, "a displaced node")                                                          \
  ROW(linear_node, 6, 6, "a node that is predicted from its parents")                          \
  ROW(butterfly_node, 24, 24, "a node that is predicted by a stencil")                         \
  ROW(block_node, 20, 20, "a node that is predicted by blocks")                                \
  ROW(block_term, 29, 29, "a block that it is predicted by")

#endif
