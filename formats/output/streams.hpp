#pragma once

#include <string_view>

namespace greenloop {

/// To be called first in a program. Standard streams that are closed get a place holder that cannot be written, so that
/// no file of ours takes their number and receives what is printed; a reader that has gone away and a limit of file
/// size make writes fail (EPIPE, EFBIG) instead of ending the program.
void prepare_streams();

/// Progress, warnings and errors, to standard error. Lost in silence if they cannot be written: nothing hangs on them.
/// Shown as `printable` says.
void say(std::string_view text) noexcept;

/// The same without that: for what moves a terminal's cursor and holds nothing from outside.
void say_raw(std::string_view text) noexcept;

/// A part of the result, to standard output, shown as `printable` says; what cannot be written is an error, here or in
/// finish_results. Throws std::runtime_error.
void print_result(std::string_view text);

/// To be called last: everything that went to standard output, by whatever way, is written and the stream closed.
/// Throws std::runtime_error if any of it was lost and print_result has not said so.
void finish_results();

}  // namespace greenloop
