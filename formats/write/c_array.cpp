#include "formats/write/c_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "formats/output/output_file.hpp"
#include "formats/write/c_identifier.hpp"

namespace greenloop {
namespace {

constexpr std::size_t bytes_per_line = 24;
constexpr std::string_view header_begin = "/* A Greenloop model file, to be read in place";

std::string source_begin(std::string_view header_file) {
  return fmt::format("#include \"{}\"\n\n#include <stdalign.h>\n\n", header_file);
}

std::string numbers(std::span<const std::byte> file) {
  std::string text;
  text.reserve(4 * file.size());
  for (std::size_t i = 0; i < file.size(); ++i) {
    fmt::format_to(std::back_inserter(text), "{},", std::to_integer<unsigned>(file[i]));
    if (i % bytes_per_line == bytes_per_line - 1) text += '\n';
  }
  return text;
}

}  // namespace

CArray c_array(std::span<const std::byte> file, std::string_view name, std::string_view header_file) {
  if (!is_identifier(name)) {
    throw std::invalid_argument(fmt::format("C array: \"{}\" is not a C identifier; use letters, digits and _", name));
  }
  CArray result;
  result.header = fmt::format(
      "{2}. Little-endian processors only. */\n"
      "#ifndef {0}_MODEL_H\n#define {0}_MODEL_H\n\n#include <stddef.h>\n\n"
      "#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n"
      "extern const unsigned char {0}[{1}]; /* 64-byte aligned */\n"
      "extern const size_t {0}_size;\n\n"
      "#ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
      name, file.size(), header_begin);
  result.source = fmt::format(
      "{0}const size_t {1}_size = {2};\n\n"
      "alignas(64) const unsigned char {1}[{2}] = {{\n{3}}};\n",
      source_begin(header_file), name, file.size(), numbers(file));
  return result;
}

CArrayFiles c_array_files(const std::filesystem::path& path) {
  CArrayFiles files{path, path};
  files.header.replace_extension(".h");
  files.source.replace_extension(".c");
  return files;
}

void require_replaceable(const std::filesystem::path& path) {
  const auto [header, source] = c_array_files(path);
  const std::string name = header.filename().string();
  if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == '"' || c == '\\'; })) {
    throw std::runtime_error(
        fmt::format("{}: C can include no file with a quote, a backslash or a control character in its name; name "
                    "another output",
                    path.string()));
  }
  for (const auto& [unasked, begin] :
       {std::pair(header, std::string(header_begin)), std::pair(source, source_begin(header.filename().string()))}) {
    if (unasked == path || !std::filesystem::is_regular_file(unasked)) continue;
    std::string found(begin.size(), '\0');
    std::ifstream(unasked, std::ios::binary).read(found.data(), static_cast<std::streamsize>(found.size()));
    if (found == begin) continue;
    throw std::runtime_error(
        fmt::format("{}: would be written beside {}, but a file that is no model stands there; name another output",
                    unasked.string(), path.string()));
  }
}

void write_c_array(const std::filesystem::path& path, std::span<const std::byte> file) {
  const auto [header, source] = c_array_files(path);
  const CArray array = c_array(file, identifier_from(path.stem().string()), header.filename().string());
  OutputFile source_file(source), header_file(header);
  source_file.write(std::as_bytes(std::span(array.source)));
  header_file.write(std::as_bytes(std::span(array.header)));
  // both are written before either is there
  source_file.close();
  header_file.close();
}

}  // namespace greenloop
