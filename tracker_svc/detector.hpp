/// One picture in, the caps in it out. Knows nothing of earlier pictures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/camera_response.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_fit.hpp"
#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/detector/cap_pose.hpp"
#include "tracker_svc/detector/pairing.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector {

/// What a pose was made from.
enum Used : std::uint8_t {
  kUsedBig = 1,    ///< the big circle
  kUsedSmall = 2,  ///< the small circle
  kUsedRim = 4,    ///< the rim of the cap, in place of one circle: a degraded pose
  kUsedEdge = 8,   ///< a light edge, or light that bends, was fitted together with a circle
};

struct Detection {
  double x = 0;                        ///< [m] arena frame, the robot's axis
  double y = 0;                        ///< [m]
  double theta = 0;                    ///< [rad] (-pi, pi]
  std::array<double, 6> covariance{};  ///< [m^2, m rad, rad^2] xx, xy, xt, yy, yt, tt
  float quality = 0;                   ///< [1] 0..1; a degraded pose stays below 0.5
  std::uint8_t used = 0;
  float spacing = 0;  ///< [m] measured between the two circles, 0: not both were seen
  float white = 0;    ///< [DN] of the cap, black level taken off
  float ratio = 0;    ///< [1] of the circles' paint over the cap's white
  float blur = 0;     ///< [px] standard deviation of the point spread; 0: not both were seen
  optics::Pixel big;  ///< centres in the picture, as far as seen
  optics::Pixel small;
  optics::Pixel middle;  ///< where the axis appears at cap height
};

/// Why something that looked like a cap, or a part of one, is none.
enum class Reason : std::uint8_t {
  kCircleFit,  ///< `value`: FitFault
  kSize,       ///< [1] radius over the expected one
  kNoPartner,  ///< a circle without the other one at the right distance
  kSpacing,    ///< [m] distance of the best partner
  kNoCap,      ///< [1] score of the cap around the pair: circles on the bare floor
  kTaken,      ///< its circle belongs to a better pair
};
[[nodiscard]] std::string_view toText(Reason reason);

struct Rejection {
  optics::Pixel where;
  Reason reason = Reason::kCircleFit;
  float value = 0;  ///< found
  float limit = 0;  ///< allowed
};

/// Where a cap is expected.
struct Expected {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
  double reach = 0;  ///< [m] how far it may be from there
  double turn = 0;   ///< [rad] how far it may have turned
};

class Detector {
 public:
  Detector(const optics::CameraModel& camera, const optics::CapGeometry& cap,
           const optics::Imaging& imaging = {});

  /// Every cap in the picture.
  /// @param rejected where not null, filled with what was looked at and refused
  /// @param expected caps that were there before; where one of them is not found, but one of its
  ///   circles and its rim are, its degraded pose comes behind the others
  /// @return valid until the next call
  const std::vector<Detection>& search(const optics::GreyView& picture,
                                       std::vector<Rejection>* rejected = nullptr,
                                       std::span<const Expected> expected = {});

  /// The cap near each expected pose, and nothing else: result i belongs to expected[i], with
  /// quality 0 where there is none. A cap found this way is the same, to the last bit, as search()
  /// finds, and nearly always so where a light edge crosses a circle. No cap is given twice. Where
  /// only one of its circles is seen, its pose is degraded: kUsedRim.
  const std::vector<Detection>& follow(const optics::GreyView& picture,
                                       std::span<const Expected> expected);

  /// Whether a codec that loses was between the camera and the pictures to come.
  void setCompressed(bool compressed) { imaging_.compressed = compressed; }

  /// How the grey steps of the pictures to come follow the light: Imaging::gamma.
  void setGamma(double gamma);

  [[nodiscard]] const optics::CameraModel& camera() const { return camera_; }
  [[nodiscard]] const optics::CapGeometry& cap() const { return cap_; }

 private:
  struct Circle {  // a spot taken for a big or a small circle; fitted once that is needed
    bool fitted = false;
    CircleFit fit;
    optics::Place place;                 // [m] of its centre on the cap plane
    std::array<double, 3> covariance{};  // [m^2] xx, xy, yy
  };

  struct Partner {
    double theta = 0;  // [rad] from the small one to the big one
    float score = 0;   // [1] rim times darkness
  };

  struct DegradedPose {
    std::size_t expected;  // index
    Detection pose;
  };

  [[nodiscard]] bool canRead(const optics::GreyView& picture) const;
  void look(const optics::GreyView& picture, std::span<const Region> regions,
            std::vector<Rejection>* rejected);
  /// Couples of spots that are not taken, one of them at least `first` or later.
  void gatherPairs(const optics::GreyView& picture, std::size_t first,
                   std::vector<Rejection>* rejected);
  /// Where the axis is, about.
  [[nodiscard]] optics::Pixel middleOf(const Spot& big, const Spot& small) const;
  /// Adds the couple if its spots are about as far apart as the circles of a cap.
  /// @return whether they are
  bool addCirclePair(std::size_t big, std::size_t small);
  /// Whether there is the rim of a cap around it, at a rough look; sets how clear it is.
  [[nodiscard]] bool hasRim(const optics::GreyView& picture, CirclePair& couple,
                            std::vector<Rejection>* rejected) const;
  void lookAgain(const optics::GreyView& picture, std::vector<Rejection>* rejected);
  /// For circles that are left alone, some hundred of them at most: their partners, where the rim
  /// says that they are.
  void lookBeside(const optics::GreyView& picture, std::vector<Rejection>* rejected);
  /// As far as the caps that are known say.
  [[nodiscard]] bool isLightEven() const;
  /// Whether a cap that is known leaves no room for another one there.
  [[nodiscard]] bool isByCap(optics::Place place) const;
  /// A lone spot's circle, and partners for it.
  /// @param aside where it may be instead
  /// @return how many circles were fitted in vain
  int tryUnpaired(const optics::GreyView& picture, int spot, bool big,
                  const std::optional<optics::Place>& aside, std::vector<Rejection>* rejected);
  /// The directions in which the other circle of a cap may be: it is dark there, and a rim is
  /// around both.
  /// @param step every so many headings are tried
  /// @return the best first
  [[nodiscard]] std::vector<Partner> partnersOf(const optics::GreyView& picture,
                                                optics::Place circle, bool big,
                                                std::size_t step) const;
  /// Whether it is as dark inside of a circle there as paint is.
  [[nodiscard]] bool isBlack(const optics::GreyView& picture, optics::Pixel at, bool big) const;
  /// The place beside a rough one that has the best partner.
  [[nodiscard]] std::optional<optics::Place> placeAside(const optics::GreyView& picture,
                                                        optics::Place rough, bool big) const;
  /// @return how many circles were fitted in vain
  int pairBeside(const optics::GreyView& picture, int spot, bool big, double theta,
                 std::vector<Rejection>* rejected);
  [[nodiscard]] float leastRim(const CirclePair& couple) const;
  /// Fits the couples, and adds the best of them to what is seen.
  void settlePairs(const optics::GreyView& picture, std::vector<Rejection>* rejected);
  void settle(std::vector<CirclePair>& couples, const optics::GreyView& picture,
              std::vector<Rejection>* rejected);
  [[nodiscard]] bool overlapsSeen(const Detection& pose) const;
  /// [m] from an axis, as far as no middle of another cap's circle can be.
  [[nodiscard]] double alone() const;
  void cover(const Detection& pose);
  /// Adds the cap to what is seen if it is where it is expected, by fits that begin there.
  [[nodiscard]] bool seeExpected(const optics::GreyView& picture, const Expected& expected);
  void fetch(const optics::GreyView& picture, const Expected& expected) const;
  [[nodiscard]] Circle& circleOf(int spot, bool big);
  [[nodiscard]] const Circle& circleOf(int spot, bool big) const;
  const Circle& fit(const optics::GreyView& picture, int spot, bool big);
  /// @param glare light on top is no fault
  const Circle& fitFrom(const optics::GreyView& picture, optics::Pixel start, int spot, bool big,
                        bool glare = false);
  [[nodiscard]] bool fitBoth(const optics::GreyView& picture, const CirclePair& couple);
  [[nodiscard]] bool measure(const optics::GreyView& picture, CirclePair& couple,
                             std::vector<Rejection>* rejected);
  /// A circle of a cap, with what light on top may have done to it.
  [[nodiscard]] MeasuredPoint measuredPointOf(const Circle& circle, const Circle& other) const;
  [[nodiscard]] Detection poseOf(const CirclePair& couple, float rim) const;
  /// Degraded poses of those expected caps that were not seen; valid until the next call.
  const std::vector<DegradedPose>& degradedPoses(const optics::GreyView& picture,
                                                 std::span<const Expected> expected);
  [[nodiscard]] Detection poseFromOne(const optics::GreyView& picture, const Expected& expected);
  /// The only good circle where the cap's circles can be; -1: none, several, or of unclear size.
  [[nodiscard]] int unpairedCircle(const optics::GreyView& picture, const Expected& expected,
                                   bool& is_big);
  void explainTheRest(std::vector<Rejection>& rejected) const;

  optics::CameraModel camera_;
  optics::CapGeometry cap_;
  optics::Imaging imaging_;
  optics::CameraResponse response_;
  ScaleMap scale_;
  CircleSearch search_;
  std::vector<Spot> spots_;
  std::vector<RejectedSpot> rejected_spots_;
  std::vector<Circle> circles_;  // two for each spot: as a big one, as a small one
  std::vector<CirclePair> pairs_;
  std::vector<CirclePair> doubtful_;  // of them: they wait for others
  std::vector<int> partners_;         // by spot: in how many couples it is
  std::vector<float> clearest_;       // by spot: the rim of its couples
  std::vector<char> taken_;           // by spot: it belongs to a cap
  std::vector<std::size_t> order_;    // of spots, by row
  std::vector<Region> regions_;
  std::vector<Detection> seen_;
  std::vector<DegradedPose> degraded_;
  std::vector<Detection> found_;
};

}  // namespace lab::detector
