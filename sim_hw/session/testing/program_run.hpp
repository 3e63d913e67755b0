#pragma once

#include <string>
#include <vector>

namespace greenloop {

/// What a program left behind.
struct ProgramRun {
  int exit_status = -1;  ///< -1: it was ended by a signal
  std::string output;
  std::string errors;
};

/// Runs `program` to its end. With `deny_namespaces` the system refuses it every new namespace, as containers do.
/// For tests only. Throws std::runtime_error if the program cannot be started.
[[nodiscard]] ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments,
                                     bool deny_namespaces = false);

}  // namespace greenloop
