#include <bit>
#include <cstddef>
#include <type_traits>

#include "runtime/c_values.hpp"
#include "runtime/recorder.hpp"

namespace greenloop {
namespace {

static_assert(same(GREENLOOP_RECORDER_OK, Recorder::Error::none) &&
              same(GREENLOOP_RECORDER_BAD_OPTIONS, Recorder::Error::bad_options) &&
              same(GREENLOOP_RECORDER_BAD_BODY, Recorder::Error::bad_body) &&
              same(GREENLOOP_RECORDER_MEMORY_TOO_SMALL, Recorder::Error::memory_too_small) &&
              same(GREENLOOP_RECORDER_MEMORY_MISALIGNED, Recorder::Error::memory_misaligned));
static_assert(sizeof(Recorder) == sizeof(void*) && std::is_trivially_copyable_v<Recorder>);

Recorder recorder_of(const greenloop_recorder* recorder) {
  return std::bit_cast<Recorder>(reinterpret_cast<const Record*>(recorder));
}

Recorder::Options options_of(greenloop_recorder_options options) {
  return {.steps = options.steps, .interval = options.interval, .field_nodes = options.field_nodes};
}

constexpr const char* error_texts[] = {
    "the recorder was created",
    "the options are out of range: at least one step is kept",
    "the arena is not one of a body of this model and these limits",
    "the memory is too small: give it as many bytes as were requested",
    "the memory is not 64-byte aligned",
};

}  // namespace
}  // namespace greenloop

using namespace greenloop;

size_t greenloop_recorder_required(const greenloop_model* model, greenloop_elastostatic_limits limits,
                                   greenloop_recorder_options options) {
  return Recorder::required(model_in(model), limits_of(limits), options_of(options)).bytes;
}

greenloop_recorder_created greenloop_recorder_create(const greenloop_model* model, greenloop_elastostatic_limits limits,
                                                     const void* arena, size_t arena_bytes,
                                                     greenloop_recorder_options options, void* memory, size_t bytes) {
  const auto created =
      Recorder::create(model_in(model), limits_of(limits), {static_cast<const std::byte*>(arena), arena_bytes},
                       options_of(options), {static_cast<std::byte*>(memory), bytes});
  return {static_cast<greenloop_recorder_error>(created.error), created.requested, created.available, created.missing,
          reinterpret_cast<greenloop_recorder*>(std::bit_cast<Record*>(created.recorder))};
}

greenloop_elastostatic_report greenloop_recorder_step(greenloop_recorder* recorder, greenloop_elastostatic* body,
                                                      const greenloop_constraint* contacts, size_t count, uint64_t work,
                                                      float* force, float* displacement, uint32_t nodes) {
  Elastostatic stepped = body_in(body);
  return report_of(recorder_of(recorder).step(stepped, constraints_of(contacts, count), {work},
                                              response_of(count, force, displacement, nodes)));
}

void greenloop_recorder_checkpoint(greenloop_recorder* recorder) { recorder_of(recorder).checkpoint(); }

const void* greenloop_recorder_record(const greenloop_recorder* recorder, size_t* bytes) {
  const std::span<const std::byte> record = recorder_of(recorder).record();
  *bytes = record.size();
  return record.data();
}

const char* greenloop_recorder_error_text(greenloop_recorder_error error) {
  const auto index = static_cast<std::size_t>(error);
  return index < sizeof error_texts / sizeof *error_texts ? error_texts[index] : "unknown";
}
