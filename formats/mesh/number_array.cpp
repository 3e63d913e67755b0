#include "formats/mesh/number_array.hpp"

#include <cmath>

namespace greenloop {

void NumberArray::fail(std::string_view found, std::string_view expected) const {
  if (text_ != nullptr) {
    text_->fail(found, expected);
  }
  throw MeshFileError(file_.string() + ": found " + std::string(found) + " in the binary array " + in_quotes(name_) +
                      ", expected " + std::string(expected));
}

double NumberArray::next(std::string_view expected) {
  const auto size = size_of(type_);
  if (bytes_.size() < size) {
    fail("the end", expected);
  }
  const double value = decode(type_, bytes_.data(), order_);
  bytes_.remove_prefix(size);
  return value;
}

double NumberArray::real(std::string_view expected) {
  if (text_ != nullptr) {
    return text_->real(expected);
  }
  const double value = next(expected);
  if (!std::isfinite(value)) {
    fail("a number that is not finite", expected);
  }
  return value;
}

std::int64_t NumberArray::integer(std::string_view expected, std::int64_t low, std::int64_t high) {
  if (text_ != nullptr) {
    return text_->integer(expected, low, high);
  }
  const double value = next(expected);
  if (!(value >= static_cast<double>(low) && value <= static_cast<double>(high)) || value != std::floor(value)) {
    std::string found;
    append_number(found, value);
    fail(found,
         std::string(expected) + " (a whole number, from " + std::to_string(low) + " to " + std::to_string(high) + ")");
  }
  return static_cast<std::int64_t>(value);
}

Eigen::Vector3d NumberArray::point() {
  const double x = real("the x coordinate of a vertex");
  const double y = real("the y coordinate of a vertex");
  const double z = real("the z coordinate of a vertex");
  return {x, y, z};
}

bool NumberArray::more() {
  return text_ != nullptr ? !text_->at_end() && text_->peek().front() != '<' : bytes_.size() >= size_of(type_);
}

}  // namespace greenloop
