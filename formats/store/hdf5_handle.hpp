#pragma once

#include <hdf5.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace greenloop {

/// Owns an HDF5 identifier.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close release) : id_(id), close_(release) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;

  /// Closes now; false if HDF5 says that something was lost.
  [[nodiscard]] bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

using Hdf5Shape = std::vector<hsize_t>;

/// The HDF5 type of a C++ number in memory.
template <typename Number>
hid_t hdf5_memory_type();
template <>
inline hid_t hdf5_memory_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t hdf5_memory_type<int>() {
  return H5T_NATIVE_INT;
}
template <>
inline hid_t hdf5_memory_type<unsigned char>() {
  return H5T_NATIVE_UCHAR;
}
template <>
inline hid_t hdf5_memory_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t hdf5_memory_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t hdf5_memory_type<std::uint32_t>() {
  return H5T_NATIVE_UINT32;
}

/// The little-endian HDF5 type of a C++ number in the file.
template <typename Number>
hid_t hdf5_file_type();
template <>
inline hid_t hdf5_file_type<double>() {
  return H5T_IEEE_F64LE;
}
template <>
inline hid_t hdf5_file_type<int>() {
  return H5T_STD_I32LE;
}
template <>
inline hid_t hdf5_file_type<unsigned char>() {
  return H5T_STD_U8LE;
}
template <>
inline hid_t hdf5_file_type<float>() {
  return H5T_IEEE_F32LE;
}
template <>
inline hid_t hdf5_file_type<std::int64_t>() {
  return H5T_STD_I64LE;
}
template <>
inline hid_t hdf5_file_type<std::uint32_t>() {
  return H5T_STD_U32LE;
}

}  // namespace greenloop
