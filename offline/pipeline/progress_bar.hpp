#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace greenloop::offline {

/// What a finished stage cost, for the build's report.
struct FinishedStage {
  std::string name;
  double seconds = 0;  ///< wall time
};

/// Tells people on standard error how far a long computation is: a bar with the remaining time on a terminal, one line
/// a stage elsewhere, and one every half minute meanwhile, nothing when quiet. Not thread-safe; offline only.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);

  /// Ends the stage under way, if any, and starts the next.
  void begin(std::string_view stage);

  /// How much of the stage is done, 0..1; cheap enough to be called often.
  void update(double fraction, std::string_view detail = {});

  /// Ends the stage under way with a short note of what came out.
  void end(std::string_view note = {});

  /// Says what people should know about the result, also when quiet; between stages.
  void warn(const std::string& what);

  [[nodiscard]] const std::vector<FinishedStage>& stages() const { return stages_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  using Clock = std::chrono::steady_clock;

  void draw(double fraction, std::string_view detail);

  bool quiet_;
  bool terminal_;
  bool running_ = false;
  std::string stage_;
  double first_fraction_ = -1;  ///< where a resumed stage started, so that the remaining time is honest
  Clock::time_point started_, drawn_;
  std::vector<FinishedStage> stages_;
  std::vector<std::string> warnings_;
};

}  // namespace greenloop::offline
