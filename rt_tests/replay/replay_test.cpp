#include "rt_tests/replay/replay.hpp"
#include "formats/output/output_file.hpp"
#include "formats/testing/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "runtime/greenloop.h"
#include "runtime/recorder.hpp"
#include "runtime/recorder/record.hpp"
#include "runtime/testing/test_body.hpp"
#include "sim_hw/guard/allocation_guard.hpp"
#include "sim_hw/guard/mutex_guard.hpp"

namespace greenloop {
namespace {

constexpr Elastostatic::Limits limits{
    .max_contacts = 12, .cached_factors = 3, .keep_capacitance = true, .glide_cycles = 5};

// memory at an address that no allocator uses again in another process
class Mapped {
 public:
  explicit Mapped(std::size_t size)
      : size_(size), data_(mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
    REQUIRE(data_ != MAP_FAILED);
  }
  explicit Mapped(const std::vector<std::byte>& bytes) : Mapped(bytes.size()) {
    std::memcpy(data_, bytes.data(), bytes.size());
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  ~Mapped() { munmap(data_, size_); }

  [[nodiscard]] std::span<std::byte> span() const { return {static_cast<std::byte*>(data_), size_}; }

 private:
  std::size_t size_;
  void* data_;
};

// a recorded body and what is done to it: contacts, budgets and buffers of every kind, wrong ones among them
class Recorded {
 public:
  explicit Recorded(const Recorder::Options& options, layout::Wavelet wavelet = layout::Wavelet::lifted_linear)
      : file_(encode(synthetic_model({.levels = 4, .wavelet = wavelet}))),
        model_(Model::open(file_.span()).model),
        need_(Elastostatic::required(model_, limits)),
        arena_(need_.bytes) {
    body = Elastostatic::create(model_, limits, arena_.span()).body;
    memory_ = AlignedBytes(Recorder::required(model_, limits, options).bytes);
    const auto created = Recorder::create(model_, limits, arena_.span(), options, {memory_.data(), memory_.size()});
    REQUIRE(created);
    recorder = created.recorder;
    field_ = AlignedBytes(std::size_t{16} * model_.node_count() + 16);
    for (std::uint32_t node = 0; node < model_.node_count(); ++node) {
      if (is_touchable(node)) touchable_.push_back(node);
    }
  }

  // the contacts are made before the guards are armed
  Elastostatic::StepReport step() {
    std::vector<Constraint> contacts(random_() % 14);
    const std::size_t first = random_() % touchable_.size();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto depth = static_cast<float>(random_() % 1000) * 1e-6F;
      contacts[i] = {touchable_[(first + i) % touchable_.size()], {depth, 0, -depth}};
    }
    if (!contacts.empty() && random_() % 16 == 0) contacts[0].node = layout::none;
    const std::uint64_t budget = need_.least_work - 1 + random_() % need_.worst_work[3];
    const std::size_t nodes = random_() % 3 == 0 ? model_.node_count(1) : model_.node_count();
    const std::size_t shift = random_() % 16 == 0 ? 1 : 0;
    force_.resize(3 * contacts.size());
    const std::span<Vec4> field(reinterpret_cast<Vec4*>(field_.data() + sizeof(float) * shift), nodes);
    const Elastostatic::Response response{as_vec3(force_), random_() % 4 == 0 ? std::span<Vec4>() : field};
    allocation_guard::arm();
    mutex_guard::arm();
    const Elastostatic::StepReport report = recorder.step(body, contacts, {budget}, response);
    mutex_guard::disarm();
    allocation_guard::disarm();
    return report;
  }

  [[nodiscard]] std::vector<std::byte> record() const {
    const auto bytes = recorder.record();
    return {bytes.begin(), bytes.end()};
  }
  [[nodiscard]] std::span<const std::byte> file() const { return file_.span(); }

  Elastostatic body;
  Recorder recorder;

 private:
  [[nodiscard]] bool is_touchable(std::uint32_t node) const {
    std::uint32_t q = 0;
    const ModelView& view = model_.view();
    while (node >= model_.node_count(q)) ++q;
    return (view.level[q].nodes[node - view.level[q].node_begin].flags & layout::node_touchable) != 0;
  }

  Mapped file_;
  Model model_;
  Elastostatic::Requirement need_;
  Mapped arena_;
  AlignedBytes memory_;
  AlignedBytes field_;
  std::vector<float> force_;
  std::vector<std::uint32_t> touchable_;
  std::mt19937_64 random_{17};
};

Record& facts_in(std::vector<std::byte>& record) { return *reinterpret_cast<Record*>(record.data()); }

RecordedStep& step_in(std::vector<std::byte>& record, std::uint64_t number) {
  const Record& facts = facts_in(record);
  return *reinterpret_cast<RecordedStep*>(record.data() + facts.steps_offset +
                                          facts.slot_bytes * (number % facts.steps));
}

std::string refusal(const std::vector<std::byte>& record, std::span<const std::byte> model) {
  try {
    static_cast<void>(replay(record, model));
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST_CASE("a recorded step neither allocates nor locks, a checkpoint included") {
  Recorded recorded({.steps = 10, .interval = 7, .field_nodes = 100});
  const std::uint64_t allocations = allocation_guard::count(), locks = mutex_guard::count();
  int answered = 0;
  for (int i = 0; i < 300; ++i) answered += greenloop::answered(recorded.step().status) ? 1 : 0;
  CHECK(allocation_guard::count() == allocations);
  CHECK(mutex_guard::count() == locks);
  CHECK(answered > 100);
  CHECK(answered < 290);
}

TEST_CASE("steps run again in place give the same bits, from the oldest checkpoint that goes with what is kept") {
  layout::Wavelet wavelet{};
  SUBCASE("lifted linear") { wavelet = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { wavelet = layout::Wavelet::equilibrated; }
  Recorded recorded({.steps = 100, .interval = 40, .field_nodes = 1000}, wavelet);
  for (int i = 0; i < 95; ++i) recorded.step();
  Replay again = replay_in_place(recorded.record(), recorded.body);
  CHECK(again.first == 0);  // as it was created
  CHECK(again.steps == 95);
  CHECK(!again.differs);
  for (int i = 95; i < 395; ++i) recorded.step();
  again = replay_in_place(recorded.record(), recorded.body);
  CHECK(again.first == 320);
  CHECK(again.steps == 75);
  CHECK(!again.differs);
  CHECK(!again.unfinished);
}

TEST_CASE("a record from which no step can be run again is refused") {
  Recorded recorded({.steps = 8});
  CHECK_THROWS_WITH(static_cast<void>(replay_in_place(recorded.record(), recorded.body)),
                    "nothing to run again: no step came after the last checkpoint");
  for (int i = 0; i < 30; ++i) recorded.step();
  recorded.recorder.checkpoint();
  CHECK_THROWS_AS(static_cast<void>(replay_in_place(recorded.record(), recorded.body)), std::runtime_error);
}

TEST_CASE("a checkpoint of the caller's choice is one to start from") {
  Recorded recorded({.steps = 50});
  for (int i = 0; i < 120; ++i) {
    if (i == 80 || i == 100) recorded.recorder.checkpoint();
    recorded.step();
  }
  const Replay again = replay_in_place(recorded.record(), recorded.body);
  CHECK(again.first == 80);
  CHECK(again.steps == 40);
  CHECK(!again.differs);
  for (int i = 0; i < 30; ++i) recorded.step();
  CHECK(replay_in_place(recorded.record(), recorded.body).first == 100);
}

TEST_CASE("a flipped bit is found, in a question and in an outcome, at the step that it is of") {
  Recorded recorded({.steps = 100, .interval = 50, .field_nodes = 1000});
  for (int i = 0; i < 149; ++i) recorded.step();
  const std::vector<std::byte> sound = recorded.record();
  std::uint64_t answered = 120;  // a step with forces
  auto record = sound;
  while (step_in(record, answered).status > 1 || step_in(record, answered).contacts == 0) ++answered;
  SUBCASE("digest") { step_in(record, answered).digest ^= 1U << 17; }
  SUBCASE("status") { step_in(record, answered).status ^= 1U; }
  SUBCASE("displacement") {
    auto* const contact = reinterpret_cast<Constraint*>(&step_in(record, answered) + 1);
    reinterpret_cast<unsigned char*>(contact->value)[2] ^= 1U;
  }
  const Replay again = replay_in_place(record, recorded.body);
  CHECK(again.first == 50);
  CHECK(again.differs == answered);
  CHECK(again.steps == answered - 50 + 1);
  CHECK(!replay_in_place(sound, recorded.body).differs);
}

TEST_CASE("records that are damaged or of something else are refused") {
  Recorded recorded({.steps = 20});
  for (int i = 0; i < 10; ++i) recorded.step();
  const auto sound = recorded.record();
  const auto broken = [&](auto change) {
    auto record = sound;
    change(facts_in(record));
    return refusal(record, recorded.file());
  };
  CHECK(broken([](Record& r) { r.magic[0] = 'X'; }) == "no record: bad magic");
  CHECK(broken([](Record& r) { ++r.version; }).find("another version") != std::string::npos);
  CHECK(broken([](Record& r) { ++r.bytes; }).find("cut or extended") != std::string::npos);
  CHECK(broken([](Record& r) { r.steps = 0; }).find("steps do not fit") != std::string::npos);
  CHECK(broken([](Record& r) { r.slot_bytes = ~std::uint64_t{0}; }).find("steps do not fit") != std::string::npos);
  CHECK(broken([](Record& r) { r.checkpoint[2].offset = r.bytes; }).find("checkpoint does not") != std::string::npos);
  CHECK(broken([](Record& r) { ++r.model_crc; }) == "the model is not the recorded body's");
  CHECK(refusal({sound.begin(), sound.begin() + 100}, recorded.file()) == "no record: too short");
  CHECK(refusal(sound, recorded.file()).find("are in use here") != std::string::npos);  // by the body itself
  for (int i = 10; i < 40; ++i) recorded.step();
  CHECK_THROWS_WITH_AS(static_cast<void>(replay_in_place(recorded.record(), recorded.body)),
                       "no checkpoint goes with the steps that are kept: take them more often, or keep more steps",
                       std::runtime_error);
}

TEST_CASE("what a recorder needs is checked") {
  const TestModel model({.levels = 3});
  const std::size_t arena_bytes = Elastostatic::required(model.model(), limits).bytes;
  const auto need = Recorder::required(model.model(), limits, {.steps = 8});
  CHECK(need.checkpoint_bytes == arena_bytes);
  CHECK(need.bytes > 3 * arena_bytes + 8 * sizeof(Constraint) * limits.max_contacts);
  CHECK(Recorder::required(model.model(), limits, {.steps = 0}).bytes == 0);
  AlignedBytes arena(arena_bytes), memory(need.bytes + 64);
  const auto create = [&](std::span<const std::byte> of, std::span<std::byte> in, std::uint32_t steps) {
    return Recorder::create(model.model(), limits, of, {.steps = steps}, in);
  };
  const std::span<std::byte> all(memory.data(), memory.size());
  CHECK(create(arena.span(), all, 0).error == Recorder::Error::bad_options);
  CHECK(create(arena.span().first(arena_bytes - 1), all, 8).error == Recorder::Error::bad_body);
  const auto small = create(arena.span(), all.first(need.bytes - 1), 8);
  CHECK(small.error == Recorder::Error::memory_too_small);
  CHECK(small.missing == 1);
  CHECK(create(arena.span(), all.subspan(8, need.bytes), 8).error == Recorder::Error::memory_misaligned);
  CHECK(create(arena.span(), all.first(need.bytes), 8));
}

TEST_CASE("steps recorded in C are run again, and every error has a text of its own") {
  const AlignedBytes file(encode(synthetic_model({.levels = 3})));
  greenloop_model model;
  REQUIRE(greenloop_open(file.data(), file.size(), &model).rule == GREENLOOP_RULE_OK);
  greenloop_elastostatic_limits of_body{};
  of_body.max_contacts = 4;
  of_body.cached_factors = 2;
  const greenloop_recorder_options options{.steps = 30, .interval = 0, .field_nodes = 10};
  AlignedBytes arena(greenloop_elastostatic_required(&model, of_body).bytes);
  AlignedBytes memory(greenloop_recorder_required(&model, of_body, options));
  const auto body = greenloop_elastostatic_create(&model, of_body, arena.data(), arena.size());
  REQUIRE(body.error == GREENLOOP_CREATE_OK);
  const auto create = [&](greenloop_recorder_options with, std::size_t bytes) {
    return greenloop_recorder_create(&model, of_body, arena.data(), arena.size(), with, memory.data(), bytes);
  };
  CHECK(create({.steps = 0, .interval = 0, .field_nodes = 0}, memory.size()).error == GREENLOOP_RECORDER_BAD_OPTIONS);
  const auto small = create(options, memory.size() - 64);
  CHECK(small.error == GREENLOOP_RECORDER_MEMORY_TOO_SMALL);
  CHECK(small.missing == 64);
  CHECK(small.recorder == nullptr);
  const auto created = create(options, memory.size());
  REQUIRE(created.error == GREENLOOP_RECORDER_OK);
  std::uint32_t node = 0;
  while (greenloop_is_touchable(&model, node) == 0) ++node;
  for (int i = 0; i < 40; ++i) {
    if (i == 20) greenloop_recorder_checkpoint(created.recorder);
    const greenloop_constraint contact{node, {0, 0, static_cast<float>(i) * 1e-5F}, GREENLOOP_HOLD};
    float force[3];
    const auto report = greenloop_recorder_step(created.recorder, body.body, &contact, 1,
                                                static_cast<std::uint64_t>(1) << 60, force, nullptr, 0);
    REQUIRE(greenloop_answered(report.status) == 1);
  }
  std::size_t bytes = 0;
  const auto* const record = static_cast<const std::byte*>(greenloop_recorder_record(created.recorder, &bytes));
  auto same = std::bit_cast<Elastostatic>(reinterpret_cast<Body*>(body.body));
  const Replay again = replay_in_place({record, bytes}, same);
  CHECK(again.first == 20);
  CHECK(again.steps == 20);
  CHECK(!again.differs);
  std::set<std::string> texts;
  for (int error = GREENLOOP_RECORDER_OK; error <= GREENLOOP_RECORDER_MEMORY_MISALIGNED; ++error) {
    texts.insert(greenloop_recorder_error_text(static_cast<greenloop_recorder_error>(error)));
  }
  CHECK(texts.size() == GREENLOOP_RECORDER_MEMORY_MISALIGNED + 1);
}

int exit_status(const std::string& command) {
  const int status = std::system(command.c_str());
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

TEST_CASE("another process gives the same bits, and finds a flipped one") {
  layout::Wavelet wavelet{};
  SUBCASE("lifted linear") { wavelet = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { wavelet = layout::Wavelet::equilibrated; }
  Recorded recorded({.steps = 100, .interval = 40, .field_nodes = 1000}, wavelet);
  for (int i = 0; i < 230; ++i) recorded.step();
  const TemporaryFolder folder("replay_test");
  const auto model = folder.path() / "body.gloop", record = folder.path() / "body.record";
  write_file(model, recorded.file());
  auto bytes = recorded.record();
  const auto run = [&] {
    write_file(record, bytes);
    return exit_status(fmt::format("{} {} {} >/dev/null", GREENLOOP_REPLAY, record.string(), model.string()));
  };
  CHECK(run() == 0);
  step_in(bytes, 200).digest ^= 1;
  CHECK(run() == 1);
  step_in(bytes, 200).digest ^= 1;
  step_in(bytes, 229).finished = 0;  // as if the process had died in it
  CHECK(run() == 0);
  bytes.pop_back();
  CHECK(run() == 1);
}

}  // namespace
}  // namespace greenloop
