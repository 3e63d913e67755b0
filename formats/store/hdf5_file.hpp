#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/store/hdf5_handle.hpp"

namespace greenloop {

/// An HDF5 file with typed, named datasets. Every error is a std::runtime_error that names file and dataset.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path);
  static Hdf5File open(const std::filesystem::path& path, bool writable);

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
  [[nodiscard]] Hdf5Shape shape(const std::string& dataset) const;
  void flush();

  /// Throws std::runtime_error("<path>: <object>: <what>").
  [[noreturn]] void fail(std::string_view object, std::string_view what) const;

 private:
  Hdf5File(Hdf5Handle handle, std::filesystem::path path) : handle_(std::move(handle)), path_(std::move(path)) {}
  [[nodiscard]] Hdf5Handle dataset(const std::string& name) const;
  [[nodiscard]] Hdf5Handle object(const std::string& name) const;
  [[nodiscard]] Hdf5Handle attribute(const std::string& object, const std::string& name) const;
  void require_number_type(const std::string& dataset, hid_t id, hid_t expected) const;

  Hdf5Handle handle_;
  std::filesystem::path path_;
};

}  // namespace greenloop
