#pragma once

namespace CLI {
class App;
}

namespace greenloop::offline {

/// Adds `greenloop simulate`; it sets `exit_code` when it runs. Both must outlive the parsing.
void add_simulate(CLI::App& parent, int& exit_code);

}  // namespace greenloop::offline
