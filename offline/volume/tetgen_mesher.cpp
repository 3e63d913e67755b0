#include "offline/volume/tetgen_mesher.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "greenloop-tetgen-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot create the folder " + pattern);
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write_smesh(const TriangleMesh& surface, const fs::path& file) {
  std::ofstream out(file);
  out.precision(std::numeric_limits<double>::max_digits10);
  out << surface.vertices.size() << " 3 0 0\n";
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const auto& x = surface.vertices[v];
    out << v << ' ' << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  }
  out << surface.triangles.size() << " 0\n";
  for (const auto& t : surface.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  out << "0\n0\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string() + "; is the disk full?");
}

/// -p fill the surface, -Y keep it as it is, -q1.4 grade the inside by quality, -z count from 0, -Q be quiet.
int run_tetgen(const fs::path& input) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::string program = "tetgen", options = "-pYq1.4zQ", file = input.string();
  char* const arguments[] = {program.data(), options.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "tetgen", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start the program tetgen");
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("lost the program tetgen");
  return status;
}

/// The numbers of a TetGen file's data lines behind its header; comment lines start with '#'.
template <typename Row, typename Accept>
void read_rows(const fs::path& file, Accept accept) {
  std::ifstream in(file);
  std::string line;
  std::size_t expected = 0, found = 0;
  bool header = true;
  while (std::getline(in, line)) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    std::istringstream numbers(line);
    if (std::exchange(header, false)) {
      numbers >> expected;
      continue;
    }
    std::size_t index = 0;
    Row row;
    numbers >> index;
    for (auto& value : row) numbers >> value;
    if (!numbers) throw std::runtime_error("tetgen: cannot read line '" + line + "' of " + file.string());
    accept(row);
    ++found;
  }
  if (header || found != expected) {
    throw std::runtime_error("tetgen: " + file.string() + " holds " + std::to_string(found) + " rows instead of " +
                             std::to_string(expected));
  }
}

TetrahedralMesh read_result(const TriangleMesh& surface, const fs::path& stem) {
  TetrahedralMesh mesh;
  read_rows<std::array<double, 3>>(stem.string() + ".1.node",
                                   [&](const auto& x) { mesh.vertices.emplace_back(x[0], x[1], x[2]); });
  if (mesh.vertices.size() < surface.vertices.size()) {
    throw std::runtime_error("tetgen removed surface vertices; are some of them at the same place?");
  }
  std::copy(surface.vertices.begin(), surface.vertices.end(), mesh.vertices.begin());
  // TetGen's orientation is the opposite of ours
  read_rows<std::array<int, 4>>(stem.string() + ".1.ele", [&](const auto& t) {
    mesh.tetrahedra.push_back({t[0], t[2], t[1], t[3]});
  });
  return mesh;
}

}  // namespace

bool tetgen_is_installed() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  std::string folder;
  while (std::getline(folders, folder, ':')) {
    if (access((fs::path(folder) / "tetgen").c_str(), X_OK) == 0) return true;
  }
  return false;
}

TetrahedralMesh mesh_with_tetgen(const TriangleMesh& surface) {
  const TemporaryFolder folder;
  const auto stem = folder.path() / "surface";
  write_smesh(surface, stem.string() + ".smesh");
  const int status = run_tetgen(stem.string() + ".smesh");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error("the program tetgen failed (wait status " + std::to_string(status) +
                             "); this happens when surface triangles intersect each other");
  }
  return read_result(surface, stem);
}

}  // namespace greenloop::offline
