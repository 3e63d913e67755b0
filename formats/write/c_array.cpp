#include "formats/write/c_array.hpp"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>

#include "formats/write/c_identifier.hpp"
#include "formats/write/writer.hpp"

namespace greenloop {
namespace {

constexpr std::size_t bytes_per_line = 24;

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
      "/* A Greenloop model file, to be read in place. Little-endian processors only. */\n"
      "#ifndef {0}_MODEL_H\n#define {0}_MODEL_H\n\n#include <stddef.h>\n\n"
      "#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n"
      "extern const unsigned char {0}[{1}]; /* 64-byte aligned */\n"
      "extern const size_t {0}_size;\n\n"
      "#ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
      name, file.size());
  result.source = fmt::format(
      "#include \"{0}\"\n\n#include <stdalign.h>\n\nconst size_t {1}_size = {2};\n\n"
      "alignas(64) const unsigned char {1}[{2}] = {{\n{3}}};\n",
      header_file, name, file.size(), numbers(file));
  return result;
}

void write_c_array(const std::filesystem::path& path, std::span<const std::byte> file) {
  std::filesystem::path header = path, source = path;
  header.replace_extension(".h");
  source.replace_extension(".c");
  const CArray array = c_array(file, identifier_from(path.stem().string()), header.filename().string());
  write_file(header, std::as_bytes(std::span(array.header)));
  write_file(source, std::as_bytes(std::span(array.source)));
}

}  // namespace greenloop
