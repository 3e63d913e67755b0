#include "rt_tests/replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/replay/fixed_memory.hpp"
#include "runtime/recorder/record.hpp"

namespace greenloop {
namespace {

std::byte* pointer(std::uint64_t address) { return std::bit_cast<std::byte*>(static_cast<std::uintptr_t>(address)); }

void require(bool right, const char* what) {
  if (!right) throw std::runtime_error(what);
}

// a record whose offsets all lie within it
class RecordView {
 public:
  explicit RecordView(std::span<const std::byte> bytes) : bytes_(bytes) {
    require(bytes.size() >= sizeof(Record), "no record: too short");
    std::memcpy(&facts, bytes.data(), sizeof facts);
    require(std::memcmp(facts.magic, record_magic, sizeof record_magic) == 0, "no record: bad magic");
    require(facts.version == record_version && facts.pointer_bytes == sizeof(void*),
            "the record is of another version of greenloop or another kind of machine");
    require(facts.bytes == bytes.size(), "the record was cut or extended: copy it again");
    const std::uint64_t slot = sizeof(RecordedStep) + sizeof(Constraint) * most_constraints(facts.limits);
    require(facts.steps > 0 && facts.slot_bytes >= slot && facts.slot_bytes <= facts.bytes / facts.steps &&
                holds(facts.steps_offset, facts.slot_bytes * facts.steps),
            "the record is damaged: its steps do not fit");
    for (const Checkpoint& checkpoint : facts.checkpoint) {
      require(holds(checkpoint.offset, facts.arena_bytes), "the record is damaged: a checkpoint does not fit");
    }
  }

  /// The checkpoint from which on most steps are kept.
  [[nodiscard]] const Checkpoint& start() const {
    const Checkpoint* best = nullptr;
    for (const Checkpoint& checkpoint : facts.checkpoint) {
      const bool usable = checkpoint.step <= facts.begun && facts.begun - checkpoint.step <= facts.steps;
      if (usable && (best == nullptr || checkpoint.step < best->step)) best = &checkpoint;
    }
    require(best != nullptr,
            "no checkpoint goes with the steps that are kept: take them more often, or keep more steps");
    return *best;
  }

  [[nodiscard]] std::span<const std::byte> arena_at(const Checkpoint& checkpoint) const {
    return bytes_.subspan(static_cast<std::size_t>(checkpoint.offset), static_cast<std::size_t>(facts.arena_bytes));
  }

  [[nodiscard]] RecordedStep step(std::uint64_t number) const {
    RecordedStep step;
    std::memcpy(&step, slot(number), sizeof step);
    require(step.number == number && step.contacts <= 1U << 20 && step.forces <= 1U << 22 &&
                step.displaced_nodes <= std::uint64_t{1} << 24,
            "the record is damaged: a step is not what it should be");
    return step;
  }

  /// Those beyond what is kept are zero.
  [[nodiscard]] std::vector<Constraint> contacts(const RecordedStep& step) const {
    std::vector<Constraint> contacts(static_cast<std::size_t>(step.contacts));
    const std::size_t kept = std::min<std::size_t>(contacts.size(), most_constraints(facts.limits));
    if (kept > 0) std::memcpy(contacts.data(), slot(step.number) + sizeof step, kept * sizeof(Constraint));
    return contacts;
  }

  Record facts{};

 private:
  [[nodiscard]] bool holds(std::uint64_t offset, std::uint64_t size) const {
    return offset <= facts.bytes && size <= facts.bytes - offset;
  }
  [[nodiscard]] const std::byte* slot(std::uint64_t number) const {
    return bytes_.data() + facts.steps_offset + facts.slot_bytes * (number % facts.steps);
  }

  std::span<const std::byte> bytes_;
};

// the status and the digest of a recorded step run again
class Rerun {
 public:
  Rerun(const RecordView& record, Elastostatic& body) : record_(record), body_(body) {}

  /// Whether what comes of it is what was recorded.
  bool is_same(const RecordedStep& step) {
    const std::vector<Constraint> contacts = record_.contacts(step);
    force_.resize(static_cast<std::size_t>(step.forces));
    const auto nodes = static_cast<std::size_t>(step.displaced_nodes);
    if (field_.size() < sizeof(Vec4) * (nodes + 1)) field_ = AlignedBytes(sizeof(Vec4) * (nodes + 1));
    std::byte* const field = field_.data() + (step.displacement_aligned != 0 ? 0 : sizeof(float));
    const Elastostatic::Response response{force_, {reinterpret_cast<Vec4*>(field), nodes}};
    const Elastostatic::StepReport report = body_.step(contacts, {step.budget}, response);
    return step.finished == 0 || (static_cast<std::uint32_t>(report.status) == step.status &&
                                  outcome_digest(report, response, record_.facts.field_nodes) == step.digest);
  }

 private:
  const RecordView& record_;
  Elastostatic& body_;
  std::vector<Vec3> force_;
  AlignedBytes field_;
};

Replay run(const RecordView& record, std::uint64_t first, Elastostatic& body) {
  Replay replay{.first = first, .steps = 0, .differs = std::nullopt, .unfinished = false};
  Rerun rerun(record, body);
  for (std::uint64_t number = first; number < record.facts.begun && !replay.differs; ++number, ++replay.steps) {
    const RecordedStep step = record.step(number);
    replay.unfinished = step.finished == 0;
    if (!rerun.is_same(step)) replay.differs = number;
  }
  require(replay.steps > 0, "nothing to run again: no step came after the last checkpoint");
  return replay;
}

// Words that a new body here has other than the recorded one had when it was new are addresses of this process's code,
// or padding. They stay while a body lives. All others are the checkpoint's.
void restore(std::span<const std::byte> checkpoint, std::span<const std::byte> recorded_new, std::byte* arena) {
  using Word = std::uintptr_t;
  for (std::size_t i = 0; i + sizeof(Word) <= checkpoint.size(); i += sizeof(Word)) {
    Word saved, recorded, here;
    std::memcpy(&saved, checkpoint.data() + i, sizeof saved);
    std::memcpy(&recorded, recorded_new.data() + i, sizeof recorded);
    std::memcpy(&here, arena + i, sizeof here);
    if (here != recorded) {
      require(saved == recorded, "a new body here is not as the recorded one was: use the same build of the library");
    } else {
      std::memcpy(arena + i, &saved, sizeof saved);
    }
  }
}

Elastostatic body_of(const Record& record, const Model& model) {
  const auto created = Elastostatic::create(
      model, record.limits, {pointer(record.arena_address), static_cast<std::size_t>(record.arena_bytes)});
  require(bool{created} && created.requested == record.arena_bytes,
          "a body here does not take the memory that the recorded one took: use the same build of the library");
  return created.body;
}

}  // namespace

Replay replay_in_place(std::span<const std::byte> record, Elastostatic& body) {
  const RecordView view(record);
  const Checkpoint& start = view.start();
  std::memcpy(pointer(view.facts.arena_address), view.arena_at(start).data(), view.arena_at(start).size());
  return run(view, start.step, body);
}

Replay replay(std::span<const std::byte> record, std::span<const std::byte> model) {
  const RecordView view(record);
  const Record& facts = view.facts;
  const auto* header = reinterpret_cast<const layout::Header*>(model.data());
  require(model.size() == facts.model_bytes && model.size() >= sizeof *header && header->header_crc == facts.model_crc,
          "the model is not the recorded body's");
  const FixedMemory memory({facts.arena_address, facts.arena_address + facts.arena_bytes},
                           {facts.model_address, facts.model_address + facts.model_bytes});
  std::byte* const file = pointer(facts.model_address);
  std::memcpy(file, model.data(), model.size());
  const auto opened = Model::open({file, model.size()});
  require(bool{opened}, "the model does not verify");
  Elastostatic body = body_of(facts, opened.model);
  const Checkpoint& start = view.start();
  restore(view.arena_at(start), view.arena_at(facts.checkpoint[0]), pointer(facts.arena_address));
  return run(view, start.step, body);
}

}  // namespace greenloop
