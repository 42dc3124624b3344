/// Whether a camera's grey steps are linear in light, told from the caps in its pictures. Pictures
/// in, a number out.
///
/// A camera that encodes light for the eye brightens what is dark: black paint on white, a twelfth
/// in light, shows as a third, and outlines are blurred unevenly. Pictures are looked at both ways.
/// Where one way finds more caps, it is taken; where both find them all, the paint decides, which
/// is no more than a guess: haze brightens black paint too. The caps in the brightest light count,
/// as some encodings are linear in little light.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/camera_response.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::detector {

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
  /// it cannot.
  [[nodiscard]] std::optional<double> gamma() const;

  /// What gamma() is told from, for people: "at 36 of 40 places caps show only so".
  [[nodiscard]] std::string reason() const;

  /// Whether caps have been seen in enough light at enough places, as one robot may begin under a
  /// reflection: nothing more will change it.
  [[nodiscard]] bool isSettled() const { return settled_; }

 private:
  enum class By { kBoth, kLinear, kEncoded };
  struct Paint {
    double x = 0;  // [m] where it was seen
    double y = 0;
    double white = 0;  // [DN] in the picture as it is
    double ratio = 0;  // [1] black over white, likewise
    By by = By::kBoth;
  };

  [[nodiscard]] Paint paintOf(const Detection& cap, const optics::CameraResponse& read,
                              By by) const;
  void add(const Paint& paint);
  /// Those that count.
  [[nodiscard]] std::span<const Paint> brightest() const;
  /// What one way finds and the other does not, where that is no chance: positive for encoded.
  [[nodiscard]] std::int64_t lead() const;
  /// [1] the median
  [[nodiscard]] double ratio() const;

  Detector linear_;
  Detector encoded_;
  optics::CameraResponse video_;
  double black_;
  bool settled_ = false;
  std::int64_t pictures_ = 0;
  std::vector<Paint> seen_;  // the brightest first
};

}  // namespace lab::detector
