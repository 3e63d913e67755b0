#include "formats/mesh/mesh_text.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "formats/output/output_file.hpp"

namespace greenloop {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token.front() == '+' && token[1] != '-') {
    token.remove_prefix(1);
  }
  return token;
}

template <typename T>
void append(std::string& text, T value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), result.ptr);
}

}  // namespace

std::string read_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw MeshFileError(file.string() + ": no such file");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(stream), {});
  if (!stream.good() && !stream.eof()) {
    throw MeshFileError(file.string() + ": cannot be read");
  }
  return bytes;
}

void write_file(const std::filesystem::path& file, std::string_view bytes) try {
  write_text_file(file, bytes);
} catch (const std::runtime_error& error) {
  throw MeshFileError(error.what());
}

std::string lower_extension(const std::filesystem::path& file) {
  auto extension = file.extension().string();
  for (char& c : extension) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return extension;
}

void refuse_extension(const std::filesystem::path& file, const std::string& expected) {
  throw MeshFileError(file.string() + ": found extension " + in_quotes(file.extension().string()) + ", expected " +
                      expected);
}

void append_number(std::string& text, double value) { append(text, value); }
void append_number(std::string& text, std::int64_t value) { append(text, value); }

void append_point(std::string& text, const Eigen::Vector3d& point) {
  append(text, point.x());
  text += ' ';
  append(text, point.y());
  text += ' ';
  append(text, point.z());
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, longest)) {
    result += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
  }
  return result + (text.size() > longest ? "...\"" : "\"");
}

std::optional<int> NodeNumbers::find(std::int64_t number) const {
  const auto it = index_.find(number);
  return it == index_.end() ? std::nullopt : std::optional<int>(it->second);
}

MeshText::MeshText(std::filesystem::path file, std::string content, char comment)
    : file_(std::move(file)), content_(std::move(content)), comment_(comment) {}

void MeshText::skip_space(bool across_lines) {
  while (position_ < content_.size()) {
    const char c = content_[position_];
    if (comment_ != '\0' && c == comment_) {
      while (position_ < content_.size() && content_[position_] != '\n') {
        ++position_;
      }
    } else if (c == '\n' && across_lines) {
      ++line_;
      ++position_;
    } else if (is_blank(c)) {
      ++position_;
    } else {
      return;
    }
  }
}

bool MeshText::at_end() {
  skip_space(true);
  return position_ == content_.size();
}

bool MeshText::more_on_line() {
  skip_space(false);
  return position_ < content_.size() && content_[position_] != '\n';
}

void MeshText::skip_line() { static_cast<void>(line()); }

std::string_view MeshText::line() {
  token_line_ = line_;
  const auto begin = position_;
  const auto end = std::min(content_.find('\n', begin), content_.size());
  position_ = std::min(end + 1, content_.size());
  line_ += end < content_.size() ? 1 : 0;
  auto text = std::string_view(content_).substr(begin, end - begin);
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

std::string_view MeshText::peek() {
  if (at_end()) {
    return {};
  }
  auto end = position_;
  while (end < content_.size() && content_[end] != '\n' && !is_blank(content_[end]) &&
         (comment_ == '\0' || content_[end] != comment_)) {
    ++end;
  }
  return std::string_view(content_).substr(position_, end - position_);
}

std::string_view MeshText::token(std::string_view expected) {
  const auto found = peek();
  token_line_ = line_;
  if (found.empty()) {
    throw MeshFileError(file_.string() + ":" + std::to_string(line_) + ": found the end of the file, expected " +
                        std::string(expected));
  }
  position_ += found.size();
  return found;
}

void MeshText::word(std::string_view expected) {
  const auto found = token(in_quotes(expected));
  if (found != expected) {
    fail(found, in_quotes(expected));
  }
}

double MeshText::real(std::string_view expected) {
  const auto found = token(expected);
  const auto digits = without_plus(found);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    fail(found, std::string(expected) + " (a finite number)");
  }
  return value;
}

std::int64_t MeshText::integer(std::string_view expected, std::int64_t low, std::int64_t high) {
  const auto found = token(expected);
  const auto digits = without_plus(found);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || value < low || value > high) {
    const auto range =
        high < low ? std::string("but there are none") : "from " + std::to_string(low) + " to " + std::to_string(high);
    fail(found, std::string(expected) + " (a whole number, " + range + ")");
  }
  return value;
}

std::size_t MeshText::count(std::string_view expected, std::size_t bytes_each) {
  const auto value = static_cast<std::size_t>(integer(expected, 0, largest_index));
  const auto left = content_.size() - position_;
  if (value > (left + 1) / bytes_each) {
    fail(std::to_string(value),
         std::string(expected) + " that fits the " + std::to_string(left) + " bytes left in the file");
  }
  return value;
}

Eigen::Vector3d MeshText::point() {
  const double x = real("the x coordinate of a vertex");
  const double y = real("the y coordinate of a vertex");
  const double z = real("the z coordinate of a vertex");
  return {x, y, z};
}

void MeshText::skip_bytes(std::size_t bytes) {
  const auto end = position_ + std::min(bytes, content_.size() - position_);
  for (; position_ < end; ++position_) {
    line_ += content_[position_] == '\n' ? 1 : 0;
  }
  token_line_ = line_;
}

void MeshText::fail(std::string_view found, std::string_view expected) const {
  throw MeshFileError(file_.string() + ":" + std::to_string(token_line_) + ": found " + in_quotes(found) +
                      ", expected " + std::string(expected));
}

}  // namespace greenloop
