#pragma once

namespace CLI {
class App;
}

namespace greenloop::offline {

/// Adds `build SCENE [-o MODEL] [--store FILE] [--overwrite-store] [--force] [--json]` to the program. `exit_code` must
/// outlive `parent`'s parse; it is set to 0 when the model is written or up to date. Running it throws when the scene,
/// its mesh or what it asks for will not do.
void add_build(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
