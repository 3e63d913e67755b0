#include "rt_tests/harness/set_works.hpp"

#include <algorithm>
#include <iterator>

#include "runtime/elastostatic/planner.hpp"

namespace greenloop {

BlockNeighbours::BlockNeighbours(const ModelView& view) : neighbours_(view.domain_count) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (const CouplingsView& couplings : level.couplings) {
      for (std::uint32_t j = 0; j < couplings.columns; ++j) {
        const std::uint32_t column = level.domain_begin + j;
        visit_rows(couplings, j, 0, view.domain_count, [&](std::uint32_t row, std::uint32_t) {
          neighbours_[row].push_back(column);
          neighbours_[column].push_back(row);
        });
      }
    }
  }
}

SetWorks::SetWorks(Body& body, const BlockNeighbours& neighbours, std::uint32_t level)
    : body_(&body),
      neighbours_(&neighbours),
      level_(level),
      functional_(body.view->domain_count),
      nodes_(body.view->domain_count),
      dependents_(body.view->domain_count),
      met_(body.view->domain_count) {}

std::uint32_t SetWorks::column(std::uint32_t node) const { return column_of(*body_->view, body_->facts, node, level_); }

void SetWorks::add(std::uint32_t node) {
  const std::uint32_t column = this->column(node);
  if (nodes_[column_place(column)]++ == 0) {
    columns_.insert(std::lower_bound(columns_.begin(), columns_.end(), column), column);
  }
}

void SetWorks::remove(std::uint32_t node) {
  const std::uint32_t column = this->column(node);
  if (--nodes_[column_place(column)] == 0) {
    columns_.erase(std::lower_bound(columns_.begin(), columns_.end(), column));
  }
}

// those that are new before those that are gone, so that what they share stays
void SetWorks::follow_columns() {
  std::vector<std::uint32_t> changed;
  std::set_difference(columns_.begin(), columns_.end(), followed_.begin(), followed_.end(),
                      std::back_inserter(changed));
  for (const std::uint32_t column : changed) {
    for (const std::uint32_t coefficient : functional(column)) add_dependent(coefficient);
  }
  changed.clear();
  std::set_difference(followed_.begin(), followed_.end(), columns_.begin(), columns_.end(),
                      std::back_inserter(changed));
  for (const std::uint32_t column : changed) {
    for (const std::uint32_t coefficient : functional(column)) remove_dependent(coefficient);
  }
  followed_ = columns_;
}

const std::vector<std::uint32_t>& SetWorks::functional(std::uint32_t column) {
  std::vector<std::uint32_t>& coefficients = functional_[column_place(column)];
  if (coefficients.empty()) {
    Touched& touched = body_->touched;
    clear(touched);
    touch(body_->refinement, &column, 1, touched);
    for (std::uint32_t q = 0; q <= touched.finest; ++q) {
      coefficients.insert(coefficients.end(), touched.list[q], touched.list[q] + touched.count[q]);
    }
  }
  effort_ += coefficients.size();
  return coefficients;
}

void SetWorks::add_dependent(std::uint32_t coefficient) {
  if (dependents_[coefficient]++ == 0) {
    for (const std::uint32_t other : neighbours_->of(coefficient)) {
      ++met_[other];
      meetings_ += dependents_[other];
    }
    blocks_ += met_[coefficient];
    effort_ += neighbours_->of(coefficient).size();
  }
  meetings_ += met_[coefficient];
}

void SetWorks::remove_dependent(std::uint32_t coefficient) {
  meetings_ -= met_[coefficient];
  if (--dependents_[coefficient] == 0) {
    for (const std::uint32_t other : neighbours_->of(coefficient)) {
      --met_[other];
      meetings_ -= dependents_[other];
    }
    blocks_ -= met_[coefficient];
    effort_ += neighbours_->of(coefficient).size();
  }
}

NeededWork SetWorks::needed(std::uint64_t contacts) {
  const ModelCounts& model = body_->counts;
  const ColumnSet all{static_cast<std::uint32_t>(columns_.size()), columns_.data()};
  clear(body_->touched);
  touch(body_->refinement, all.column, all.count, body_->touched);
  SetCounts& set = counts_;
  set = {};
  set.contacts = contacts;
  set.columns = all.count;
  count_factor(all, body_->touched, body_->cost, body_->stored, set);
  effort_ += 4 * (set.visits + set.coefficients);
  const std::uint32_t finest = model.levels - 1;
  NeededWork needed;
  if (!model.forces_only) {
    needed.field =
        field_work(model, set, {finest, finest}, count_field_blocks(body_->field_blocks, body_->touched, finest));
  }
  needed.whole = plan_set_work(model, set) + factor_work(model, set) + force_work(model.prices, set) + needed.field;
  return needed;
}

std::uint64_t SetWorks::unmet() {
  follow_columns();
  const ModelCounts& model = body_->counts;
  const SetCounts& set = counts_;
  const std::uint64_t blocks = std::min({set.stored, set.slots * (set.slots + 1) / 2, set.column.meetings});
  const std::uint64_t meetings =
      has_panel(model.capacitance_room, set.slots, set.columns) ? 0 : set.column.meetings - meetings_;
  return priced(blocks - blocks_, model.prices.scaled_block) +
         priced(meetings, meeting_price(model.prices, model.prediction));
}

}  // namespace greenloop
