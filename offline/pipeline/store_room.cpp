#include "offline/pipeline/store_room.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <system_error>

#include "offline/pipeline/body_sizes.hpp"

namespace greenloop::offline {

void require_store_room(const std::filesystem::path& store, std::size_t rows, std::size_t columns,
                        const LevelsThatFit& levels) {
  constexpr double block = 9 * sizeof(double);
  std::error_code error;
  const auto disk = std::filesystem::space(std::filesystem::absolute(store).parent_path(), error);
  if (error) return;
  const double needed = block * static_cast<double>(rows) * static_cast<double>(columns);
  const auto free = static_cast<double>(disk.available);
  if (needed <= free) return;
  throw std::runtime_error(
      fmt::format("{}: {} columns of Green's functions to solve need {}, its disk has {} free; make room there, name a "
                  "file on a larger disk with --store, or take fewer [remesh] levels{}",
                  store.string(), columns, bytes_text(needed), bytes_text(free), levels ? ": " + levels(free) : ""));
}

}  // namespace greenloop::offline
