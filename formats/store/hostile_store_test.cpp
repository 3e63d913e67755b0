// Stores that somebody made to do harm, or that a full disk left behind.

#include <doctest/doctest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/store/green_store.hpp"
#include "formats/store/hdf5_file.hpp"
#include "formats/testing/small_store.hpp"

namespace greenloop {
namespace {

using Access = GreenStore::Access;
using Eigen::MatrixXd;

/// The small store with all of its columns, changed by `change` through the library.
void make_store(const std::filesystem::path& path, const std::function<void(hid_t)>& change) {
  {
    auto store = GreenStore::create(path, small_contents(3));
    for (int c = 0; c < 3; ++c) store.write_columns(c, column_values(c, 17).array() + 1);
    store.close();
  }
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  REQUIRE(file);
  change(file.get());
  REQUIRE(file.close());
}

/// The reason for which the store is refused, to be read or to be resumed; empty if it is not.
std::string refusal(const std::filesystem::path& path) {
  std::string reason;
  for (const Access access : {Access::kReadOnly, Access::kReadWrite}) {
    try {
      auto store = GreenStore::open(path, access);
      for (int c = 0; c < store.column_count(); ++c) (void)store.read_columns(c, 1);
      return {};
    } catch (const std::runtime_error& error) {
      reason = error.what();
    }
  }
  return reason;
}

void check_refused(const std::function<void(hid_t)>& change, const std::string& object, const std::string& reason) {
  const TemporaryFile file("hostile.h5");
  make_store(file.path, change);
  const std::string found = refusal(file.path);
  CAPTURE(found);
  CHECK(found.find(object) != std::string::npos);
  CHECK(found.find(reason) != std::string::npos);
}

Hdf5Handle simple(const Hdf5Shape& shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

void remove_link(hid_t file, const char* name) { REQUIRE(H5Ldelete(file, name, H5P_DEFAULT) >= 0); }

void replace_dataset(hid_t file, const char* name, hid_t type, hid_t space, hid_t plist) {
  remove_link(file, name);
  const Hdf5Handle id(H5Dcreate2(file, name, type, space, H5P_DEFAULT, plist, H5P_DEFAULT), H5Dclose);
  REQUIRE(id);
}

void replace_attribute(hid_t file, const char* object, const char* name, hid_t type, hid_t space) {
  if (H5Aexists_by_name(file, object, name, H5P_DEFAULT) > 0) {
    REQUIRE(H5Adelete_by_name(file, object, name, H5P_DEFAULT) >= 0);
  }
  const Hdf5Handle id(H5Acreate_by_name(file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  REQUIRE(id);
}

TEST_CASE("hostile stores: the store that is changed here is right without a change") {
  const TemporaryFile file("right.h5");
  make_store(file.path, [](hid_t) {});
  CHECK(refusal(file.path).empty());
}

TEST_CASE("hostile stores: attributes of other shapes and types are refused before they are read") {
  const std::array<std::pair<const char*, const char*>, 4> texts{
      {{"/", "format"}, {"/", "fingerprint"}, {"/surface/position", "unit"}, {"/green/displacement", "unit"}}};
  const Hdf5Handle many = simple({1000}), one(H5Screate(H5S_SCALAR), H5Sclose), empty(H5Screate(H5S_NULL), H5Sclose);
  const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose), variable(H5Tcopy(H5T_C_S1), H5Tclose);
  REQUIRE(H5Tset_size(text.get(), 40) >= 0);
  REQUIRE(H5Tset_size(variable.get(), H5T_VARIABLE) >= 0);
  const hsize_t length = 500;
  const Hdf5Handle array(H5Tarray_create2(H5T_IEEE_F64LE, 1, &length), H5Tclose);
  const Hdf5Handle texts_in_array(H5Tarray_create2(text.get(), 1, &length), H5Tclose);
  const Hdf5Handle sequence(H5Tvlen_create(H5T_IEEE_F64LE), H5Tclose);
  for (const auto& [object, name] : texts) {
    CAPTURE(name);
    const auto refuse = [&, object = object, name = name](hid_t type, hid_t space, const std::string& reason) {
      check_refused([&](hid_t file) { replace_attribute(file, object, name, type, space); }, name, reason);
    };
    refuse(text.get(), many.get(), "not one value");
    refuse(text.get(), empty.get(), "not one value");
    refuse(variable.get(), one.get(), "variable length");
    refuse(variable.get(), many.get(), "not one value");
    refuse(texts_in_array.get(), one.get(), "not a text");
    refuse(H5T_IEEE_F64LE, one.get(), "not a text");
    refuse(sequence.get(), one.get(), "not a text");
  }
  for (const char* name : {"format_version", "young", "poisson", "contents_checksum"}) {
    CAPTURE(name);
    const auto refuse = [&](hid_t type, hid_t space, const std::string& reason) {
      check_refused([&](hid_t file) { replace_attribute(file, "/", name, type, space); }, name, reason);
    };
    refuse(H5T_IEEE_F64LE, many.get(), "not one value");
    refuse(H5T_IEEE_F64LE, empty.get(), "not one value");
    refuse(array.get(), one.get(), "not one number");
    refuse(text.get(), one.get(), "not one number");
    refuse(sequence.get(), one.get(), "not one number");
    check_refused(
        [&](hid_t file) {
          const Hdf5Handle committed(H5Tcopy(H5T_IEEE_F64LE), H5Tclose);
          REQUIRE(H5Tcommit2(file, "/type", committed.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT) >= 0);
          replace_attribute(file, "/", name, committed.get(), one.get());
        },
        name, "committed type");
  }
}

TEST_CASE(
    "hostile stores: datasets whose values are elsewhere, filtered, chunked or linked are refused and not written") {
  const TemporaryFile victim("victim");
  std::ofstream(victim.path) << std::string(20000, 'v');
  const auto untouched = [&] {
    std::ifstream stream(victim.path);
    return std::string(std::istreambuf_iterator(stream), {}) == std::string(20000, 'v');
  };
  const Hdf5Shape columns{3, 3, 17, 3};
  const std::array<std::pair<const char*, Hdf5Shape>, 3> datasets{
      {{"/green/displacement", columns}, {"/green/done", {3}}, {"/surface/area", {18}}}};
  for (const auto& [name, shape] : datasets) {
    CAPTURE(name);
    const hid_t type = std::string(name) == "/green/done" ? H5T_STD_U8LE : H5T_IEEE_F64LE;
    const Hdf5Handle space = simple(shape);
    const auto refuse = [&, name = name](const std::function<void(hid_t)>& set, const std::string& reason) {
      check_refused(
          [&](hid_t file) {
            const Hdf5Handle plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
            set(plist.get());
            replace_dataset(file, name, type, space.get(), plist.get());
            const Hdf5Handle unit(H5Tcopy(H5T_C_S1), H5Tclose), one(H5Screate(H5S_SCALAR), H5Sclose);
            REQUIRE(H5Tset_size(unit.get(), 4) >= 0);
            const Hdf5Handle id(
                H5Acreate_by_name(file, name, "unit", unit.get(), one.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                H5Aclose);
            REQUIRE(H5Awrite(id.get(), unit.get(), type == H5T_IEEE_F64LE && shape.size() == 1 ? "m^2" : "m/N") >= 0);
          },
          name, reason);
      CHECK(untouched());
    };
    refuse([&](hid_t plist) { REQUIRE(H5Pset_external(plist, victim.path.c_str(), 0, H5F_UNLIMITED) >= 0); },
           "external storage");
    refuse(
        [&, shape = shape](hid_t plist) {
          const Hdf5Handle source = simple(shape);
          REQUIRE(H5Pset_virtual(plist, source.get(), victim.path.c_str(), "/x", source.get()) >= 0);
        },
        "virtual dataset");
    refuse([&, shape = shape](
               hid_t plist) { REQUIRE(H5Pset_chunk(plist, static_cast<int>(shape.size()), shape.data()) >= 0); },
           "chunked");
    refuse(
        [&, shape = shape](hid_t plist) {
          REQUIRE(H5Pset_chunk(plist, static_cast<int>(shape.size()), shape.data()) >= 0);
          REQUIRE(H5Pset_shuffle(plist) >= 0);
        },
        "filter");
    refuse([](hid_t plist) { REQUIRE(H5Pset_alloc_time(plist, H5D_ALLOC_TIME_LATE) >= 0); },
           "its shape asks for other values");
    check_refused(
        [&, name = name](hid_t file) {
          remove_link(file, name);
          REQUIRE(H5Lcreate_external(victim.path.c_str(), "/x", file, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
        },
        name, "link to another file");
    check_refused(
        [&, name = name](hid_t file) {
          REQUIRE(H5Lmove(file, name, file, "/moved", H5P_DEFAULT, H5P_DEFAULT) >= 0);
          REQUIRE(H5Lcreate_soft("/moved", file, name, H5P_DEFAULT, H5P_DEFAULT) >= 0);
        },
        name, "is a link");
    check_refused(
        [&, name = name](hid_t file) {
          REQUIRE(H5Lcreate_hard(file, name, file, "/twice", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        },
        name, "several names");
    CHECK(untouched());
  }
  check_refused(
      [&](hid_t file) {
        remove_link(file, "/green");
        REQUIRE(H5Lcreate_external(victim.path.c_str(), "/", file, "/green", H5P_DEFAULT, H5P_DEFAULT) >= 0);
      },
      "/green", "link to another file");
  check_refused(
      [&](hid_t file) {
        remove_link(file, "/surface");
        REQUIRE(H5Lcreate_hard(file, "/", file, "/surface", H5P_DEFAULT, H5P_DEFAULT) >= 0);  // a cycle
      },
      "/surface/position", "missing");
}

TEST_CASE("hostile stores: shapes, types and bounds are checked before anything is allocated") {
  const Hdf5Handle plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), compound(H5Tcreate(H5T_COMPOUND, 16), H5Tclose);
  const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose), area = simple({18});
  REQUIRE(H5Tinsert(compound.get(), "a", 0, H5T_IEEE_F64LE) >= 0);
  const auto refuse = [&](const char* name, hid_t type, hid_t space, const std::string& reason) {
    check_refused(
        [&](hid_t file) {
          const Hdf5Handle early(H5Pcopy(plist.get()), H5Pclose);
          REQUIRE(H5Pset_alloc_time(early.get(), H5D_ALLOC_TIME_EARLY) >= 0);
          replace_dataset(file, name, type, space, early.get());
        },
        name, reason);
  };
  refuse("/surface/parents", compound.get(), area.get(), "must hold floating point numbers or integers");
  refuse("/surface/parents", H5T_IEEE_F64LE, scalar.get(), "");
  refuse("/surface/parents", H5T_STD_I32LE, simple({17, 2}).get(), "needs 18 entries");
  refuse("/surface/base_triangles", H5T_STD_I32LE, simple({8, 3, 1}).get(), "must have the shape");
  refuse("/green/done", H5T_STD_U8LE, simple({4}).get(), "one entry per column");
  refuse("/green/checksum", H5T_STD_U32LE, simple({2}).get(), "one entry per column");
  refuse("/green/checksum", H5T_IEEE_F64LE, simple({3}).get(), "integers");
  // as large as it says, on paper: most of the file is a hole
  check_refused(
      [&](hid_t file) {
        const Hdf5Handle sparse(H5Pcopy(plist.get()), H5Pclose), space = simple({hsize_t{1} << 36});
        REQUIRE(H5Pset_alloc_time(sparse.get(), H5D_ALLOC_TIME_EARLY) >= 0);
        REQUIRE(H5Pset_fill_time(sparse.get(), H5D_FILL_TIME_NEVER) >= 0);
        replace_dataset(file, "/surface/vertex_end", H5T_STD_I32LE, space.get(), sparse.get());
      },
      "/surface/vertex_end", "more than 134217728 numbers");
}

/// Where a dataset's values begin.
haddr_t offset_of(const std::filesystem::path& path, const char* name) {
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle id(H5Dopen2(file.get(), name, H5P_DEFAULT), H5Dclose);
  return H5Dget_offset(id.get());
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator(stream), {}};
}

TEST_CASE("hostile stores: values that share bytes, or lie beyond the end, are refused") {
  const TemporaryFile file("offsets.h5");
  make_store(file.path, [](hid_t) {});
  const std::string bytes = bytes_of(file.path);
  const haddr_t done = offset_of(file.path, "/green/done"), area = offset_of(file.path, "/surface/area");
  const auto with_offset = [&](haddr_t from, haddr_t to) {
    std::string changed = bytes;
    const std::string wanted(reinterpret_cast<const char*>(&from), sizeof(from));
    const std::size_t at = changed.find(wanted);
    REQUIRE(at != std::string::npos);
    changed.replace(at, sizeof(to), reinterpret_cast<const char*>(&to), sizeof(to));
    std::ofstream(file.path, std::ios::binary | std::ios::trunc) << changed;
    return refusal(file.path);
  };
  CHECK(with_offset(done, area + 8).find("shares bytes with /surface/area") != std::string::npos);
  CHECK(with_offset(done, bytes.size() - 1).find("/green/done") != std::string::npos);
  CHECK(with_offset(area, bytes.size() + 4096).find("/surface/area") != std::string::npos);
}

void overwrite(const std::filesystem::path& path, haddr_t at, const std::string& bytes) {
  std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(static_cast<std::streamoff>(at));
  stream << bytes;
}

TEST_CASE("hostile stores: columns that differ from their checksums are refused, wherever they are read") {
  const TemporaryFile file("checksum.h5");
  make_store(file.path, [](hid_t) {});
  const haddr_t columns = offset_of(file.path, "/green/displacement");
  const std::size_t column = sizeof(double) * 9 * 17;
  overwrite(file.path, columns + column + 400, "\1");
  {
    const auto store = GreenStore::open(file.path, Access::kReadOnly);
    CHECK(store.read_columns(0, 1) == column_values(0, 17).array().operator+(1).matrix());
    CHECK_THROWS_WITH((void)store.read_columns(0, 2), doctest::Contains("column 1 differs from its checksum"));
    CHECK_THROWS_WITH((void)store.read_block(16, 1, 1, 1), doctest::Contains("column 1 differs from its checksum"));
    CHECK(store.read_block(16, 1, 2, 1).rows() == 3);
  }
  overwrite(file.path, columns, std::string(3 * column, '\0'));
  CHECK(refusal(file.path).find("column 0 differs from its checksum") != std::string::npos);
}

TEST_CASE("hostile stores: a column marked done that was never written is refused, with or without checksums") {
  for (const bool with_checksum : {true, false}) {
    const TemporaryFile file("marked.h5");
    { auto store = GreenStore::create(file.path, small_contents(3)); }
    if (!with_checksum) {
      const Hdf5Handle id(H5Fopen(file.path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
      remove_link(id.get(), "/green/checksum");
    }
    overwrite(file.path, offset_of(file.path, "/green/done"), "\1\1\1");
    const auto store = GreenStore::open(file.path, Access::kReadOnly);
    const char* reason = with_checksum ? "differs from its checksum" : "is all zero";
    CHECK_THROWS_WITH((void)store.read_columns(1, 1), doctest::Contains(reason));
    CHECK_THROWS_WITH((void)store.read_block(2, 3, 1, 1), doctest::Contains(reason));
  }
}

TEST_CASE("hostile stores: a body force that was changed, never written, or of another shape or unit is refused") {
  const TemporaryFile file("body_force.h5");
  {
    auto store = GreenStore::create(file.path, small_contents(3));
    store.write_body_force(column_values(4, 17));
  }
  overwrite(file.path, offset_of(file.path, "/body_force/displacement") + 400, "\1");
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly).read_body_force(),
                    doctest::Contains("/body_force/displacement: differs from its checksum"));
  { auto store = GreenStore::create(file.path, small_contents(3)); }
  overwrite(file.path, offset_of(file.path, "/body_force/done"), "\1");
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly).read_body_force(),
                    doctest::Contains("differs from its checksum"));
  overwrite(file.path, offset_of(file.path, "/body_force/done"), "\2");
  CHECK_THROWS_WITH((void)GreenStore::open(file.path, Access::kReadOnly), doctest::Contains("holds not only 0, 1"));
  check_refused([](hid_t id) { remove_link(id, "/body_force/done"); }, "/body_force/done", "");
  const Hdf5Handle two = simple({2});
  check_refused([&](hid_t id) { replace_dataset(id, "/body_force/done", H5T_STD_U8LE, two.get(), H5P_DEFAULT); },
                "/body_force/done", "its shape asks for other values");
  const Hdf5Handle fewer = simple({3, 16, 3});
  check_refused(
      [&](hid_t id) { replace_dataset(id, "/body_force/displacement", H5T_IEEE_F64LE, fewer.get(), H5P_DEFAULT); },
      "/body_force/displacement", "its shape asks for other values");
}

TEST_CASE("a store made before there was room for a body force is taken as it is") {
  const TemporaryFile file("before.h5");
  make_store(file.path, [](hid_t id) { remove_link(id, "/body_force"); });
  CHECK(refusal(file.path).empty());
  CHECK(!GreenStore::open(file.path, Access::kReadWrite).has_body_force_room());
}

TEST_CASE("hostile stores: another mesh or material under the same fingerprint is refused") {
  check_refused(
      [](hid_t file) {
        const Hdf5Handle id(H5Dopen2(file, "/surface/area", H5P_DEFAULT), H5Dclose);
        std::vector<double> area(18, 0.25);
        REQUIRE(H5Dwrite(id.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, area.data()) >= 0);
      },
      "differ from their checksum", "damaged or was changed");
  check_refused(
      [](hid_t file) {
        const double young = 1;
        const Hdf5Handle id(H5Aopen(file, "young", H5P_DEFAULT), H5Aclose);
        REQUIRE(H5Awrite(id.get(), H5T_NATIVE_DOUBLE, &young) >= 0);
      },
      "differ from their checksum", "damaged or was changed");
}

TEST_CASE("hostile stores: version 1, which had no checksums, is refused with its remedy") {
  check_refused(
      [](hid_t file) {
        const double version = 1;
        const Hdf5Handle id(H5Aopen(file, "format_version", H5P_DEFAULT), H5Aclose);
        REQUIRE(H5Awrite(id.get(), H5T_NATIVE_DOUBLE, &version) >= 0);
      },
      "format_version 1", "--overwrite-store");
}

/// No file may grow or be written beyond so many bytes, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit less{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &less);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

template <class Act>
bool is_refused(Act act) {
  try {
    act();
    return false;
  } catch (const std::runtime_error&) {
    return true;
  }
}

/// Stores created with room for any part of them: whether each was an error that left no store.
bool creating_is_refused(const std::filesystem::path& path, haddr_t length) {
  bool right = true;
  for (haddr_t room = 0; room < length; room += 97) {
    const TemporaryFile other("full-too.h5");
    const FullDisk disk(room);
    right = right && is_refused([&] { (void)GreenStore::create(other.path, small_contents(3)); }) &&
            !std::filesystem::exists(other.path);
    std::filesystem::remove(other.path.string() + ".new");
  }
  return right && std::filesystem::exists(path);
}

/// Columns written with room up to a place among them, then with all room: whether each was an error and not done, and
/// came out right afterwards.
bool writing_is_refused(const std::filesystem::path& path, haddr_t room) {
  bool right = true;
  { auto store = GreenStore::create(path, small_contents(3)); }
  {
    auto store = GreenStore::open(path, Access::kReadWrite);
    const FullDisk disk(room);
    for (int c = 0; c < 3; ++c) {
      right = right && is_refused([&] { store.write_columns(c, column_values(c, 17)); }) && !store.is_done(c);
    }
  }
  auto store = GreenStore::open(path, Access::kReadWrite);
  right = right && store.missing_columns().size() == 3;
  for (int c = 0; c < 3; ++c) store.write_columns(c, column_values(c, 17));
  for (int c = 0; c < 3; ++c) right = right && store.read_columns(c, 1) == column_values(c, 17);
  return right;
}

[[noreturn]] void end(int code) {
#ifdef __SANITIZE_ADDRESS__
  _exit(code);  // a file that could not be closed leaks
#else
  std::exit(code);
#endif
}

TEST_CASE("a full disk is an error, wherever it is met, and never a column; the program ends as it should") {
  const TemporaryFile file("full.h5");
  { auto store = GreenStore::create(file.path, small_contents(3)); }
  const haddr_t length = std::filesystem::file_size(file.path), columns = offset_of(file.path, "/green/displacement");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    constexpr std::size_t column = sizeof(double) * 9 * 17;
    bool right = creating_is_refused(file.path, length);
    for (const std::size_t room : {std::size_t{0}, column / 2, column, column + 8, 2 * column}) {
      right = right && writing_is_refused(file.path, columns + room);
    }
    end(right ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace greenloop
