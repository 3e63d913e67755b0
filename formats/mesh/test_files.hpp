#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>

#include "formats/mesh/mesh_text.hpp"

namespace greenloop {

/// A folder for one test executable, emptied at its start.
inline std::filesystem::path scratch_folder(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / ("greenloop_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// The path of a fetched test mesh.
inline std::filesystem::path fetched(const std::string& name) {
  const char* data = std::getenv("GREENLOOP_DATA");
  REQUIRE_MESSAGE(data != nullptr, "GREENLOOP_DATA is not set; run the tests through ctest");
  return std::filesystem::path(data) / name;
}

/// `read` throws a MeshFileError whose message contains `piece`.
template <typename Read>
void check_refused(const Read& read, std::string_view piece) {
  std::string message = "accepted";
  try {
    static_cast<void>(read());
  } catch (const MeshFileError& error) {
    message = error.what();
  }
  CAPTURE(message);
  CAPTURE(std::string(piece));
  CHECK(message.find(piece) != std::string::npos);
}

/// Feeds `read` damaged copies of a good file: cut short, bytes changed, numbers blown up. Each has to be read or
/// refused by a MeshFileError; anything else (a crash, another exception) fails. Returns how many were refused.
template <typename Read>
int count_refused_mutants(const std::string& good, std::uint64_t seed, int mutants, const Read& read) {
  std::mt19937_64 random(seed);
  constexpr std::string_view pieces[] = {"-1", "999999999999", "2147483647", "nan", "1e400", "#", "\n", " ", "0", "\0"};
  int refused = 0;
  for (int i = 0; i < mutants; ++i) {
    auto bad = good;
    const auto at = random() % good.size();
    switch (random() % 4) {
      case 0:
        bad.resize(at);
        break;
      case 1:
        bad[at] = static_cast<char>(random());
        break;
      case 2:
        bad.erase(at, 1 + random() % 20);
        break;
      default:
        bad.replace(at, 1, pieces[random() % std::size(pieces)]);
    }
    try {
      static_cast<void>(read(bad));
    } catch (const MeshFileError&) {
      ++refused;
    }
  }
  return refused;
}

}  // namespace greenloop
