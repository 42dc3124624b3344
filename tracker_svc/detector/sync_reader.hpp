/// Reads the projector's sync patch, which tells whether a picture was taken before or after a
/// change of the light.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"

namespace lab::tracker {

/// State of the patch in one picture.
struct SyncReading {
  float level = 0;       ///< [1] from the patch's dark (0) to its bright (1) state
  std::int8_t sync = 0;  ///< 0 dark, 1 bright, -1 undefined, as during a change
};

/// Learns where the patch is. Its light, aimed at a corner of the arena at sensor height, hits the
/// floor a few centimetres beside it, depending on where the projector hangs. When the patch
/// changes and the other light does not, the patch is the difference between the pictures before
/// and after; two such changes are enough. Uses no bus and no clock.
class SyncReader {
 public:
  /// @param camera in whose pictures the patch appears, near the corner at the origin
  explicit SyncReader(const optics::CameraModel& camera);

  /// Reports a change of the projector's patch: it shows `sync` (0 or 1) from `time` [s] on.
  /// @param command changes with the light shown besides the patch
  /// @param still whether that light is constant
  void reportChange(double time, int sync, std::int64_t command, bool still = true);

  /// Reads a picture whose exposure was centred at `time` [s]; call in order of time. Empty until
  /// the place of the patch is learned.
  std::optional<SyncReading> look(const optics::GreyView& picture, double time);

 private:
  struct Turn {
    double time = 0;  ///< [s]
    int sync = -1;
    std::int64_t command = 0;
    bool alone = false;  ///< no other light changed
  };

  void copyWindow(const optics::GreyView& picture);
  void learn();
  void chooseWeights();
  [[nodiscard]] double signal() const;

  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< [px] of the window
  Turn turn_;                                        ///< the last change
  bool settled_ = false;  ///< whether a picture of the state after it was seen
  std::vector<float> now_, before_;
  bool has_before_ = false;
  std::vector<float> difference_;  ///< bright minus dark, summed over the changes
  int turns_ = 0;
  std::vector<float> weights_;  ///< empty until learned
  double dark_ = 0, bright_ = 0;
  int known_dark_ = 0, known_bright_ = 0;  ///< number of pictures averaged
};

}  // namespace lab::tracker
