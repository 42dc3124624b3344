/// One light for the whole arena, set by hand above the experiment's script: no bus, no clock.
#pragma once

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <optional>
#include <string>

namespace lab {

class ManualLight {
 public:
  /// @param intensity [1] 0..1
  /// @param hold [s] after which it is given back, 0: until release()
  void show(double intensity, double hold, const std::string& label, std::int64_t now);
  void release();

  /// What is to be sent now, header left empty but for seq: at once, then at 2 Hz, and when it is
  /// given back three times that it is, as one may be lost.
  [[nodiscard]] std::optional<light_command_t> due(std::int64_t now);

  [[nodiscard]] bool isShown() const { return showing_; }

  /// Of the command that is sent now.
  [[nodiscard]] std::int64_t seq() const { return command_.seq; }

 private:
  light_command_t command_{};
  std::int64_t until_utime_ = 0;  ///< 0: for good
  std::int64_t sent_utime_ = 0;
  int remaining_releases_ = 0;  ///< that are still to be sent
  bool showing_ = false;
};

}  // namespace lab
