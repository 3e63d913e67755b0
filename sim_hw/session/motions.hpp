#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/vibrating_body.hpp"
#include "sim_hw/session/agreement.hpp"
#include "sim_hw/session/loaded_model.hpp"

namespace greenloop {

/// Motions that a body is given, and the vibrating body of both, in memory of its own.
class Motions {
 public:
  /// rate: Hz, of the loop. Throws std::runtime_error if `file` is no model of motions.
  Motions(const std::filesystem::path& file, double rate);

  [[nodiscard]] std::uint32_t impulses() const;  ///< of the palette

  /// What a run asks of the body: its budget, unless it is named, is what it has without motions and what these take
  /// besides. Throws std::runtime_error if that is below VibratingBody::Requirement::least_work.
  [[nodiscard]] Agreement agree(const SessionOptions& options, const Model& touched) const;

  /// `touched` must outlive the body. Throws std::runtime_error if it is refused: the models do not match.
  void create(const Model& touched, const ContactBody::Limits& limits);
  [[nodiscard]] VibratingBody& body() { return body_; }  ///< of no use before `create`

 private:
  std::filesystem::path file_;
  LoadedModel loaded_;
  ImpulseResponse::Limits limits_;
  AlignedBytes memory_;
  VibratingBody body_;
};

}  // namespace greenloop
