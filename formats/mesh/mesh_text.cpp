#include "formats/mesh/mesh_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "formats/output/output_file.hpp"

namespace greenloop {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token.front() == '+' && token[1] != '-') {
    token.remove_prefix(1);
  }
  return token;
}

std::string kind_of(std::filesystem::file_type type) {
  switch (type) {
    case std::filesystem::file_type::directory:
      return "a folder";
    case std::filesystem::file_type::fifo:
      return "a pipe";
    default:
      return "a device or socket";
  }
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Fortran writes 1.0D+00.
std::string with_e(std::string_view digits) {
  std::string text(digits);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  return text;
}

std::optional<double> parse_real(std::string_view digits) {
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size()) {
    const bool fortran = end != digits.data() && lower(*end) == 'd';
    return fortran ? parse_real(with_e(digits)) : std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    value = std::strtod(std::string(digits).c_str(), nullptr);
  } else if (error != std::errc{}) {
    return std::nullopt;
  }
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
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
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw MeshFileError(file.string() + ": no such file");
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw MeshFileError(file.string() + ": found " + kind_of(status.type()) + ", expected a file");
  }
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > largest_mesh_file) {
    throw MeshFileError(file.string() + ": found " + (error ? "no length" : std::to_string(size) + " bytes") +
                        ", expected at most " + std::to_string(largest_mesh_file) + "; decimate the mesh");
  }
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream) {
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
  std::transform(extension.begin(), extension.end(), extension.begin(), lower);
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

bool NodeNumbers::add(std::int64_t number) {
  const auto place = static_cast<int>(rising_.size() + others_.size());
  if (rising_.empty() || rising_.back().first < number) {
    rising_.emplace_back(number, place);
    return true;
  }
  return !find(number) && others_.emplace(number, place).second;
}

std::optional<int> NodeNumbers::find(std::int64_t number) const {
  const auto at = std::lower_bound(rising_.begin(), rising_.end(), std::pair(number, 0));
  if (at != rising_.end() && at->first == number) return at->second;
  const auto other = others_.find(number);
  return other == others_.end() ? std::nullopt : std::optional<int>(other->second);
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

MeshText::MeshText(std::filesystem::path file, std::string content, char comment, bool continued)
    : file_(std::move(file)), content_(std::move(content)), comment_(comment), continued_(continued) {
  if (content_.starts_with("\xff\xfe") || content_.starts_with("\xfe\xff")) {
    fail("text in UTF-16", "UTF-8; save the file in that encoding");
  }
  position_ = content_.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  const auto first_end = content_.find_first_of("\r\n");
  returns_only_ = first_end != std::string::npos && content_[first_end] == '\r' &&
                  !content_.substr(first_end + 1, 1).starts_with('\n');
}

// CR before LF is white space, and LF ends that line
bool MeshText::ends_line(std::size_t at) const {
  return content_[at] == '\n' ||
         (content_[at] == '\r' && (returns_only_ || at + 1 == content_.size() || content_[at + 1] != '\n'));
}

std::size_t MeshText::length_of_continuation(std::size_t at) const {
  if (!continued_ || content_[at] != '\\') {
    return 0;
  }
  auto end = at + 1;
  while (end < content_.size() && !ends_line(end) && is_blank(content_[end])) {
    ++end;
  }
  return end < content_.size() && ends_line(end) ? end + 1 - at : 0;
}

void MeshText::skip_space(bool across_lines) {
  while (position_ < content_.size()) {
    const char c = content_[position_];
    if (comment_ != '\0' && c == comment_) {
      while (position_ < content_.size() && !ends_line(position_)) {
        ++position_;
      }
    } else if (ends_line(position_)) {
      if (!across_lines) {
        return;
      }
      ++line_;
      ++position_;
    } else if (const auto continuation = length_of_continuation(position_); continuation > 0) {
      ++line_;
      position_ += continuation;
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
  return position_ < content_.size() && !ends_line(position_);
}

void MeshText::skip_line() {
  while (continued_ && more_on_line()) {
    static_cast<void>(token(""));
  }
  static_cast<void>(line());
}

std::string_view MeshText::line() {
  token_line_ = line_;
  const auto begin = position_;
  auto end = begin;
  while (end < content_.size() && !ends_line(end)) {
    ++end;
  }
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
         (comment_ == '\0' || content_[end] != comment_) && length_of_continuation(end) == 0) {
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
  if (!same_word(found, expected)) {
    fail(found, in_quotes(expected));
  }
}

double MeshText::real(std::string_view expected) {
  const auto found = token(expected);
  const auto value = parse_real(without_plus(found));
  if (!value) {
    fail(found, std::string(expected) + " (a finite number)");
  }
  return *value;
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

std::string_view MeshText::bytes(std::size_t count, std::string_view expected) {
  token_line_ = line_;
  if (count > content_.size() - position_) {
    fail(std::to_string(content_.size() - position_) + " bytes",
         std::to_string(count) + " bytes of " + std::string(expected));
  }
  const auto found = std::string_view(content_).substr(position_, count);
  position_ += count;
  return found;
}

std::size_t MeshText::filled_lines_left(std::size_t enough) const {
  std::size_t lines = 0;
  bool filled = false, in_comment = false;
  for (auto at = position_; at < content_.size() && lines < enough; ++at) {
    if (ends_line(at)) {
      lines += filled ? 1 : 0;
      filled = in_comment = false;
    } else {
      in_comment = in_comment || (comment_ != '\0' && content_[at] == comment_);
      filled = filled || !(in_comment || is_blank(content_[at]));
    }
  }
  return lines + (filled ? 1 : 0);
}

void MeshText::note_rest(MeshNotes& notes, std::string_view item) {
  const auto left = at_end() ? std::string_view{} : rest();
  if (left.find_first_not_of(std::string_view("\0\x1a\r\n\t ", 6)) != std::string_view::npos) {
    notes.push_back(file_.string() + ": " + std::to_string(left.size()) + " bytes behind the last " +
                    std::string(item) + " skipped, beginning with " + in_quotes(left));
  }
}

void MeshText::fail(std::string_view found, std::string_view expected) const {
  throw MeshFileError(file_.string() + ":" + std::to_string(token_line_) + ": found " + in_quotes(found) +
                      ", expected " + std::string(expected));
}

}  // namespace greenloop
