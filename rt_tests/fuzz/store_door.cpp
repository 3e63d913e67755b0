#include <hdf5.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "formats/store/green_store.hpp"
#include "formats/store/green_store_contents.hpp"
#include "formats/store/hdf5_file.hpp"
#include "formats/testing/small_store.hpp"
#include "rt_tests/fuzz/doors.hpp"

namespace greenloop {
namespace {

constexpr std::array attributes{std::pair{"/", "format"},
                                std::pair{"/", "format_version"},
                                std::pair{"/", "young"},
                                std::pair{"/", "young_unit"},
                                std::pair{"/", "poisson"},
                                std::pair{"/", "contents_checksum"},
                                std::pair{"/", "provenance"},
                                std::pair{"/", "fingerprint"},
                                std::pair{"/surface/position", "unit"},
                                std::pair{"/surface/area", "unit"},
                                std::pair{"/green/displacement", "unit"}};

// bytes of a dataset that is really there; larger ones only say that they are
constexpr std::uint64_t most_written = 1 << 20;

Hdf5Handle arbitrary_type(Random& random) {
  const hsize_t length = 1 + below(random, 1000);
  switch (below(random, 10)) {
    case 0: {
      Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
      H5Tset_size(text.get(), 1 + below(random, 70000));
      return text;
    }
    case 1: {
      Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
      H5Tset_size(text.get(), H5T_VARIABLE);
      return text;
    }
    case 2:
      return {H5Tarray_create2(H5T_IEEE_F64LE, 1, &length), H5Tclose};
    case 3:
      return {H5Tvlen_create(H5T_STD_I32LE), H5Tclose};
    case 4: {
      Hdf5Handle compound(H5Tcreate(H5T_COMPOUND, 24), H5Tclose);
      H5Tinsert(compound.get(), "a", 0, H5T_IEEE_F64LE);
      return compound;
    }
    case 5:
      return {H5Tcreate(H5T_OPAQUE, 1 + below(random, 100)), H5Tclose};
    case 6:
      return {H5Tenum_create(H5T_STD_I8LE), H5Tclose};
    case 7:
      return {H5Tcopy(H5T_IEEE_F32BE), H5Tclose};
    case 8:
      return {H5Tcopy(H5T_STD_I64LE), H5Tclose};
    default:
      return {H5Tcopy(below(random, 2) == 0 ? H5T_IEEE_F64LE : H5T_STD_I32LE), H5Tclose};
  }
}

Hdf5Handle arbitrary_space(Random& random) {
  if (below(random, 8) == 0) return {H5Screate(below(random, 2) == 0 ? H5S_NULL : H5S_SCALAR), H5Sclose};
  constexpr std::array<hsize_t, 10> lengths{0, 1, 2, 3, 4, 8, 17, 18, 19, 1000};
  Hdf5Shape shape(1 + below(random, 4));
  for (hsize_t& extent : shape) extent = one_of(random, lengths);
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

void replace_attribute(Random& random, hid_t file) {
  const auto& [object, name] = one_of(random, attributes);
  H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  if (below(random, 8) == 0) return;
  const Hdf5Handle type = arbitrary_type(random), space = arbitrary_space(random);
  const Hdf5Handle id(
      H5Acreate_by_name(file, object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
}

void replace_dataset(Random& random, hid_t file, const std::string& victim) {
  const char* const name = one_of(random, kGreenStoreDatasets);
  H5Ldelete(file, name, H5P_DEFAULT);
  const Hdf5Handle plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Hdf5Handle type = arbitrary_type(random), space = arbitrary_space(random);
  const hsize_t chunk[4] = {2, 2, 2, 2};
  switch (below(random, 8)) {
    case 0:
      H5Lcreate_soft("/surface/area", file, name, H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 1:
      H5Lcreate_external(victim.c_str(), "/x", file, name, H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 2:
      H5Lcreate_hard(file, one_of(random, kGreenStoreDatasets), file, name, H5P_DEFAULT, H5P_DEFAULT);
      return;
    case 3:
      H5Pset_external(plist.get(), victim.c_str(), 0, H5F_UNLIMITED);
      break;
    case 4:
      H5Pset_chunk(plist.get(), H5Sget_simple_extent_ndims(space.get()), chunk);
      break;
    case 5:
      H5Pset_layout(plist.get(), H5D_COMPACT);
      break;
    default:
      if (below(random, 4) != 0 &&
          H5Tget_size(type.get()) * static_cast<std::uint64_t>(H5Sget_simple_extent_npoints(space.get())) <=
              most_written) {
        H5Pset_alloc_time(plist.get(), H5D_ALLOC_TIME_EARLY);
      }
      break;
  }
  const Hdf5Handle id(H5Dcreate2(file, name, type.get(), space.get(), H5P_DEFAULT, plist.get(), H5P_DEFAULT), H5Dclose);
}

// some numbers of a dataset, of whatever kind it is
void change_values(Random& random, hid_t file) {
  const Hdf5Handle id(H5Dopen2(file, one_of(random, kGreenStoreDatasets), H5P_DEFAULT), H5Dclose);
  const Hdf5Handle type(H5Dget_type(id.get()), H5Tclose);
  const hsize_t bytes = H5Dget_storage_size(id.get());
  // in memory these are pointers
  const bool points = H5Tdetect_class(type.get(), H5T_VLEN) > 0 || H5Tis_variable_str(type.get()) > 0;
  if (!id || points || bytes < 8 || bytes > 1 << 20) return;
  Bytes values(bytes);
  if (H5Dread(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return;
  mutate_bytes(random, values.size(), values);
  values.resize(bytes);
  H5Dwrite(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

class StoreDoor final : public Door {
 public:
  StoreDoor() {
    for (const bool scalar : {false, true}) {
      auto store = GreenStore::create(file_.path, scalar ? scalar_contents(3) : small_contents(3));
      for (int c = 0; c < 2; ++c) store.write_columns(c, column_values(c, 17, scalar ? 1 : 3));
      store.close();
      std::ifstream stream(file_.path, std::ios::binary);
      seeds_.emplace_back(std::istreambuf_iterator(stream), std::istreambuf_iterator<char>());
    }
  }

  bool try_one(Random& random) override {
    make(random);
    std::ofstream(victim_.path) << std::string(4096, 'v');  // values may have been changed through external storage
    const bool taken = read_and_resume();
    std::ifstream stream(victim_.path, std::ios::binary);
    require_right(std::string(std::istreambuf_iterator(stream), {}) == std::string(4096, 'v'),
                  "a store changed another file");
    return taken;
  }

 private:
  void make(Random& random) const {
    std::ofstream(file_.path, std::ios::binary | std::ios::trunc) << one_of(random, seeds_);
    const Hdf5Handle file(H5Fopen(file_.path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    for (std::size_t change = 1 + below(random, 2); change > 0; --change) {
      switch (below(random, 4)) {
        case 0:
          replace_dataset(random, file.get(), victim_.path.string());
          break;
        case 1:
          change_values(random, file.get());
          break;
        default:
          replace_attribute(random, file.get());
          break;
      }
    }
    if (below(random, 2) == 0) H5Adelete_by_name(file.get(), "/", "contents_checksum", H5P_DEFAULT);
    if (below(random, 2) == 0) H5Ldelete(file.get(), "/green/checksum", H5P_DEFAULT);
  }

  [[nodiscard]] bool read_and_resume() const {
    try {
      auto store = GreenStore::open(file_.path, GreenStore::Access::kReadWrite);
      for (const int column : store.missing_columns()) {
        store.write_columns(column, column_values(column, store.row_count(), store.contents().components));
      }
      for (int column = 0; column < store.column_count(); ++column) {
        (void)store.read_block(0, 1, column, 1);
        (void)store.read_columns(column, 1);
      }
      return true;
    } catch (const std::runtime_error&) {
      return false;
    }
  }

  TemporaryFile file_{"store_door.h5"}, victim_{"store_door_victim"};
  std::vector<std::string> seeds_;
};

}  // namespace

std::unique_ptr<Door> store_door() { return std::make_unique<StoreDoor>(); }

}  // namespace greenloop
