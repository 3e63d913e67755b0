#include "formats/write/nested_json.hpp"

#include <fmt/format.h>

#include <span>
#include <stdexcept>

#include "formats/verify/nesting.hpp"

namespace greenloop {
namespace {

std::size_t too_deep_at(std::string_view text) {
  return first_nested_deeper(std::as_bytes(std::span(text)), most_nesting);
}

}  // namespace

bool is_shallow(std::string_view text) { return too_deep_at(text) == text.size(); }

void require_shallow(std::string_view text, std::string_view what) {
  if (is_shallow(text)) return;
  throw std::runtime_error(fmt::format("{}: byte {} opens more than {} levels of brackets; JSON is taken up to there",
                                       what, too_deep_at(text), most_nesting));
}

}  // namespace greenloop
