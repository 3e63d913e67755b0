#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace greenloop {

/// A file of a command and what it is to it, as in {"the mesh", "cube.obj"}.
struct NamedPath {
  std::string what;
  std::filesystem::path path;
};

/// All files of one command, to be checked before it works.
struct CommandFiles {
  std::vector<NamedPath> inputs;   ///< that are read; may be absent
  std::vector<NamedPath> outputs;  ///< that are written, also those that are read before, such as stores
};

/// Throws std::runtime_error, naming both, if an output is an input, another output or where standard output goes,
/// through links and for files that are not there yet; or naming it, with the reason and the remedy, if it is a folder,
/// if its folder is absent or nothing can be made there, or if it exists and may not be written. Devices such as
/// /dev/null may be named twice.
void require_writable(const CommandFiles& files);

/// The same for a folder that is to receive files: it must be there, or one that can be made.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace greenloop
