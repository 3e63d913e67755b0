#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rt_tests/fuzz/byte_mutator.hpp"

namespace greenloop {

/// A way by which bytes from outside come in.
class Door {
 public:
  Door() = default;
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;
  virtual ~Door() = default;

  /// Makes an input out of `random` alone and tries it: whether it was taken. Ends the program if that does harm.
  virtual bool try_one(Random& random) = 0;
};

[[nodiscard]] std::unique_ptr<Door> mesh_door();       ///< surfaces and volumes of all formats
[[nodiscard]] std::unique_ptr<Door> scene_door();      ///< scene.toml: read, written out, read again
[[nodiscard]] std::unique_ptr<Door> model_door();      ///< model files: verify, the view, what a body would take
[[nodiscard]] std::unique_ptr<Door> transport_door();  ///< transport streams
[[nodiscard]] std::unique_ptr<Door> store_door();      ///< HDF5 stores, changed through the library
[[nodiscard]] std::unique_ptr<Door> report_door();     ///< traces, snapshots, build records and provenance

/// Says `what` and aborts unless `right`.
void require_right(bool right, const char* what);

}  // namespace greenloop
