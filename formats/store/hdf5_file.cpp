#include "formats/store/hdf5_file.hpp"

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include "formats/store/hdf5_fault.hpp"

namespace greenloop {
namespace {

std::size_t product(const Hdf5Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

Hdf5Shape shape_of(hid_t dataset) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  Hdf5Shape extent(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space.get()), 0)));
  if (!extent.empty()) H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
  return extent;
}

/// Whether a box of this shape has exactly so many elements, whatever the shape.
bool has_elements(const Hdf5Shape& shape, hsize_t count) {
  if (std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end()) return count == 0;
  hsize_t elements = 1;
  for (const hsize_t extent : shape) {
    if (extent > count / elements) return false;
    elements *= extent;
  }
  return elements == count;
}

bool is_one_of(hid_t type, std::initializer_list<hid_t> types) {
  return std::any_of(types.begin(), types.end(), [&](hid_t plain) { return H5Tequal(type, plain) > 0; });
}

bool is_plain_float(hid_t type) {
  return is_one_of(type, {H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_IEEE_F32LE, H5T_IEEE_F32BE});
}

bool is_plain_integer(hid_t type) {
  return is_one_of(type, {H5T_STD_I32LE, H5T_STD_U8LE, H5T_STD_I64LE, H5T_STD_U32LE, H5T_STD_U64LE, H5T_STD_I8LE,
                          H5T_STD_I16LE, H5T_STD_U16LE, H5T_STD_I32BE, H5T_STD_U8BE, H5T_STD_I64BE, H5T_STD_U32BE,
                          H5T_STD_U64BE, H5T_STD_I8BE, H5T_STD_I16BE, H5T_STD_U16BE});
}

/// What is wrong with where a dataset keeps its values; empty if nothing.
std::string storage_fault(hid_t dataset) {
  const Hdf5Handle plist(H5Dget_create_plist(dataset), H5Pclose);
  if (!plist) return "its properties cannot be read";
  if (H5Pget_external_count(plist.get()) != 0) return "its values stand in other files (external storage)";
  if (H5Pget_nfilters(plist.get()) != 0) return "its values pass a filter";
  switch (H5Pget_layout(plist.get())) {
    case H5D_CONTIGUOUS:
    case H5D_COMPACT:
      return {};
    case H5D_CHUNKED:
      return "its values are chunked";
    case H5D_VIRTUAL:
      return "its values are those of other datasets (a virtual dataset)";
    default:
      return "its layout is unknown";
  }
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

Hdf5File Hdf5File::create(const std::filesystem::path& path, const char* document) {
  start_hdf5();
  Hdf5Handle handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (!handle) throw std::runtime_error(open_fault(path, hdf5_fault()));
  return {std::move(handle), path, document};
}

Hdf5File Hdf5File::open(const std::filesystem::path& path, bool writable, const char* document) {
  start_hdf5();
  if (!std::filesystem::exists(path)) throw std::runtime_error(path.string() + ": there is no such file");
  Hdf5Handle handle(H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!handle) throw std::runtime_error(open_fault(path, hdf5_fault()));
  return {std::move(handle), path, document};
}

// Link by link, so that none is followed before it is known to stay in the file.
bool Hdf5File::has_link(const std::string& name) const {
  for (std::size_t end = name.find('/', 1); name.size() > 1; end = name.find('/', end + 1)) {
    const std::string part = name.substr(0, end);
    H5L_info_t link{};
    if (H5Lexists(handle_.get(), part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (H5Lget_info(handle_.get(), part.c_str(), &link, H5P_DEFAULT) < 0) fail(part, "cannot be read");
    if (link.type != H5L_TYPE_HARD) {
      fail(part, link.type == H5L_TYPE_EXTERNAL ? "is a link to another file; copy what it names into this file"
                                                : "is a link; put what it names in its place");
    }
    if (end == std::string::npos) break;
    const Hdf5Handle group(H5Oopen(handle_.get(), part.c_str(), H5P_DEFAULT), H5Oclose);
    if (!group || H5Iget_type(group.get()) != H5I_GROUP) return false;
  }
  return true;
}

Hdf5Handle Hdf5File::dataset(const std::string& name) const {
  if (!has_link(name)) fail(name, "the dataset is missing; see " + document_ + " for what belongs there");
  Hdf5Handle id(H5Dopen2(handle_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!id) fail(name, "is no dataset that can be read; see " + document_ + " for what belongs there");
  H5O_info_t info{};
  if (H5Oget_info2(id.get(), &info, H5O_INFO_BASIC) < 0) fail(name, "cannot be read; the file is damaged");
  if (info.rc != 1) fail(name, "stands under several names; copy it so that each has its own");
  const std::string fault = storage_fault(id.get());
  if (!fault.empty()) fail(name, fault + "; store it contiguous in this file, without filters");
  require_inside(name, id.get());
  return id;
}

void Hdf5File::require_inside(const std::string& name, hid_t id) const {
  const Hdf5Handle type(H5Dget_type(id), H5Tclose), space(H5Dget_space(id), H5Sclose);
  if (H5Tcommitted(type.get()) != 0) fail(name, "its type is a committed one; give it a type of its own");
  if (!is_plain_float(type.get()) && !is_plain_integer(type.get())) {
    fail(name, "must hold floating point numbers or integers of 8, 16, 32 or 64 bits");
  }
  if (H5Sget_simple_extent_type(space.get()) != H5S_SIMPLE) fail(name, "has no shape");
  const hsize_t bytes = H5Dget_storage_size(id), width = H5Tget_size(type.get());
  if (bytes % width != 0 || !has_elements(shape_of(id), bytes / width)) {
    fail(name, "its shape asks for other values than the " + std::to_string(bytes) + " bytes that are stored");
  }
  const haddr_t offset = H5Dget_offset(id);
  if (bytes == 0 || offset == HADDR_UNDEF) return;  // nothing, or within the metadata
  const hsize_t length = std::filesystem::file_size(path_);
  if (offset > length || bytes > length - offset) {
    fail(name, "its values lie beyond the end of the file, which is truncated or damaged");
  }
}

Hdf5Handle Hdf5File::object(const std::string& name) const {
  if (!has_link(name)) fail(name, "is missing; see " + document_ + " for what belongs there");
  Hdf5Handle id(H5Oopen(handle_.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!id) fail(name, "is missing; see " + document_ + " for what belongs there");
  return id;
}

Hdf5Handle Hdf5File::attribute(const std::string& object_name, const std::string& name) const {
  const auto owner = object(object_name);
  Hdf5Handle id(H5Aopen(owner.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!id) fail(object_name, "the attribute '" + name + "' is missing; see " + document_);
  const Hdf5Handle space(H5Aget_space(id.get()), H5Sclose), type(H5Aget_type(id.get()), H5Tclose);
  if (H5Sget_simple_extent_npoints(space.get()) != 1) {
    fail(object_name, "the attribute '" + name + "' is not one value");
  }
  if (H5Tcommitted(type.get()) != 0) fail(object_name, "the attribute '" + name + "' has a committed type");
  return id;
}

bool Hdf5File::has_attribute(const std::string& object_name, const std::string& name) const {
  return H5Aexists(object(object_name).get(), name.c_str()) > 0;
}

void Hdf5File::close(Hdf5Handle& handle, const std::string& name) const {
  if (!handle.close()) fail(name, "cannot be written to its end; is the disk full?");
}

void Hdf5File::make_group(const std::string& name) {
  Hdf5Handle id(H5Gcreate2(handle_.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (!id) fail(name, "the group cannot be created");
  close(id, name);
}

void Hdf5File::write_text(const std::string& object_name, const std::string& name, const std::string& value) {
  if (value.size() >= kMostTextBytes) {
    fail(object_name, "the attribute '" + name + "' cannot be written: texts are limited to 64 kB");
  }
  auto owner = object(object_name);
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type.get(), value.size() + 1);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  Hdf5Handle id(H5Acreate2(owner.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!id || H5Awrite(id.get(), type.get(), value.c_str()) < 0) {
    fail(object_name, "the attribute '" + name + "' cannot be written (texts are limited to 64 kB)");
  }
  close(id, object_name);
  close(owner, object_name);
}

std::string Hdf5File::read_text(const std::string& object_name, const std::string& name) const {
  const auto id = attribute(object_name, name);
  const Hdf5Handle type(H5Aget_type(id.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING) fail(object_name, "the attribute '" + name + "' is not a text");
  if (H5Tis_variable_str(type.get()) != 0) {
    fail(object_name, "the attribute '" + name +
                          "' is a text of variable length; write one of fixed length (h5py: "
                          "numpy.bytes_(text))");
  }
  const std::size_t size = H5Tget_size(type.get());
  if (size > kMostTextBytes || size != H5Aget_storage_size(id.get())) {
    fail(object_name, "the attribute '" + name + "' has more than 64 kB");
  }
  std::string value(size, '\0');
  if (H5Aread(id.get(), type.get(), value.data()) < 0) fail(object_name, "the attribute '" + name + "' cannot be read");
  value.resize(std::min(value.find('\0'), value.size()));
  return value;
}

void Hdf5File::write_number(const std::string& object_name, const std::string& name, double value) {
  auto owner = object(object_name);
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  Hdf5Handle id(H5Acreate2(owner.get(), name.c_str(), H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!id || H5Awrite(id.get(), H5T_NATIVE_DOUBLE, &value) < 0) {
    fail(object_name, "the attribute '" + name + "' cannot be written");
  }
  close(id, object_name);
  close(owner, object_name);
}

double Hdf5File::read_number(const std::string& object_name, const std::string& name) const {
  const auto id = attribute(object_name, name);
  const Hdf5Handle type(H5Aget_type(id.get()), H5Tclose);
  double value = 0.0;
  if ((!is_plain_float(type.get()) && !is_plain_integer(type.get())) ||
      H5Aread(id.get(), H5T_NATIVE_DOUBLE, &value) < 0) {
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
  Hdf5Handle id(H5Dcreate2(handle_.get(), name.c_str(), hdf5_file_type<Number>(), space.get(), H5P_DEFAULT, plist.get(),
                           H5P_DEFAULT),
                H5Dclose);
  if (!id) fail(name, "the dataset cannot be created; is the disk full?");
  close(id, name);
}

template <typename Number>
void Hdf5File::write(const std::string& name, const Hdf5Shape& shape, const std::vector<Number>& values) {
  if (product(shape) != values.size()) fail(name, "the number of values differs from its shape");
  reserve<Number>(name, shape);
  flush();  // the file gets its length: what is written must lie within it
  if (!values.empty()) write_part(name, Hdf5Shape(shape.size(), 0), shape, values.data());
}

template <typename Number>
std::vector<Number> Hdf5File::read(const std::string& name, Hdf5Shape& extent) const {
  extent = shape(name);
  if (!has_elements(extent, 0) && product(extent) > kMostNumbers) {
    fail(name, "has more than " + std::to_string(kMostNumbers) + " numbers");
  }
  std::vector<Number> values(product(extent));
  if (!values.empty()) read_part(name, Hdf5Shape(extent.size(), 0), extent, values.data());
  return values;
}

template <typename Number>
void Hdf5File::write_part(const std::string& name, const Hdf5Shape& start, const Hdf5Shape& count,
                          const Number* values) {
  auto id = dataset(name);
  const Hdf5Handle target = box_of(id.get(), start, count), source = space_of(count);
  if (!target) fail(name, "the part to write lies outside the dataset");
  if (H5Dwrite(id.get(), hdf5_memory_type<Number>(), source.get(), target.get(), H5P_DEFAULT, values) < 0) {
    fail(name, "cannot be written; is the disk full, or was the file opened read-only?");
  }
  close(id, name);  // small parts reach the file only now
}

template <typename Number>
void Hdf5File::read_part(const std::string& name, const Hdf5Shape& start, const Hdf5Shape& count,
                         Number* values) const {
  const auto id = dataset(name);
  const Hdf5Handle type(H5Dget_type(id.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5Tget_class(hdf5_memory_type<Number>())) {
    fail(name, std::is_floating_point_v<Number> ? "must hold floating point numbers" : "must hold integers");
  }
  const Hdf5Handle source = box_of(id.get(), start, count), target = space_of(count);
  if (!source) fail(name, "the part to read lies outside the dataset");
  if (H5Dread(id.get(), hdf5_memory_type<Number>(), target.get(), source.get(), H5P_DEFAULT, values) < 0) {
    fail(name, "cannot be read; the file is damaged or truncated");
  }
}

bool Hdf5File::has(const std::string& name) const { return has_link(name); }

Hdf5Shape Hdf5File::shape(const std::string& name) const { return shape_of(dataset(name).get()); }

void Hdf5File::require_exact(const std::string& name) const {
  const auto id = dataset(name);
  const Hdf5Handle type(H5Dget_type(id.get()), H5Tclose);
  if (H5Tequal(type.get(), H5T_IEEE_F64LE) <= 0) {
    fail(name, "must hold floating point numbers of 64 bits, little-endian");
  }
}

void Hdf5File::require_apart(const std::vector<std::string>& names) const {
  struct Extent {
    haddr_t begin;
    hsize_t bytes;
    const std::string* name;
  };
  std::vector<Extent> extents;
  for (const std::string& name : names) {
    if (!has(name)) continue;
    const auto id = dataset(name);
    const Extent extent{H5Dget_offset(id.get()), H5Dget_storage_size(id.get()), &name};
    if (extent.begin != HADDR_UNDEF && extent.bytes > 0) extents.push_back(extent);
  }
  std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) { return a.begin < b.begin; });
  for (std::size_t k = 1; k < extents.size(); ++k) {
    const Extent& before = extents[k - 1];
    if (extents[k].begin - before.begin < before.bytes) fail(*extents[k].name, "shares bytes with " + *before.name);
  }
}

void Hdf5File::flush() {
  if (H5Fflush(handle_.get(), H5F_SCOPE_GLOBAL) < 0)
    fail("file", "cannot be written: " + hdf5_fault() + "; make room there, or name a file on another disk");
}

void Hdf5File::close() { close(handle_, "file"); }

#define GREENLOOP_INSTANTIATE(Number)                                                                      \
  template void Hdf5File::reserve<Number>(const std::string&, const Hdf5Shape&);                           \
  template void Hdf5File::write<Number>(const std::string&, const Hdf5Shape&, const std::vector<Number>&); \
  template std::vector<Number> Hdf5File::read<Number>(const std::string&, Hdf5Shape&) const;               \
  template void Hdf5File::write_part<Number>(const std::string&, const Hdf5Shape&, const Hdf5Shape&,       \
                                             std::add_pointer_t<const Number>);                            \
  template void Hdf5File::read_part<Number>(const std::string&, const Hdf5Shape&, const Hdf5Shape&,        \
                                            std::add_pointer_t<Number>) const;
GREENLOOP_INSTANTIATE(double)
GREENLOOP_INSTANTIATE(float)
GREENLOOP_INSTANTIATE(int)
GREENLOOP_INSTANTIATE(unsigned char)
GREENLOOP_INSTANTIATE(std::uint32_t)
GREENLOOP_INSTANTIATE(std::int64_t)
#undef GREENLOOP_INSTANTIATE

}  // namespace greenloop
