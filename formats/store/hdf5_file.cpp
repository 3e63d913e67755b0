#include "formats/store/hdf5_file.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include "formats/store/hdf5_fault.hpp"

namespace greenloop {
namespace {

std::size_t product(const Hdf5Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

Hdf5Handle space_of(const Hdf5Shape& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

/// Selects a box of the dataset; an empty handle when it lies outside.
Hdf5Handle box_of(hid_t dataset, const Hdf5Shape& start, const Hdf5Shape& count) {
  Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if (H5Sget_simple_extent_ndims(space.get()) != static_cast<int>(start.size()) ||
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Sselect_valid(space.get()) <= 0) {
    return {};
  }
  return space;
}

}  // namespace

void Hdf5File::fail(std::string_view object, std::string_view what) const {
  throw std::runtime_error(path_.string() + ": " + std::string(object) + ": " + std::string(what));
}

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  start_hdf5();
  const Hdf5Silence silence;
  Hdf5Handle handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (!handle) throw std::runtime_error(open_fault(path, hdf5_fault()));
  return {std::move(handle), path};
}

Hdf5File Hdf5File::open(const std::filesystem::path& path, bool writable) {
  start_hdf5();
  const Hdf5Silence silence;
  if (!std::filesystem::exists(path)) throw std::runtime_error(path.string() + ": there is no such file");
  Hdf5Handle handle(H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!handle) throw std::runtime_error(open_fault(path, hdf5_fault()));
  return {std::move(handle), path};
}

Hdf5Handle Hdf5File::dataset(const std::string& name) const {
  const Hdf5Silence silence;
  Hdf5Handle id(H5Dopen2(handle_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!id) fail(name, "the dataset is missing; see docs/store.md for what a store holds");
  return id;
}

Hdf5Handle Hdf5File::object(const std::string& name) const {
  const Hdf5Silence silence;
  Hdf5Handle id(H5Oopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!id) fail(name, "is missing; see docs/store.md for what a store holds");
  return id;
}

Hdf5Handle Hdf5File::attribute(const std::string& object_name, const std::string& name) const {
  const auto owner = object(object_name);
  const Hdf5Silence silence;
  Hdf5Handle id(H5Aopen(owner.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!id) fail(object_name, "the attribute '" + name + "' is missing; see docs/store.md");
  return id;
}

void Hdf5File::make_group(const std::string& name) {
  const Hdf5Handle id(H5Gcreate2(handle_.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (!id) fail(name, "the group cannot be created");
}

void Hdf5File::write_text(const std::string& object_name, const std::string& name, const std::string& value) {
  const auto owner = object(object_name);
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type.get(), value.size() + 1);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const Hdf5Handle id(H5Acreate2(owner.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  if (!id || H5Awrite(id.get(), type.get(), value.c_str()) < 0) {
    fail(object_name, "the attribute '" + name + "' cannot be written (texts are limited to 64 kB)");
  }
}

std::string Hdf5File::read_text(const std::string& object_name, const std::string& name) const {
  const auto id = attribute(object_name, name);
  const Hdf5Handle type(H5Aget_type(id.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING) fail(object_name, "the attribute '" + name + "' is not a text");
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    if (H5Aread(id.get(), type.get(), &text) < 0) fail(object_name, "the attribute '" + name + "' cannot be read");
    std::string value(text != nullptr ? text : "");
    H5free_memory(text);
    return value;
  }
  std::string value(H5Tget_size(type.get()), '\0');
  if (H5Aread(id.get(), type.get(), value.data()) < 0) fail(object_name, "the attribute '" + name + "' cannot be read");
  value.resize(std::min(value.find('\0'), value.size()));
  return value;
}

void Hdf5File::write_number(const std::string& object_name, const std::string& name, double value) {
  const auto owner = object(object_name);
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle id(H5Acreate2(owner.get(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  if (!id || H5Awrite(id.get(), H5T_NATIVE_DOUBLE, &value) < 0) {
    fail(object_name, "the attribute '" + name + "' cannot be written");
  }
}

double Hdf5File::read_number(const std::string& object_name, const std::string& name) const {
  const auto id = attribute(object_name, name);
  const Hdf5Silence silence;
  const Hdf5Handle space(H5Aget_space(id.get()), H5Sclose);
  double value = 0.0;
  if (H5Sget_simple_extent_npoints(space.get()) != 1 || H5Aread(id.get(), H5T_NATIVE_DOUBLE, &value) < 0) {
    fail(object_name, "the attribute '" + name + "' is not one number");
  }
  return value;
}

template <typename Number>
void Hdf5File::reserve(const std::string& name, const Hdf5Shape& shape) {
  const Hdf5Handle space = space_of(shape), plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_alloc_time(plist.get(), H5D_ALLOC_TIME_EARLY);
  // the file system's zeros do; writing them would cost as much as the columns
  H5Pset_fill_time(plist.get(), H5D_FILL_TIME_NEVER);
  const Hdf5Silence silence;
  const Hdf5Handle id(H5Dcreate2(handle_.get(), name.c_str(), hdf5_file_type<Number>(), space.get(), H5P_DEFAULT,
                                 plist.get(), H5P_DEFAULT),
                      H5Dclose);
  if (!id) fail(name, "the dataset cannot be created; is the disk full?");
}

template <typename Number>
void Hdf5File::write(const std::string& name, const Hdf5Shape& shape, const std::vector<Number>& values) {
  if (product(shape) != values.size()) fail(name, "the number of values differs from its shape");
  reserve<Number>(name, shape);
  if (!values.empty()) write_part(name, Hdf5Shape(shape.size(), 0), shape, values.data());
}

template <typename Number>
std::vector<Number> Hdf5File::read(const std::string& name, Hdf5Shape& extent) const {
  extent = shape(name);
  std::vector<Number> values(product(extent));
  if (!values.empty()) read_part(name, Hdf5Shape(extent.size(), 0), extent, values.data());
  return values;
}

template <typename Number>
void Hdf5File::write_part(const std::string& name, const Hdf5Shape& start, const Hdf5Shape& count,
                          const Number* values) {
  const auto id = dataset(name);
  const Hdf5Silence silence;
  const Hdf5Handle target = box_of(id.get(), start, count), source = space_of(count);
  if (!target) fail(name, "the part to write lies outside the dataset");
  if (H5Dwrite(id.get(), hdf5_memory_type<Number>(), source.get(), target.get(), H5P_DEFAULT, values) < 0) {
    fail(name, "cannot be written; is the disk full, or was the store opened read-only?");
  }
}

template <typename Number>
void Hdf5File::read_part(const std::string& name, const Hdf5Shape& start, const Hdf5Shape& count,
                         Number* values) const {
  const auto id = dataset(name);
  require_number_type(name, id.get(), hdf5_memory_type<Number>());
  const Hdf5Silence silence;
  const Hdf5Handle source = box_of(id.get(), start, count), target = space_of(count);
  if (!source) fail(name, "the part to read lies outside the dataset");
  if (H5Dread(id.get(), hdf5_memory_type<Number>(), target.get(), source.get(), H5P_DEFAULT, values) < 0) {
    fail(name, "cannot be read; the file is damaged or truncated");
  }
}

void Hdf5File::require_number_type(const std::string& name, hid_t id, hid_t expected) const {
  const Hdf5Handle type(H5Dget_type(id), H5Tclose);
  if (H5Tget_class(type.get()) != H5Tget_class(expected)) {
    fail(name, H5Tget_class(expected) == H5T_FLOAT ? "must hold floating point numbers" : "must hold integers");
  }
}

bool Hdf5File::has(const std::string& name) const {
  const Hdf5Silence silence;
  const Hdf5Handle id(H5Oopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  return static_cast<bool>(id);
}

Hdf5Shape Hdf5File::shape(const std::string& name) const {
  const auto id = dataset(name);
  const Hdf5Handle space(H5Dget_space(id.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) fail(name, "has no simple shape");
  Hdf5Shape extent(rank);
  H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
  return extent;
}

void Hdf5File::flush() {
  if (H5Fflush(handle_.get(), H5F_SCOPE_GLOBAL) < 0)
    fail("file", "cannot be written: " + hdf5_fault() + "; make room there, or name a file on another disk");
}

#define GREENLOOP_INSTANTIATE(Number)                                                                      \
  template void Hdf5File::reserve<Number>(const std::string&, const Hdf5Shape&);                           \
  template void Hdf5File::write<Number>(const std::string&, const Hdf5Shape&, const std::vector<Number>&); \
  template std::vector<Number> Hdf5File::read<Number>(const std::string&, Hdf5Shape&) const;               \
  template void Hdf5File::write_part<Number>(const std::string&, const Hdf5Shape&, const Hdf5Shape&,       \
                                             std::add_pointer_t<const Number>);                            \
  template void Hdf5File::read_part<Number>(const std::string&, const Hdf5Shape&, const Hdf5Shape&,        \
                                            std::add_pointer_t<Number>) const;
GREENLOOP_INSTANTIATE(double)
GREENLOOP_INSTANTIATE(int)
GREENLOOP_INSTANTIATE(unsigned char)
#undef GREENLOOP_INSTANTIATE

}  // namespace greenloop
