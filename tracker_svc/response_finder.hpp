/// Estimates whether a camera's grey values are linear in light, from the caps in its pictures.
///
/// A camera that gamma-encodes brightens dark areas: black paint reflects a twelfth of white's
/// light but shows at a third of its grey value, and outlines are blurred asymmetrically. Each
/// picture is searched with both assumptions. If one finds more caps, it wins. If both find all
/// caps, the ratio of black to white decides; this is only an estimate, because haze brightens
/// black paint too. Only the caps in the brightest light count, because some encodings are linear
/// in dim light.
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
  /// @param imaging of the camera; its gamma is ignored
  ResponseFinder(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                 const optics::Imaging& imaging);

  void setCompressed(bool compressed);

  /// Examines a picture unless the question is settled. Each call costs two searches, so pictures
  /// are examined less and less often while the result stays open.
  void examine(const optics::GreyView& picture);

  /// Imaging::gamma: 1 or optics::kVideoGamma; empty while the caps do not tell.
  [[nodiscard]] std::optional<double> gamma() const;

  /// Why gamma() has its value, for users: "at 36 of 40 places caps are found only with it".
  [[nodiscard]] std::string reason() const;

  /// Whether caps were seen in enough light at enough places; the result is then final. Several
  /// places are required because one robot may be under a reflection.
  [[nodiscard]] bool isSettled() const { return settled_; }

 private:
  enum class By { kBoth, kLinear, kEncoded };
  struct Paint {
    double x = 0;  // [m] place of the cap
    double y = 0;
    double white = 0;  // [DN] in the picture without decoding
    double ratio = 0;  // [1] black over white, without decoding
    By by = By::kBoth;
  };

  [[nodiscard]] Paint paintOf(const Detection& cap, const optics::CameraResponse& read,
                              By by) const;
  void add(const Paint& paint);
  /// The samples that count.
  [[nodiscard]] std::span<const Paint> brightest() const;
  /// Caps found only with one assumption, if significant: positive for encoded.
  [[nodiscard]] std::int64_t lead() const;
  /// [1] median of black over white
  [[nodiscard]] double ratio() const;

  Detector linear_;
  Detector encoded_;
  optics::CameraResponse video_;
  double black_;
  bool settled_ = false;
  std::int64_t pictures_ = 0;
  std::vector<Paint> samples_;  // brightest first
};

}  // namespace lab::detector
