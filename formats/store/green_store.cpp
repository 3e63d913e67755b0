#include "formats/store/green_store.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "formats/output/output_file.hpp"
#include "formats/store/body_force.hpp"
#include "formats/store/green_store_contents.hpp"
#include "formats/store/hdf5_fault.hpp"
#include "formats/store/hdf5_file.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop {
namespace {

constexpr const char* kDone = "/green/done";
constexpr std::string_view unfinished_ending = ".h5.part";
constexpr const char* kChecksum = "/green/checksum";
constexpr const char* kNotBelieved = "the store is damaged; build it again (greenloop build --overwrite-store)";

Hdf5Shape displacement_shape(const GreenStoreContents& contents) {
  const auto components = static_cast<hsize_t>(contents.components);
  return {contents.column_node.size(), components, contents.row_node.size(), components};
}

std::string text(const Hdf5Shape& shape) {
  std::string text;
  for (const auto extent : shape) text += (text.empty() ? "" : ", ") + std::to_string(extent);
  return "[" + text + "]";
}

void reserve_columns(Hdf5File& file, const GreenStoreContents& contents) {
  file.reserve<double>(kDisplacement, displacement_shape(contents));
  file.write_text(kDisplacement, "unit", contents.unit);
  file.write_text(kDisplacement, "axes",
                  contents.components == 3 ? "column, force component, row, displacement component"
                                           : "column, load component, row, answer component");
  file.write(kChecksum, {contents.column_node.size()}, std::vector<std::uint32_t>(contents.column_node.size(), 0));
  file.write(kDone, {contents.column_node.size()}, std::vector<unsigned char>(contents.column_node.size(), 0));
}

/// All of it but columns: from here on only dataset values change, so a kill leaves all metadata in the file.
Hdf5File create_file(const PendingFile& unfinished, const std::filesystem::path& path,
                     const GreenStoreContents& contents) try {
  auto hdf5 = Hdf5File::create(unfinished.name());
  write_contents(hdf5, contents);
  reserve_columns(hdf5, contents);
  if (contents.components == 3 && !contents.volume.vertices.empty()) {
    reserve_body_force(hdf5, contents.row_node.size());
  }
  hdf5.flush();
  return hdf5;
} catch (const std::runtime_error& error) {  // people know the file by another name
  std::string what = error.what();
  const std::string name = unfinished.name().string();
  if (const auto at = what.find(name); at != std::string::npos) what.replace(at, name.size(), path.string());
  throw std::runtime_error(what);
}

/// What processes left that were killed while they made a store: locked by nobody.
void remove_abandoned(const std::filesystem::path& store) {
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::absolute(followed(store)).parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".greenloop-") || !name.ends_with(unfinished_ending) || is_locked(entry.path())) continue;
    std::filesystem::remove(entry.path(), error);
  }
}

void publish(PendingFile& unfinished, const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) {
    GreenStore::require_free(path);
    unfinished.publish();
  } else if (!unfinished.publish_new()) {
    throw std::runtime_error(path.string() + ": another process has made it meanwhile; start again to use it");
  }
}

}  // namespace

struct GreenStore::File {
  Hdf5File hdf5;
  GreenStoreContents contents;
  std::vector<unsigned char> done;
  std::vector<std::uint32_t> checksum;  // of each column; empty of a store made elsewhere
  bool writable;
  std::vector<unsigned char> checked{};  // columns that were read and found right

  [[nodiscard]] std::size_t column_size() const {
    const std::size_t components = contents.components;
    return components * components * contents.row_node.size();
  }

  // The N loads of a column node lie one after the other, in the file as in the matrix.
  [[nodiscard]] std::uint32_t checksum_of(const double* column) const {
    return crc32c(std::as_bytes(std::span(column, column_size())));
  }

  void require_right(int column, const double* values) const {
    if (!checksum.empty() && checksum_of(values) != checksum[column]) {
      hdf5.fail(kDisplacement,
                "column " + std::to_string(column) + " differs from its checksum; " + std::string(kNotBelieved));
    }
    const bool zero = std::all_of(values, values + column_size(), [](double value) { return value == 0; });
    if (zero) hdf5.fail(kDisplacement, "column " + std::to_string(column) + " is all zero; " + kNotBelieved);
  }

  void check_columns(int first, int count) {
    std::vector<double> column(column_size());
    const auto width = static_cast<hsize_t>(contents.components), rows = hsize_t{contents.row_node.size()};
    checked.resize(done.size());
    for (int c = first; c < first + count; ++c) {
      if (checked[c] != 0) continue;
      hdf5.read_part(kDisplacement, {static_cast<hsize_t>(c), 0, 0, 0}, {1, width, rows, width}, column.data());
      require_right(c, column.data());
      checked[c] = 1;
    }
  }

  void require_columns(int first, int count) const {
    if (first < 0 || count <= 0 || first > static_cast<int>(done.size()) - count) {
      hdf5.fail(kDisplacement, "columns " + std::to_string(first) + " .. " + std::to_string(first + count - 1) +
                                   " are outside 0 .. " + std::to_string(done.size() - 1));
    }
  }
};

GreenStore::GreenStore(std::unique_ptr<File> file) : file_(std::move(file)) {}
GreenStore::~GreenStore() = default;
GreenStore::GreenStore(GreenStore&&) noexcept = default;
GreenStore& GreenStore::operator=(GreenStore&&) noexcept = default;

GreenStore GreenStore::create(const std::filesystem::path& path, const GreenStoreContents& contents) {
  require_valid(contents);
  remove_abandoned(path);
  PendingFile unfinished(path, true, unfinished_ending);
  auto hdf5 = create_file(unfinished, path, contents);
  publish(unfinished, path);
  hdf5.renamed(path);
  const std::size_t columns = contents.column_node.size();
  return GreenStore(std::unique_ptr<File>(new File{std::move(hdf5), contents, std::vector<unsigned char>(columns, 0),
                                                   std::vector<std::uint32_t>(columns, 0), true}));
}

void GreenStore::require_free(const std::filesystem::path& path) {
  if (!is_locked(path)) return;
  throw std::runtime_error(path.string() + ": another process uses it; wait until it ends, or name another file");
}

GreenStore GreenStore::open(const std::filesystem::path& path, Access access) {
  const bool writable = access == Access::kReadWrite;
  auto hdf5 = Hdf5File::open(path, writable);
  hdf5.require_apart({kGreenStoreDatasets.begin(), kGreenStoreDatasets.end()});
  auto contents = read_contents(hdf5);
  require_unit(hdf5, kDisplacement, contents.unit);
  if (hdf5.shape(kDisplacement) != displacement_shape(contents)) {
    hdf5.fail(kDisplacement,
              "its shape must be " + text(displacement_shape(contents)) +
                  " (column, load, row, answer; loads and answers of 3 components, or of 1 in a scalar problem)");
  }
  hdf5.require_exact(kDisplacement);
  require_checksum(hdf5, contents);
  static_cast<void>(greenloop::has_body_force_room(hdf5, contents.row_node.size()));
  const Hdf5Shape columns{contents.column_node.size()};
  const bool has_checksum = hdf5.has(kChecksum);
  for (const char* dataset : {kDone, kChecksum}) {
    if ((dataset != kChecksum || has_checksum) && hdf5.shape(dataset) != columns) {
      hdf5.fail(dataset, "needs one entry per column");
    }
  }
  Hdf5Shape shape;
  auto done = hdf5.read<unsigned char>(kDone, shape);
  if (std::any_of(done.begin(), done.end(), [](auto flag) { return flag > 1; }))
    hdf5.fail(kDone, "holds not only 0, 1");
  auto checksum = has_checksum ? hdf5.read<std::uint32_t>(kChecksum, shape) : std::vector<std::uint32_t>();
  return GreenStore(std::unique_ptr<File>(
      new File{std::move(hdf5), std::move(contents), std::move(done), std::move(checksum), writable}));
}

void GreenStore::close() { file_->hdf5.close(); }

const std::filesystem::path& GreenStore::path() const { return file_->hdf5.path(); }
const GreenStoreContents& GreenStore::contents() const { return file_->contents; }

void GreenStore::require_components(int components) const {
  if (contents().components == components) return;
  file_->hdf5.fail(kDisplacement, "its columns have " + std::to_string(contents().components) + " numbers a node, in " +
                                      contents().unit + "; " + std::to_string(components) + " are taken here");
}

int GreenStore::row_count() const { return static_cast<int>(file_->contents.row_node.size()); }
int GreenStore::column_count() const { return static_cast<int>(file_->contents.column_node.size()); }

bool GreenStore::is_done(int column) const {
  file_->require_columns(column, 1);
  return file_->done[column] != 0;
}

std::vector<int> GreenStore::missing_columns() const {
  std::vector<int> missing;
  for (int c = 0; c < column_count(); ++c) {
    if (file_->done[c] == 0) missing.push_back(c);
  }
  return missing;
}

void GreenStore::write_columns(int first, const Eigen::Ref<const Eigen::MatrixXd>& displacement) {
  auto& hdf5 = file_->hdf5;
  if (!file_->writable) hdf5.fail(kDisplacement, "the store was opened read-only");
  const int components = contents().components;
  if (displacement.rows() != Eigen::Index{components} * row_count() || displacement.cols() % components != 0) {
    hdf5.fail(kDisplacement, "a block of " + std::to_string(displacement.rows()) + " x " +
                                 std::to_string(displacement.cols()) + " does not fit; " + std::to_string(components) +
                                 " rows per row node (" + std::to_string(components * row_count()) + ") and " +
                                 std::to_string(components) + " columns per column node are wanted");
  }
  const int count = static_cast<int>(displacement.cols() / components);
  file_->require_columns(first, count);
  if (!displacement.allFinite()) {
    hdf5.fail(kDisplacement, "columns from " + std::to_string(first) + " hold values that are not finite");
  }
  const auto start = static_cast<hsize_t>(first), length = static_cast<hsize_t>(count);
  const auto rows = static_cast<hsize_t>(row_count()), width = static_cast<hsize_t>(components);
  const bool contiguous = displacement.outerStride() == displacement.rows();
  const Eigen::MatrixXd copy = contiguous ? Eigen::MatrixXd() : Eigen::MatrixXd(displacement);
  const double* const values = contiguous ? displacement.data() : copy.data();
  hdf5.write_part(kDisplacement, {start, 0, 0, 0}, {length, width, rows, width}, values);
  if (!file_->checksum.empty()) {
    for (int c = 0; c < count; ++c) {
      file_->checksum[first + c] = file_->checksum_of(values + static_cast<std::size_t>(c) * file_->column_size());
    }
    hdf5.write_part(kChecksum, {start}, {length}, file_->checksum.data() + first);
  }
  hdf5.flush();
  const std::vector<unsigned char> marks(static_cast<std::size_t>(count), 1);
  hdf5.write_part(kDone, {start}, {length}, marks.data());
  hdf5.flush();
  std::copy(marks.begin(), marks.end(), file_->done.begin() + first);
}

Eigen::MatrixXd GreenStore::read_columns(int first, int count) const {
  return read_block(0, row_count(), first, count);
}

Eigen::MatrixXd GreenStore::read_block(int first_row, int rows, int first_column, int columns) const {
  const auto& hdf5 = file_->hdf5;
  file_->require_columns(first_column, columns);
  for (int c = first_column; c < first_column + columns; ++c) {
    if (!is_done(c)) hdf5.fail(kDone, "column " + std::to_string(c) + " is not solved yet; resume the build");
  }
  if (first_row < 0 || rows <= 0 || first_row > row_count() - rows) {
    hdf5.fail(kDisplacement,
              "rows from " + std::to_string(first_row) + " are outside 0 .. " + std::to_string(row_count() - 1));
  }
  const bool whole = rows == row_count();
  if (!whole) file_->check_columns(first_column, columns);
  const int components = contents().components;
  const auto width = static_cast<hsize_t>(components);
  Eigen::MatrixXd block(components * rows, components * columns);
  hdf5.read_part(kDisplacement, {static_cast<hsize_t>(first_column), 0, static_cast<hsize_t>(first_row), 0},
                 {static_cast<hsize_t>(columns), width, static_cast<hsize_t>(rows), width}, block.data());
  if (!block.allFinite()) {
    hdf5.fail(kDisplacement, "columns from " + std::to_string(first_column) +
                                 " hold values that are not finite; solve or measure them again");
  }
  for (int c = 0; whole && c < columns; ++c) {
    file_->require_right(first_column + c, block.data() + static_cast<std::size_t>(c) * file_->column_size());
  }
  return block;
}

bool GreenStore::has_body_force_room() const {
  return greenloop::has_body_force_room(file_->hdf5, file_->contents.row_node.size());
}

bool GreenStore::is_body_force_done() const {
  return has_body_force_room() && greenloop::is_body_force_done(file_->hdf5);
}

void GreenStore::write_body_force(const Eigen::MatrixXd& displacement) {
  if (!file_->writable) file_->hdf5.fail(kBodyForce, "the store was opened read-only");
  if (!has_body_force_room()) file_->hdf5.fail(kBodyForce, "the store has no room for it");
  greenloop::write_body_force(file_->hdf5, file_->contents.row_node.size(), displacement);
}

Eigen::MatrixXd GreenStore::read_body_force() const {
  if (!has_body_force_room()) file_->hdf5.fail(kBodyForce, "the store has no body force");
  return greenloop::read_body_force(file_->hdf5, file_->contents.row_node.size());
}

}  // namespace greenloop
