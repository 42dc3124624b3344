#include "projector_ctl/display/overlay.hpp"

#include <cstdio>

namespace lab::projector {

std::vector<std::string> overlayLines(const ShownFrame& shown,
                                      const FrameLoop::SwappedFrame& swapped, double rate) {
  constexpr std::size_t kLongest = 60;  // letters of a label
  char frames[32];
  std::snprintf(frames, sizeof frames, "%.1f fps", rate);
  std::vector<std::string> lines = {
      frames + (", vsync " + swapped.vsync),
      shown.commander.empty() ? shown.label.substr(0, kLongest)
                              : shown.commander + " " + std::to_string(shown.seq) + " " +
                                    shown.label.substr(0, kLongest),
      "calibration " + (swapped.calibration_id.empty() ? "none" : swapped.calibration_id)};
  if (!swapped.trouble.empty()) lines.push_back(swapped.trouble.substr(0, kLongest));
  return lines;
}

}  // namespace lab::projector
