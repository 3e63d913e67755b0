// Coverage-guided fuzzing of the verifier: verify_fuzz FOLDER, where FOLDER holds files to start from
// (write_synthetic_models FOLDER). Built by the option GREENLOOP_BUILD_FUZZERS.

#include <cstddef>
#include <cstdint>
#include <span>

#include "rt_tests/fuzz/walk_view.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  greenloop::try_input(std::as_bytes(std::span(data, size)));
  return 0;
}
