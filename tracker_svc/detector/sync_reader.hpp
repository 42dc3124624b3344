/// Sees the projector's sync patch: whether a picture shows the light from before or after a
/// change.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"

namespace lab::tracker {

/// What one picture shows of the patch.
struct SyncSeen {
  float level = 0;       ///< [1] between the patch's dark (0) and its bright (1)
  std::int8_t sync = 0;  ///< 0 dark, 1 bright, -1: neither for sure, as while it changes
};

/// Learns by itself where the patch is: light for a corner of the arena at the height of the
/// sensors falls a few centimetres beside it on the floor, and by how much depends on where the
/// projector hangs. Whenever the patch turns and the rest of the light stays, it is what differs
/// between the pictures before and after; two such turns show where it is. Pure: no bus, no clock.
class SyncReader {
 public:
  /// @param camera in whose pictures the patch appears, near the corner at the origin
  explicit SyncReader(const optics::CameraModel& camera);

  /// What the projector says: it shows `sync` (0 or 1) from `time` [s] on. @param command a number
  /// that changes with the light that is shown beside the patch, @param still that light stays as
  /// it is
  void shown(double time, int sync, std::int64_t command, bool still = true);

  /// Looks at a picture whose exposure had its middle at `time` [s]; in order of time. Nothing as
  /// long as it has not learned where the patch is.
  std::optional<SyncSeen> look(const optics::GreyView& picture, double time);

 private:
  struct Turn {
    double time = 0;  ///< [s]
    int sync = -1;
    std::int64_t command = 0;
    bool alone = false;  ///< nothing else changed
  };

  void copyWindow(const optics::GreyView& picture);
  void learn();
  void chooseWeights();
  [[nodiscard]] double signal() const;

  int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< [px] of the window
  Turn turn_;                                        ///< the last one
  bool settled_ = false;                             ///< a picture of the state after it was seen
  std::vector<float> now_, before_;
  bool has_before_ = false;
  std::vector<float> difference_;  ///< bright minus dark, summed over the turns
  int turns_ = 0;
  std::vector<float> weights_;  ///< empty: not yet learned
  double dark_ = 0, bright_ = 0;
  int known_dark_ = 0, known_bright_ = 0;  ///< pictures that these come from
};

}  // namespace lab::tracker
