#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace greenloop {

/// A mesh file that cannot be read or written. The message names file, line, what was found and what was expected.
class MeshFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a reader passed over, one sentence each with the file's name, for people.
using MeshNotes = std::vector<std::string>;

/// Longest mesh file that is read [bytes].
inline constexpr std::uint64_t largest_mesh_file = std::uint64_t{1} << 31;

/// The bytes of a regular file of at most largest_mesh_file bytes. Throws MeshFileError, before anything is read, for a
/// folder, a pipe, a device and a file that is longer, and if it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& file);

/// As write_text_file. Throws MeshFileError.
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// The extension in lower case with its dot, "" if none.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& file);

/// Throws MeshFileError: the extension found, and the kind of file expected.
[[noreturn]] void refuse_extension(const std::filesystem::path& file, const std::string& expected);

/// Appends the shortest decimal form that reads back as the same double.
void append_number(std::string& text, double value);
void append_number(std::string& text, std::int64_t value);

/// Appends "x y z".
void append_point(std::string& text, const Eigen::Vector3d& point);

/// True if the words differ in the case of ASCII letters only.
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);

/// Reads white-space separated tokens of a text file and knows the line it is on. Lines end with LF, CR LF or CR; a
/// byte order mark is skipped. Every reading function throws MeshFileError with file, line, the token found and what
/// was expected; none reads past the end.
class MeshText {
 public:
  /// comment: from this character to the end of a line is skipped ('\0': there are no comments).
  /// continued: a backslash at the end of a line joins the next one to it.
  /// Throws MeshFileError for text in UTF-16.
  MeshText(std::filesystem::path file, std::string content, char comment, bool continued = false);

  /// Skips white space and comments; true if no token is left.
  [[nodiscard]] bool at_end();
  /// True if another token stands on the current line.
  [[nodiscard]] bool more_on_line();
  /// Goes to the beginning of the next line.
  void skip_line();
  /// What is left of the current line, without its end; goes to the next line.
  [[nodiscard]] std::string_view line();

  /// The next token; views stay valid as long as this object.
  [[nodiscard]] std::string_view token(std::string_view expected);
  /// The next token without taking it, "" at the end of the file.
  [[nodiscard]] std::string_view peek();
  /// Takes the next token, which has to be this word, in upper or lower case.
  void word(std::string_view expected);
  /// A finite number; one too small for a double is zero. The exponent may be written with D.
  [[nodiscard]] double real(std::string_view expected);
  /// A whole number in [low, high].
  [[nodiscard]] std::int64_t integer(std::string_view expected, std::int64_t low, std::int64_t high);
  /// A number of items that each still need at least `bytes_each` bytes of this file; more than fit are refused, so
  /// that a caller may allocate what it says.
  [[nodiscard]] std::size_t count(std::string_view expected, std::size_t bytes_each);
  /// Three finite numbers.
  [[nodiscard]] Eigen::Vector3d point();

  /// Takes so many bytes as they are; throws if fewer are left.
  [[nodiscard]] std::string_view bytes(std::size_t count, std::string_view expected);
  /// Lines not read yet that hold more than white space and comments, at most `enough`.
  [[nodiscard]] std::size_t filled_lines_left(std::size_t enough) const;
  /// Notes what is left of the file behind its last `item`, if it is more than white space, comments and zeros.
  void note_rest(MeshNotes& notes, std::string_view item);

  /// Bytes not read yet.
  [[nodiscard]] std::string_view rest() const { return std::string_view(content_).substr(position_); }
  /// Goes forward by so many bytes, at most to the end, counting lines.
  void skip_bytes(std::size_t bytes);

  /// Of the token read last, from 1.
  [[nodiscard]] std::size_t line_number() const { return token_line_; }

  /// Throws for the token read last.
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;

 private:
  void skip_space(bool across_lines);
  [[nodiscard]] bool ends_line(std::size_t at) const;
  /// Of a backslash and the line end behind it; 0 if there is none.
  [[nodiscard]] std::size_t length_of_continuation(std::size_t at) const;

  std::filesystem::path file_;
  std::string content_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  std::size_t token_line_ = 1;
  char comment_;
  bool continued_;
  bool returns_only_ = false;  ///< the first line ends with CR alone
};

/// The numbers a file gives its nodes, and their order in it. Files that number from 0, from 1 or with gaps read alike.
/// Work: log n each, whatever the numbers are.
class NodeNumbers {
 public:
  void reserve(std::size_t count) { rising_.reserve(count); }
  /// False if the number is taken already.
  [[nodiscard]] bool add(std::int64_t number);
  [[nodiscard]] std::optional<int> find(std::int64_t number) const;

 private:
  std::vector<std::pair<std::int64_t, int>> rising_;  ///< as files have them, with their places
  std::map<std::int64_t, int> others_;                ///< below the last of these when they came
};

/// "quoted" form of a piece of a file for a message: unprintable bytes replaced, long ones cut.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Largest number of vertices or faces a mesh may have: indices are int.
inline constexpr std::int64_t largest_index = 2147483646;

}  // namespace greenloop
