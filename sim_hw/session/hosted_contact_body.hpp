#pragma once

#include <stdexcept>
#include <string>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop {

/// A contact body in memory of its own.
class HostedContactBody {
 public:
  /// `model` must outlive it. Throws std::runtime_error if it is refused, or the limits are.
  HostedContactBody(const Model& model, const ContactBody::Limits& limits)
      : memory_(ContactBody::required(model, limits).bytes) {
    const auto created = ContactBody::create(model, limits, {memory_.data(), memory_.size()});
    if (!created) {
      throw std::runtime_error("no body for this model and " + std::to_string(limits.elastostatic.max_contacts) +
                               " contacts (error " + std::to_string(static_cast<int>(created.error)) + ")");
    }
    body_ = created.body;
  }

  [[nodiscard]] ContactBody& body() { return body_; }

 private:
  AlignedBytes memory_;
  ContactBody body_;
};

}  // namespace greenloop
