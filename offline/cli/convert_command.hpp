#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

namespace CLI {
class App;
}

namespace greenloop::offline {

/// `greenloop convert INPUT -o OUTPUT [--levels N] [--ready | --no-ready] [--json]`
struct ConvertArguments {
  std::filesystem::path input, output;
  std::optional<std::uint32_t> levels;  ///< of a model: keep the N coarsest mesh levels
  std::optional<bool> ready =
      std::nullopt;  ///< of a model: with or without what a loop would make at its start; none: as is
  bool json = false;
};

/// Converts by the files' extensions: a model (.gloop) to its transport form (.gloopz) and back, either to C source (.h
/// or .c: both are written), to its undeformed surface, with `levels` to a coarser model, with `ready` to one that is
/// ready for a loop or, if false, not; a transport form never is, a coarser model only if asked for. A surface (.off
/// .obj .stl .ply) to another surface format; a volume of tetrahedra (.msh .mesh .meshb .vtk .vtu .node .ele .veg) to
/// .msh, .mesh or .vtk. Of a truncated transport form `levels` gives the levels that are whole; without it the form is
/// refused. Says on `out` what was written and returns the exit code. Throws std::runtime_error or
/// std::invalid_argument naming the file and the reason.
int run_convert(const ConvertArguments& arguments, std::ostream& out);

/// Adds the command; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_convert(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
