#include "offline/scene/toml_source.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <system_error>

#include "offline/scene/scene.hpp"
#include "offline/scene/toml_letters.hpp"
#include "offline/scene/toml_table.hpp"

namespace greenloop::offline {
namespace {

std::string line_of(std::string_view text, std::size_t number) {
  for (; number > 1 && !text.empty(); --number) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return std::string(text.substr(0, text.find('\n')));
}

std::string trimmed(const std::string& text) {
  constexpr std::string_view blanks = " \t\r";
  const auto begin = text.find_first_not_of(blanks);
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// How to mend a line whose value lacks its quotes; empty if that is not what is wrong with it.
std::string lacking_quotes(const std::string& line) {
  const auto equals = line.find('=');
  if (equals == std::string::npos) return {};
  const std::string value = trimmed(line.substr(equals + 1, line.find('#', equals) - equals - 1));
  const bool has_letters =
      std::any_of(value.begin(), value.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  if (!has_letters || value.find_first_of("\"'[]{}") != std::string::npos) return {};
  std::string hint = "; words, and numbers with a unit, stand in quotes: ";
  return hint.append(trimmed(line.substr(0, equals))).append(" = \"").append(value).append("\"");
}

}  // namespace

std::string scene_file_text(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw SceneError({file.string() + ": no file, but a folder, a pipe or a device; write the scene to a file"});
  }
  const auto size = std::filesystem::file_size(file, error);
  if (!error && size > largest_scene_file) {
    throw SceneError({file.string() + ": " + std::to_string(size) + " bytes; a scene has at most " +
                      std::to_string(largest_scene_file)});
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!stream) {
    throw SceneError({file.string() + ": cannot be read"});
  }
  return text;
}

toml::table parse_toml(std::string_view text, const std::filesystem::path& file) {
  if (const auto at = unquoted_letter(text)) {
    Problems problems(file.string());
    problems.add({at->line, at->column}, "",
                 "a letter beyond ASCII stands outside of quotes: put quotes around the text");
    problems.throw_if_any();
  }
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    Problems problems(file.string());
    const auto& where = error.source().begin;
    problems.add(where, "", std::string(error.description()) + lacking_quotes(line_of(text, where.line)));
    problems.throw_if_any();
    throw;
  }
}

std::filesystem::path beside(const std::filesystem::path& scene_file, const std::string& name) {
  return (scene_file.parent_path() / name).lexically_normal();
}

}  // namespace greenloop::offline
