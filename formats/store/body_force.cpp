#include "formats/store/body_force.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "formats/store/green_store_contents.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop {
namespace {

constexpr const char* kUnit = "m/(N/m^3)";

Hdf5Shape shape_of(hsize_t rows) { return {3, rows, 3}; }

std::uint32_t checksum(const Eigen::MatrixXd& displacement) {
  return crc32c(std::as_bytes(std::span(displacement.data(), static_cast<std::size_t>(displacement.size()))));
}

template <typename Number>
Number only_number(const Hdf5File& file, const char* dataset) {
  Hdf5Shape shape;
  return file.read<Number>(dataset, shape).front();
}

}  // namespace

void reserve_body_force(Hdf5File& file, hsize_t rows) {
  file.make_group("/body_force");
  file.reserve<double>(kBodyForce, shape_of(rows));
  file.write_text(kBodyForce, "unit", kUnit);
  file.write_text(kBodyForce, "axes", "force component, row, displacement component");
  file.write(kBodyForceChecksum, {1}, std::vector<std::uint32_t>{0});
  file.write(kBodyForceDone, {1}, std::vector<unsigned char>{0});
}

bool has_body_force_room(const Hdf5File& file, hsize_t rows) {
  if (!file.has(kBodyForce)) return false;
  require_unit(file, kBodyForce, kUnit);
  if (file.shape(kBodyForce) != shape_of(rows)) {
    file.fail(kBodyForce, "its shape must be [3, " + std::to_string(rows) + ", 3] (force, row, displacement)");
  }
  file.require_exact(kBodyForce);
  for (const char* dataset : {kBodyForceChecksum, kBodyForceDone}) {
    if (file.shape(dataset) != Hdf5Shape{1}) file.fail(dataset, "needs one entry");
  }
  if (only_number<unsigned char>(file, kBodyForceDone) > 1) file.fail(kBodyForceDone, "holds not only 0, 1");
  return true;
}

bool is_body_force_done(const Hdf5File& file) { return only_number<unsigned char>(file, kBodyForceDone) != 0; }

void write_body_force(Hdf5File& file, hsize_t rows, const Eigen::MatrixXd& displacement) {
  if (displacement.rows() != static_cast<Eigen::Index>(3 * rows) || displacement.cols() != 3) {
    file.fail(kBodyForce, "a block of " + std::to_string(displacement.rows()) + " x " +
                              std::to_string(displacement.cols()) + " does not fit; " + std::to_string(3 * rows) +
                              " x 3 are wanted");
  }
  if (!displacement.allFinite()) file.fail(kBodyForce, "the values to be written are not finite");
  const std::uint32_t sum = checksum(displacement);
  const unsigned char done = 1;
  file.write_part(kBodyForce, {0, 0, 0}, shape_of(rows), displacement.data());
  file.write_part(kBodyForceChecksum, {0}, {1}, &sum);
  file.flush();
  file.write_part(kBodyForceDone, {0}, {1}, &done);
  file.flush();
}

Eigen::MatrixXd read_body_force(const Hdf5File& file, hsize_t rows) {
  if (!is_body_force_done(file)) file.fail(kBodyForceDone, "the body force is not solved yet; resume the build");
  Eigen::MatrixXd displacement(static_cast<Eigen::Index>(3 * rows), 3);
  file.read_part(kBodyForce, {0, 0, 0}, shape_of(rows), displacement.data());
  if (!displacement.allFinite()) file.fail(kBodyForce, "holds values that are not finite; solve it again");
  if (checksum(displacement) != only_number<std::uint32_t>(file, kBodyForceChecksum)) {
    file.fail(kBodyForce,
              "differs from its checksum; the store is damaged; build it again (greenloop build "
              "--overwrite-store)");
  }
  return displacement;
}

}  // namespace greenloop
