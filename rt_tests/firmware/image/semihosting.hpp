#pragma once

#include <cstdint>

namespace greenloop::firmware {

// Through the debugger, or the emulator: Arm's "Semihosting for AArch32 and AArch64", version 3.0.

/// Writes text to the host's console.
void print(const char* text);
void print(std::uint64_t number);
void print_hexadecimal(std::uint64_t number);

/// Whether the host's command line contains `word`.
[[nodiscard]] bool command_line_contains(const char* word);

/// Ends the emulation with this exit status.
[[noreturn]] void exit_with(int status);

}  // namespace greenloop::firmware
