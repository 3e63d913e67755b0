// For the C++ programs here: the bytes of a model file.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

/// The file, aligned as Model::open wants it; it is kept until the program ends.
inline std::span<const std::byte> read_model(const char* path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
  auto* const memory = static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64));
  std::memcpy(memory, bytes.data(), bytes.size());
  return {memory, bytes.size()};
}
