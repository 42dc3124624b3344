/// Whether a camera's grey steps are linear in light, told from the caps in its pictures. Pictures in,
/// a number out.
///
/// Black paint on white sends back less than a sixth of what the white does. A camera that encodes for
/// the eye shows that as a quarter to a half, and most of its caps are only found once that is undone.
/// So it is looked both ways, and the paint decides.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "optics/camera_model.hpp"
#include "optics/cap.hpp"
#include "optics/image.hpp"
#include "optics/imaging.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::tracker {

class ResponseFinder {
 public:
  /// @param imaging of the camera; its gamma is not looked at
  ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                 optics::Imaging imaging);

  void setCompressed(bool compressed);

  /// Looks at a picture, while there is something to be found out. Where many have said nothing, at
  /// one in ten.
  void take(const optics::GreyView& picture);

  /// Imaging::gamma, 1 or optics::kVideoGamma, as far as can be told from the caps so far;
  /// empty: none was bright enough.
  [[nodiscard]] std::optional<double> gamma() const;

  /// Whether enough caps have been seen: nothing more will change it.
  [[nodiscard]] bool isSettled() const;

  /// [1] Black paint over white in the pictures as they are: the median; 0 where gamma() is empty.
  [[nodiscard]] double ratio() const;

 private:
  void add(const std::vector<Detection>& caps, const optics::Response& read);

  Detector linear_;
  Detector encoded_;
  double black_;
  std::int64_t pictures_ = 0;
  std::vector<double> ratios_;  // sorted
};

}  // namespace lab::tracker
