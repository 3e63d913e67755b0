#pragma once

namespace CLI {
class App;
}

namespace greenloop::offline {

/// Adds `report MODEL [-o FILE] [--trace FILE] [--snapshot FILE] [--build FILE] [--figures DIR] [--json]` to the
/// program. `exit_code` must outlive `parent`'s parse; it is set to 0 when the report is written. Running it throws
/// std::runtime_error if an input is wrong or an output cannot be written.
void add_report(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
