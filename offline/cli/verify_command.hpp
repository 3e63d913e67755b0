#pragma once

#include <filesystem>
#include <iosfwd>

namespace CLI {
class App;
}

namespace greenloop::offline {

/// `greenloop verify MODEL [--certificate] [--json]`
struct VerifyArguments {
  std::filesystem::path file;
  bool certificate = false;  ///< also prove that the compliance is positive definite
  bool json = false;
};

/// Prints whether a model file is valid and, if not, the first rule it breaks, where, and how to mend it.
/// Returns 0 if the file is valid (and its certificate holds, if asked), 1 if it is not or cannot be read.
int run_verify(const VerifyArguments& arguments, std::ostream& out);

/// Adds the command; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_verify(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
