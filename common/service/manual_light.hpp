/// A uniform light that an operator sets, with priority over the experiment's light script.
#pragma once

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <optional>
#include <string>

namespace lab {

/// Makes the light commands (LIGHT_COMMAND) of an operator. It has neither bus nor clock: the
/// caller publishes due(). Times are us since 1970.
class ManualLight {
 public:
  /// @param intensity [1] 0..1
  /// @param hold [s] after which the light is released, 0: until release()
  void show(double intensity, double hold, const std::string& label, std::int64_t now);
  void release();

  /// The command that must be sent now, with an empty header except for seq. It is sent at once and
  /// then at 2 Hz. A release is sent three times, because a message may be lost.
  [[nodiscard]] std::optional<light_command_t> due(std::int64_t now);

  [[nodiscard]] bool isShown() const { return showing_; }

  /// The seq of the current command.
  [[nodiscard]] std::int64_t seq() const { return command_.seq; }

 private:
  light_command_t command_{};
  std::int64_t until_utime_ = 0;  ///< 0: until release()
  std::int64_t sent_utime_ = 0;
  int remaining_releases_ = 0;  ///< release messages still to be sent
  bool showing_ = false;
};

}  // namespace lab
