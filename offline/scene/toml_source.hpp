#pragma once

// From a file to a TOML table. Only parsers of scenes include this.
#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace greenloop::offline {

/// The bytes of a regular file of at most largest_scene_file bytes. Throws SceneError.
[[nodiscard]] std::string scene_file_text(const std::filesystem::path& file);

/// `file` is for messages. Throws SceneError with place and remedy.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::filesystem::path& file);

/// A file that a scene names, looked for beside the scene.
[[nodiscard]] std::filesystem::path beside(const std::filesystem::path& scene_file, const std::string& name);

}  // namespace greenloop::offline
