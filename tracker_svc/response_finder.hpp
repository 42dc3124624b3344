/// Whether a camera's grey steps are linear in light, told from the caps in its pictures. Pictures in,
/// a number out.
///
/// Black paint on white sends back less than a sixth of what the white does. A camera that encodes for
/// the eye shows that as a quarter to a half, and many of its caps are only found once that is undone.
/// So pictures are looked at both ways, and the caps in the brightest light decide: in little light a
/// black level that is off looks like grey paint, and some encodings are linear there.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "optics/camera_model.hpp"
#include "optics/cap.hpp"
#include "optics/image.hpp"
#include "optics/imaging.hpp"
#include "optics/response.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::tracker {

class ResponseFinder {
 public:
  /// @param imaging of the camera; its gamma is not looked at
  ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                 const optics::Imaging& imaging);

  void setCompressed(bool compressed);

  /// Looks at a picture, while there is something to be found out; ever more seldom where many have
  /// not said enough, since each look is two searches.
  void take(const optics::GreyView& picture);

  /// Imaging::gamma, 1 or optics::kVideoGamma, as far as can be told from the caps so far; empty:
  /// none was bright enough.
  [[nodiscard]] std::optional<double> gamma() const;

  /// Whether caps have been seen in enough light at enough places, as one robot may begin under a
  /// reflection: nothing more will change it.
  [[nodiscard]] bool isSettled() const { return settled_; }

  /// [1] Black paint over white in the pictures as they are: the median; 0 where gamma() is empty.
  [[nodiscard]] double ratio() const;

 private:
  struct Paint {
    double x = 0;  // [m] where it was seen
    double y = 0;
    double white = 0;      // [DN] in the picture as it is
    double ratio = 0;      // [1] black over white, likewise
    bool encoded = false;  // it looks so
  };

  [[nodiscard]] Paint paintOf(const Detection& cap, const optics::Response& read) const;
  void add(const Paint& paint);
  void settle();
  [[nodiscard]] std::span<const Paint> brightest() const;

  Detector linear_;
  Detector encoded_;
  double black_;
  bool settled_ = false;
  std::int64_t pictures_ = 0;
  std::vector<Paint> seen_;  // the brightest first
};

}  // namespace lab::tracker
