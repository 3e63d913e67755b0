#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/elastostatic.hpp"

namespace greenloop {

struct Record;  // runtime/recorder/record.hpp

/// Keeps the last steps of one body, so that what went wrong can be run again to the same bits elsewhere, outside the
/// loop: what every step was asked, a digest of what came of it, and copies of the body's arena to start from. All is
/// in the caller's memory, which is the record: written to a file as it is, it is what `greenloop-replay` reads. One
/// for each body, on the same thread.
class Recorder {
 public:
  struct Created;

  struct Options {
    std::uint32_t steps = 1000;     ///< kept, >= 1
    std::uint64_t interval = 0;     ///< steps from one checkpoint to the next; 0: `checkpoint` is called when it suits
    std::uint32_t field_nodes = 0;  ///< whose displacement goes into the digest, the first ones of the file
  };

  enum class Error : std::uint8_t { none, bad_options, bad_body, memory_too_small, memory_misaligned };

  struct Requirement {
    std::size_t bytes = 0;  ///< 0: `create` would refuse for another reason than memory
    std::size_t alignment = 64;
    std::size_t checkpoint_bytes = 0;  ///< copied by each checkpoint: the arena
    std::size_t step_bytes = 0;        ///< written by a step without one, at most
  };

  /// Start-up; the work of Elastostatic::required.
  [[nodiscard]] static Requirement required(const Model& model, const Elastostatic::Limits& limits,
                                            const Options& options) noexcept;

  /// For a body just created with this model and these limits in `arena`, before its first step. Start-up; copies the
  /// arena. `arena` and `memory` must outlive the recorder and stay where they are.
  [[nodiscard]] static Created create(const Model& model, const Elastostatic::Limits& limits,
                                      std::span<const std::byte> arena, const Options& options,
                                      std::span<std::byte> memory) noexcept;

  /// body.step(contacts, budget, response), recorded: the question before, its outcome after. For the loop; work beyond
  /// the step's: one pass over the contacts, the forces and `field_nodes` nodes; before every `interval`th step a
  /// checkpoint.
  Elastostatic::StepReport step(Elastostatic& body, std::span<const Constraint> contacts, Budget budget,
                                const Elastostatic::Response& response) noexcept;

  /// Copies the arena, in place of the older of the two copies made so: a replay starts at the oldest copy from which
  /// on every step is still kept. For a moment of the loop that has the time: Requirement::checkpoint_bytes are copied.
  void checkpoint() noexcept;

  /// What is to be written to a file.
  [[nodiscard]] std::span<const std::byte> record() const noexcept;

 private:
  Record* record_ = nullptr;
};

struct Recorder::Created {
  Error error = Error::none;
  std::size_t requested = 0, available = 0, missing = 0;  ///< bytes
  Recorder recorder;
  explicit operator bool() const noexcept { return error == Error::none; }
};

}  // namespace greenloop
