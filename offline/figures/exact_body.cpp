#include "offline/figures/exact_body.hpp"

#include <stdexcept>

#include "formats/store/green_store.hpp"

namespace greenloop::offline {

ExactBody open_body(const std::filesystem::path& path) {
  const auto store = std::make_shared<const GreenStore>(GreenStore::open(path, GreenStore::Access::kReadOnly));
  store->require_components(3);
  const auto& contents = store->contents();
  if (contents.row_node != contents.column_node) {
    throw std::runtime_error(path.string() + ": has rows without a column; give a store that `greenloop build` wrote");
  }
  if (!store->missing_columns().empty()) {
    throw std::runtime_error(path.string() + ": lacks " + std::to_string(store->missing_columns().size()) +
                             " columns; finish it with `greenloop build`");
  }
  return {.name = path.stem().string(),
          .mesh = contents.surface,
          .flags = contents.flags,
          .area = contents.area,
          .columns = [store](std::size_t first, std::size_t count) {
            return store->read_columns(static_cast<int>(first), static_cast<int>(count));
          }};
}

}  // namespace greenloop::offline
