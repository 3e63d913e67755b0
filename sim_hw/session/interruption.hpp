#pragma once

namespace greenloop {

/// From now on INT, TERM and HUP end a session in good order, with its records and its verdict; a second one ends the
/// program.
void await_interruption();

/// The signal that came; 0: none.
[[nodiscard]] int interruption() noexcept;

}  // namespace greenloop
