#include "tracker_svc/detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>

#include "common/math/angle.hpp"
#include "light/photometry/camera_response.hpp"
#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/detector/degraded_poses.hpp"
#include "tracker_svc/detector/detector_setup.hpp"
#include "tracker_svc/detector/fitted_circles.hpp"
#include "tracker_svc/detector/known_caps.hpp"
#include "tracker_svc/detector/pair_builder.hpp"
#include "tracker_svc/detector/unpaired_circles.hpp"

namespace lab::detector {
namespace {

// [cap radii] of reach up to which only one cap can be meant: two caps are farther apart than twice
// this
constexpr double kOneOnly = 0.8;
constexpr std::size_t kAhead = 2;  // number of caps whose pixels are prefetched
constexpr std::size_t kLine = 64;  // [bytes] of a cache line

bool isThere(const Detection& cap, const Expected& expected, double& square) {
  const double dx = cap.x - expected.x;
  const double dy = cap.y - expected.y;
  square = dx * dx + dy * dy;
  return square <= expected.reach * expected.reach &&
         std::abs(wrapAngle(cap.theta - expected.theta)) <= expected.turn;
}

}  // namespace

std::string_view toText(Reason reason) {
  switch (reason) {
    case Reason::kCircleFit:
      return "no clean circle";
    case Reason::kSize:
      return "wrong size";
    case Reason::kNoPartner:
      return "no partner";
    case Reason::kSpacing:
      return "wrong spacing";
    case Reason::kNoCap:
      return "no cap around it";
    case Reason::kTaken:
      return "belongs to another";
    case Reason::kMerged:
      return "several in one";
    case Reason::kPattern:
      return "pattern does not fit";
  }
  return "?";
}

struct Detector::Steps {
  Steps(const optics::CameraModel& camera, const optics::CapGeometry& cap,
        const optics::Imaging& imaging)
      : setup{camera, cap, imaging},
        response(imaging),
        search(setup.scale, cap, imaging, camera.parameters().width, camera.parameters().height) {}
  // The parts refer to each other.
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;

  [[nodiscard]] bool canRead(const optics::GreyView& picture) const;
  /// Finds the caps in these regions of the picture and adds them to the known ones.
  void look(const optics::GreyView& picture, std::span<const Region> regions,
            std::vector<Rejection>* rejected);
  /// Adds the cap to the known ones if fits that begin at its expected circles confirm it.
  [[nodiscard]] bool seeExpected(const optics::GreyView& picture, const Expected& expected);
  /// Prefetches the pixels around an expected cap.
  void fetch(const optics::GreyView& picture, const Expected& expected) const;
  void explainTheRest(std::vector<Rejection>& rejected) const;

  DetectorSetup setup;
  optics::CameraResponse response;
  CircleSearch search;
  FittedCircles circles{setup};
  KnownCaps known{setup};
  PairBuilder pairs{setup, search, circles, known};
  UnpairedCircles unpaired{setup, circles, known, pairs};
  DegradedPoses degraded{setup, circles, known};
  std::vector<RejectedSpot> rejected_spots;
  std::vector<Region> regions;
  std::vector<Detection> found;
};

Detector::Detector(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                   const optics::Imaging& imaging)
    : steps_(std::make_unique<Steps>(camera, cap, imaging)) {}

Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

const optics::CameraModel& Detector::camera() const { return steps_->setup.camera; }

const optics::CapGeometry& Detector::cap() const { return steps_->setup.cap; }

void Detector::setCompressed(bool compressed) { steps_->setup.imaging.compressed = compressed; }

void Detector::setGamma(double gamma) {
  optics::Imaging& imaging = steps_->setup.imaging;
  if (gamma == imaging.gamma) return;
  imaging.gamma = gamma;
  steps_->response = optics::CameraResponse(imaging);
}

const std::vector<Detection>& Detector::search(const optics::GreyView& grey,
                                               std::vector<Rejection>* rejected,
                                               std::span<const Expected> expected) {
  Steps& steps = *steps_;
  if (rejected != nullptr) rejected->clear();
  steps.found.clear();
  if (!steps.canRead(grey)) return steps.found;
  const optics::GreyView picture = steps.response.linear(grey);
  const Region all{0, 0, picture.width - 1, picture.height - 1};
  steps.known.clear();
  steps.look(picture, {&all, 1}, rejected);
  steps.found = steps.known.caps();
  for (const DegradedPose& one : steps.degraded.find(expected)) steps.found.push_back(one.pose);
  return steps.found;
}

const std::vector<Detection>& Detector::follow(const optics::GreyView& grey,
                                               std::span<const Expected> expected) {
  Steps& steps = *steps_;
  std::vector<Detection>& found = steps.found;
  found.assign(expected.size(), Detection{});
  if (!steps.canRead(grey)) return found;
  const optics::GreyView picture = steps.response.linear(grey);
  steps.regions.clear();
  steps.known.clear();
  steps.search.aimAt(picture);
  for (std::size_t i = 0; i < std::min(kAhead, expected.size()); ++i)
    steps.fetch(picture, expected[i]);
  const optics::CapGeometry& geometry = steps.setup.cap;
  // Both circles, and the neighbouring pixels they are compared with.
  const double around = std::max(std::abs(geometry.big_offset), std::abs(geometry.small_offset)) +
                        1.5 * geometry.big_radius;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Expected& cap = expected[i];
    if (i + kAhead < expected.size()) steps.fetch(picture, expected[i + kAhead]);
    if (steps.seeExpected(picture, cap)) continue;
    optics::PlaneScale scale;
    const optics::Pixel at = steps.setup.camera.project(cap.x, cap.y, geometry.height, scale);
    const double half = around + std::max(cap.reach, 0.0);
    const double across = half * std::hypot(scale.ux, scale.uy) + 2;
    const double along = half * std::hypot(scale.vx, scale.vy) + 2;
    if (!picture.contains(at.x, at.y, -across - along)) continue;
    steps.regions.push_back({static_cast<int>(at.x - across), static_cast<int>(at.y - along),
                             static_cast<int>(at.x + across), static_cast<int>(at.y + along)});
  }
  steps.circles.begin(picture);
  if (!steps.regions.empty()) steps.look(picture, steps.regions, nullptr);

  struct Match {
    double square;  // of their distance [m^2]
    std::size_t expected;
    std::size_t known;
  };
  const std::vector<Detection>& known = steps.known.caps();
  std::vector<Match> matches;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t j = 0; j < known.size(); ++j) {
      double square = 0;
      if (isThere(known[j], expected[i], square)) matches.push_back({square, i, j});
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::tie(a.square, a.expected, a.known) < std::tie(b.square, b.expected, b.known);
  });
  std::vector<bool> given(known.size(), false);
  for (const Match& match : matches) {
    if (given[match.known] || found[match.expected].quality > 0) continue;
    given[match.known] = true;
    found[match.expected] = known[match.known];
  }
  const auto missing = [](const Detection& cap) { return cap.quality <= 0; };
  if (std::ranges::any_of(found, missing)) {
    for (const DegradedPose& one : steps.degraded.find(expected)) found[one.expected] = one.pose;
  }
  return found;
}

bool Detector::Steps::canRead(const optics::GreyView& picture) const {
  const optics::CameraParameters& camera = setup.camera.parameters();
  return picture.data != nullptr && picture.width == camera.width &&
         picture.height == camera.height && picture.stride >= picture.width;
}

void Detector::Steps::look(const optics::GreyView& picture, std::span<const Region> where,
                           std::vector<Rejection>* rejected) {
  rejected_spots.clear();
  std::vector<RejectedSpot>* refused = rejected != nullptr ? &rejected_spots : nullptr;
  circles.begin(picture);
  search.findRound(picture, where, circles.newSpots(), refused);
  for (const Detection& pose : known.caps()) known.cover(search, pose);
  circles.admit();
  pairs.gather(0, rejected);
  pairs.settlePairs(rejected);
  // Then spots that show only a part of their outline, unless they are part of a known cap.
  const std::size_t first = circles.size();
  search.findRest(known.isLightEven() ? Rows::kSome : Rows::kAll, circles.newSpots(), refused);
  circles.admit();
  pairs.gather(first, rejected);
  pairs.settlePairs(rejected);
  pairs.lookAgain(rejected);
  pairs.settlePairs(rejected);
  unpaired.search(rejected);
  if (rejected != nullptr) explainTheRest(*rejected);
}

bool Detector::Steps::seeExpected(const optics::GreyView& picture, const Expected& expected) {
  if (!(expected.reach <= kOneOnly * setup.cap.cap_radius)) return false;
  const double cosine = std::cos(expected.theta);
  const double sine = std::sin(expected.theta);
  circles.begin(picture);
  for (const bool is_big : {true, false}) {
    const double offset = is_big ? setup.cap.big_offset : setup.cap.small_offset;
    const optics::Pixel place = setup.camera.project(expected.x + offset * cosine,
                                                     expected.y + offset * sine, setup.cap.height);
    if (!picture.contains(place.x, place.y)) return false;
    const std::optional<Spot> spot = search.circleAt(place, is_big);
    if (!spot) return false;
    circles.add(*spot);
  }
  CirclePair pair{0, 1, 0, 0};
  if (!pairs.measure(pair, nullptr)) return false;
  const Detection pose = pairs.poseOf(pair);
  double unused = 0;
  if (!isThere(pose, expected, unused) || known.overlaps(pose)) return false;
  known.add(pose);
  return true;
}

// Prefetching overlaps the memory latencies of scattered places.
void Detector::Steps::fetch(const optics::GreyView& picture, const Expected& expected) const {
  optics::PlaneScale scale;
  const optics::Pixel at = setup.camera.project(expected.x, expected.y, setup.cap.height, scale);
  const double across = setup.cap.cap_radius * std::hypot(scale.ux, scale.uy) + 1;
  const double along = setup.cap.cap_radius * std::hypot(scale.vx, scale.vy) + 1;
  if (!picture.contains(at.x, at.y)) return;
  const int left = std::max(static_cast<int>(at.x - across), 0);
  const int right = std::min(static_cast<int>(at.x + across), picture.width - 1);
  const int top = std::max(static_cast<int>(at.y - along), 0);
  const int bottom = std::min(static_cast<int>(at.y + along), picture.height - 1);
  for (int y = top; y <= bottom; ++y) {
    const std::uint8_t* from = picture.row(y) + left;
    const std::uint8_t* last = picture.row(y) + right;
    __builtin_prefetch(from);
    from += kLine - reinterpret_cast<std::uintptr_t>(from) % kLine;
    for (; from <= last; from += kLine) __builtin_prefetch(from);
  }
}

void Detector::Steps::explainTheRest(std::vector<Rejection>& rejected) const {
  const std::vector<Spot>& spots = circles.spots();
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const optics::Pixel where{static_cast<double>(spots[i].x), static_cast<double>(spots[i].y)};
    const FittedCircles::Circle& big = circles.of(static_cast<int>(i), true);
    const FittedCircles::Circle& small = circles.of(static_cast<int>(i), false);
    if (!big.fitted && !small.fitted) {
      rejected.push_back({where, Reason::kNoPartner, 0, 0});
    }
    // Reported once if both sizes have the same fault.
    for (const FittedCircles::Circle* circle : {&big, &small}) {
      const FitFault fault = circle->fit.fault;
      if (fault == FitFault::kNone || (circle == &small && fault == big.fit.fault)) continue;
      rejected.push_back({where, Reason::kCircleFit, static_cast<float>(fault), 0});
    }
  }
  for (const RejectedSpot& spot : rejected_spots) {
    rejected.push_back({{static_cast<double>(spot.x), static_cast<double>(spot.y)},
                        Reason::kSize,
                        spot.found,
                        spot.wanted});
  }
}

std::unique_ptr<MarkerDetector> makeMarkerDetector(const MarkerSettings& settings,
                                                   const optics::CameraModel& camera,
                                                   const optics::CapGeometry& cap,
                                                   const optics::Imaging& imaging) {
  switch (settings.kind) {
    case MarkerKind::kBlobs:
      return makeBlobDetector(camera, imaging, settings.blobs);
    case MarkerKind::kTags:
      return makeTagDetector(camera, imaging, settings.tags);
    case MarkerKind::kCaps:
      break;
  }
  return std::make_unique<Detector>(camera, cap, imaging);
}

}  // namespace lab::detector
