#include "offline/scene/spelling.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <vector>

namespace greenloop::offline {
namespace {

constexpr int full_change = 2;
constexpr int case_change = 1;

int change_cost(char a, char b) {
  if (a == b) {
    return 0;
  }
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return lower(a) == lower(b) ? case_change : full_change;
}

/// Edit distance (insertions, deletions, changes) in halves of a letter.
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = full_change * static_cast<int>(j);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0];
    row[0] += full_change;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int changed = diagonal + change_cost(a[i], b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, diagonal + full_change, row[j] + full_change});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string_view nearest_spelling(std::string_view word, std::span<const std::string_view> valid) {
  std::string_view nearest;
  int fewest = static_cast<int>(word.size()) + 1;  // half of the word, in halves of a letter
  for (const auto candidate : valid) {
    const int distance = edit_distance(word, candidate);
    if (distance < fewest) {
      fewest = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> valid) {
  const auto nearest = nearest_spelling(word, valid);
  return nearest.empty() ? "" : " (did you mean \"" + std::string(nearest) + "\"?)";
}

std::string comma_list(std::span<const std::string_view> words) {
  std::string text;
  for (const auto word : words) {
    text += (text.empty() ? "" : ", ") + std::string(word);
  }
  return text;
}

}  // namespace greenloop::offline
