/// Common parts of the simulated camera in memory and the one in shared memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/camera/cameras.hpp"

namespace lab::cameras {

inline constexpr const char* kSimGone =
    "sim: the simulated camera is gone; waiting until sim_svc offers it again";
inline constexpr const char* kSimAbsent =
    "sim: no process offers the simulated camera; sim_svc of the same lab does, if its "
    "experiment has tracker = \"camera\" and camera = \"sim\"";
inline constexpr const char* kSimTaken =
    "sim: the simulated camera of this lab is offered already; end the other sim_svc, or take "
    "another --ports folder";

/// The format that readers of a simulated camera see.
[[nodiscard]] inline CameraFormat paintedFormat(CameraFormat format) {
  format.pixels = "GREY (painted)";
  format.locked = true;
  return format;
}

/// @throws CameraError if frames of this size cannot be painted
inline void checkPaintable(const CameraFormat& format) {
  constexpr int kMost = 16'384;
  if (format.width >= 1 && format.width <= kMost && format.height >= 1 && format.height <= kMost) {
    return;
  }
  throw CameraError("sim: found " + std::to_string(format.width) + " x " +
                    std::to_string(format.height) + " pixels, allowed 1 to " +
                    std::to_string(kMost) + " each way");
}

/// Why the painted frames do not have the requested size; empty if they have.
[[nodiscard]] inline std::string sizeTrouble(const CameraFormat& wanted,
                                             const CameraFormat& painted) {
  const bool fits = (wanted.width == 0 || wanted.width == painted.width) &&
                    (wanted.height == 0 || wanted.height == painted.height);
  if (fits) return {};
  return "sim: paints " + std::to_string(painted.width) + " x " + std::to_string(painted.height) +
         " pixels, wanted are " + std::to_string(wanted.width) + " x " +
         std::to_string(wanted.height) + "; give both processes the same experiment";
}

/// Counts missing frames from gaps in the numbers.
class GapCounter {
 public:
  void add(std::int64_t number) {
    if (last_ && number > *last_ + 1) missing_ += number - *last_ - 1;
    last_ = number;
  }
  /// The next number starts a new sequence.
  void restart() { last_.reset(); }
  [[nodiscard]] std::int64_t missing() const { return missing_; }

 private:
  std::optional<std::int64_t> last_;
  std::int64_t missing_ = 0;
};

}  // namespace lab::cameras
