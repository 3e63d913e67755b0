#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

namespace CLI {
class App;
}

namespace greenloop::offline {

/// `greenloop convert INPUT -o OUTPUT [--levels N]`
struct ConvertArguments {
  std::filesystem::path input, output;
  std::optional<std::uint32_t> levels;  ///< of a model: keep the N coarsest mesh levels
};

/// Converts by the files' extensions: a model (.gloop) to its transport form (.gloopz) and back, either to C source (.h
/// or .c: both are written), to its undeformed surface, or, with `levels`, to a coarser model; a surface (.off .obj
/// .stl .ply) to another surface format; a volume of tetrahedra (.msh .mesh .vtk .vtu .node .ele .veg) to .msh, .mesh
/// or .vtk. Of a truncated transport form `levels` gives the levels that are whole; without it the form is refused.
/// Says on `out` what was written and returns the exit code. Throws std::runtime_error or std::invalid_argument naming
/// the file and the reason.
int run_convert(const ConvertArguments& arguments, std::ostream& out);

/// Adds the command; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_convert(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
