#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/store/hdf5_handle.hpp"

namespace greenloop {

/// Texts in attributes have at most so many bytes.
inline constexpr std::size_t kMostTextBytes = std::size_t{1} << 16;

/// A dataset that is read as a whole has at most so many numbers.
inline constexpr hsize_t kMostNumbers = hsize_t{1} << 27;

/// An HDF5 file with typed, named datasets. Every error is a std::runtime_error that names file and dataset.
///
/// A file from outside is not believed: whatever is opened must stand in this file under hard links, once; a dataset
/// must be contiguous or compact, without filters, of a plain kind of number, and all of its values must lie within the
/// file. So nothing is written elsewhere, and what is allocated is bounded by the length of the file. Attributes are
/// one number or one text of fixed length (those of variable length are read unchecked by the library).
class Hdf5File {
 public:
  /// `document` is what messages refer to for what the file should hold.
  static Hdf5File create(const std::filesystem::path& path, const char* document = "docs/store.md");
  static Hdf5File open(const std::filesystem::path& path, bool writable, const char* document = "docs/store.md");

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void renamed(const std::filesystem::path& path) { path_ = path; }

  void make_group(const std::string& name);
  void write_text(const std::string& object, const std::string& attribute, const std::string& value);
  [[nodiscard]] std::string read_text(const std::string& object, const std::string& attribute) const;
  void write_number(const std::string& object, const std::string& attribute, double value);
  [[nodiscard]] double read_number(const std::string& object, const std::string& attribute) const;

  /// A dataset whose space is reserved at once, so that later writes touch no metadata; zero until written.
  template <typename Number>
  void reserve(const std::string& dataset, const Hdf5Shape& shape);
  template <typename Number>
  void write(const std::string& dataset, const Hdf5Shape& shape, const std::vector<Number>& values);

  /// The whole dataset; its shape goes to `shape`. Throws when missing or of another kind of number.
  template <typename Number>
  [[nodiscard]] std::vector<Number> read(const std::string& dataset, Hdf5Shape& shape) const;
  template <typename Number>
  void write_part(const std::string& dataset, const Hdf5Shape& start, const Hdf5Shape& count, const Number* values);
  template <typename Number>
  void read_part(const std::string& dataset, const Hdf5Shape& start, const Hdf5Shape& count, Number* values) const;

  [[nodiscard]] bool has(const std::string& dataset) const;
  [[nodiscard]] bool has_attribute(const std::string& object, const std::string& attribute) const;
  [[nodiscard]] Hdf5Shape shape(const std::string& dataset) const;
  /// Throws unless numbers of 64-bit floating point stand there: what is written is what is read.
  void require_exact(const std::string& dataset) const;
  /// Throws if two of the datasets share bytes of the file.
  void require_apart(const std::vector<std::string>& datasets) const;
  void flush();
  /// Throws if something was lost. Nothing else may be called afterwards.
  void close();

  /// Throws std::runtime_error("<path>: <object>: <what>").
  [[noreturn]] void fail(std::string_view object, std::string_view what) const;

 private:
  Hdf5File(Hdf5Handle handle, std::filesystem::path path, const char* document)
      : handle_(std::move(handle)), path_(std::move(path)), document_(document) {}
  [[nodiscard]] Hdf5Handle dataset(const std::string& name) const;
  [[nodiscard]] Hdf5Handle object(const std::string& name) const;
  [[nodiscard]] Hdf5Handle attribute(const std::string& object, const std::string& name) const;
  [[nodiscard]] bool has_link(const std::string& name) const;
  void require_inside(const std::string& dataset, hid_t id) const;
  void close(Hdf5Handle& handle, const std::string& object) const;

  Hdf5Handle handle_;
  std::filesystem::path path_;  // for messages, and for the length of the file
  std::string document_;
};

}  // namespace greenloop
