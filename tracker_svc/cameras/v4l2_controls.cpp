#include "tracker_svc/cameras/v4l2_controls.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace lab::cameras {
namespace {

constexpr double kExposureUnit = 1e-4;  // [s] of V4L2_CID_EXPOSURE_ABSOLUTE

/// A control of an automatic adjustment, and its value for "off".
struct Automatic {
  std::uint32_t id;
  int off;
};

constexpr std::array<Automatic, 7> kAutomatic = {{
    {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0},
    {V4L2_CID_AUTOGAIN, 0},
    {V4L2_CID_AUTO_WHITE_BALANCE, 0},
    {V4L2_CID_AUTOBRIGHTNESS, 0},
    {V4L2_CID_HUE_AUTO, 0},
    {V4L2_CID_FOCUS_AUTO, 0},
}};

class Controls {
 public:
  Controls(V4l2Calls& calls, int device) : calls_(calls), device_(device) {}

  /// Empty if the device has no such control.
  [[nodiscard]] std::optional<v4l2_queryctrl> limits(std::uint32_t id) const {
    v4l2_queryctrl query{};
    query.id = id;
    if (calls_.ioctl(device_, VIDIOC_QUERYCTRL, &query) < 0) return {};
    if ((query.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return {};
    return query;
  }
  [[nodiscard]] std::optional<int> get(std::uint32_t id) const {
    v4l2_control control{id, 0};
    if (calls_.ioctl(device_, VIDIOC_G_CTRL, &control) < 0) return {};
    return control.value;
  }
  /// Sets a value, clamped to the limits. @return the value read back
  std::optional<int> set(std::uint32_t id, int value) const {
    const std::optional<v4l2_queryctrl> allowed = limits(id);
    if (!allowed) return {};
    v4l2_control control{id, std::clamp(value, allowed->minimum, allowed->maximum)};
    static_cast<void>(calls_.ioctl(device_, VIDIOC_S_CTRL, &control));
    return get(id);
  }

 private:
  V4l2Calls& calls_;
  int device_;
};

bool switchOff(const Controls& controls) {
  bool all = true;
  for (const Automatic& one : kAutomatic) {
    if (!controls.limits(one.id)) continue;  // not adjustable, so nothing is automatic
    const std::optional<int> now = controls.set(one.id, one.off);
    // Manual exposure includes the mode with automatic aperture.
    const bool off = now == one.off || (one.id == V4L2_CID_EXPOSURE_AUTO &&
                                        now == static_cast<int>(V4L2_EXPOSURE_SHUTTER_PRIORITY));
    all = all && off;
  }
  return all;
}

}  // namespace

void lockControls(V4l2Calls& calls, int device, const CameraFormat& wanted, CameraFormat& format) {
  const Controls controls(calls, device);
  format.locked = switchOff(controls);
  const auto units = static_cast<int>(std::lround(wanted.exposure / kExposureUnit));
  const std::optional<int> exposure =
      wanted.exposure > 0 ? controls.set(V4L2_CID_EXPOSURE_ABSOLUTE, std::max(units, 1))
                          : controls.get(V4L2_CID_EXPOSURE_ABSOLUTE);
  format.exposure = exposure ? *exposure * kExposureUnit : 0;
  const std::uint32_t gain_id =
      controls.limits(V4L2_CID_GAIN) ? V4L2_CID_GAIN : V4L2_CID_ANALOGUE_GAIN;
  const std::optional<int> gain =
      wanted.gain > 0 ? controls.set(gain_id, static_cast<int>(std::lround(wanted.gain)))
                      : controls.get(gain_id);
  format.gain = gain.value_or(0);
}

}  // namespace lab::cameras
