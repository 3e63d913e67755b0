#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace greenloop {

/// "greenloop 0.2.0": the one version of all programs.
[[nodiscard]] std::string program_version();

/// The main of every program: adds --version to `app`, reads the command line, runs `run` and sees to it that its
/// results were written. Whatever is thrown is said on standard error. Returns the exit status: what `run` returns (0:
/// what was asked for holds, 1: it does not), 1 if it fails or its results are lost, 2 if the command line is wrong.
/// `run` may be empty if the commands of `app` do the work while they are parsed and leave the status in `status`.
[[nodiscard]] int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace greenloop
