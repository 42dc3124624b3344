/// Caps that are known from before: fits that begin where their circles are expected. The search
/// looks for what is not there.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>

#include "tracker_svc/detector.hpp"

namespace lab::detector {
namespace {

// [cap radii] of reach: two caps are farther apart than twice this, so there is only one
constexpr double kOneOnly = 0.8;
constexpr std::size_t kAhead = 2;  // caps whose pixels are asked for before they are needed
constexpr std::size_t kLine = 64;  // [bytes] that come from memory together

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

bool isThere(const Detection& seen, const Expected& expected, double& square) {
  const double dx = seen.x - expected.x;
  const double dy = seen.y - expected.y;
  square = dx * dx + dy * dy;
  return square <= expected.reach * expected.reach &&
         std::abs(wrapped(seen.theta - expected.theta)) <= expected.turn;
}

}  // namespace

const std::vector<Detection>& Detector::follow(const optics::GreyView& seen,
                                               std::span<const Expected> expected) {
  found_.assign(expected.size(), Detection{});
  if (!canRead(seen)) return found_;
  const optics::GreyView picture = response_.linear(seen);
  regions_.clear();
  seen_.clear();
  search_.aimAt(picture);
  for (std::size_t i = 0; i < std::min(kAhead, expected.size()); ++i) fetch(picture, expected[i]);
  // All of both circles, and the neighbours that they are held against.
  const double around =
      std::max(std::abs(cap_.big_offset), std::abs(cap_.small_offset)) + 1.5 * cap_.big_radius;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Expected& cap = expected[i];
    if (i + kAhead < expected.size()) fetch(picture, expected[i + kAhead]);
    if (seeExpected(picture, cap)) continue;
    optics::PlaneScale scale;
    const optics::Pixel at = camera_.project(cap.x, cap.y, cap_.height, scale);
    const double half = around + std::max(cap.reach, 0.0);
    const double across = half * std::hypot(scale.ux, scale.uy) + 2;
    const double along = half * std::hypot(scale.vx, scale.vy) + 2;
    if (!picture.contains(at.x, at.y, -across - along)) continue;
    regions_.push_back({static_cast<int>(at.x - across), static_cast<int>(at.y - along),
                        static_cast<int>(at.x + across), static_cast<int>(at.y + along)});
  }
  spots_.clear();
  if (!regions_.empty()) look(picture, regions_, nullptr);

  struct Match {
    double square;  // of their distance
    std::size_t expected;
    std::size_t seen;
  };
  std::vector<Match> matches;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t j = 0; j < seen_.size(); ++j) {
      double square = 0;
      if (isThere(seen_[j], expected[i], square)) matches.push_back({square, i, j});
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::tie(a.square, a.expected, a.seen) < std::tie(b.square, b.expected, b.seen);
  });
  std::vector<bool> given(seen_.size(), false);
  for (const Match& match : matches) {
    if (given[match.seen] || found_[match.expected].quality > 0) continue;
    given[match.seen] = true;
    found_[match.expected] = seen_[match.seen];
  }
  const auto missing = [](const Detection& cap) { return cap.quality <= 0; };
  if (std::ranges::any_of(found_, missing)) {
    for (const DegradedPose& one : degradedPoses(picture, expected))
      found_[one.expected] = one.pose;
  }
  return found_;
}

bool Detector::seeExpected(const optics::GreyView& picture, const Expected& expected) {
  if (!(expected.reach <= kOneOnly * cap_.cap_radius)) return false;
  const double cosine = std::cos(expected.theta);
  const double sine = std::sin(expected.theta);
  spots_.clear();
  for (const bool is_big : {true, false}) {
    const double offset = is_big ? cap_.big_offset : cap_.small_offset;
    const optics::Pixel place =
        camera_.project(expected.x + offset * cosine, expected.y + offset * sine, cap_.height);
    if (!picture.contains(place.x, place.y)) return false;
    const std::optional<Spot> spot = search_.circleAt(place, is_big);
    if (!spot) return false;
    spots_.push_back(*spot);
  }
  circles_.assign(2 * spots_.size(), Circle{});
  CirclePair couple{0, 1, 0, 0};
  if (!measure(picture, couple, nullptr)) return false;
  const Detection pose = poseOf(couple, couple.rim);
  double unused = 0;
  if (!isThere(pose, expected, unused) || overlapsSeen(pose)) return false;
  seen_.push_back(pose);
  return true;
}

// Scattered places come from memory one after the other unless all are asked for at once.
void Detector::fetch(const optics::GreyView& picture, const Expected& expected) const {
  optics::PlaneScale scale;
  const optics::Pixel at = camera_.project(expected.x, expected.y, cap_.height, scale);
  const double across = cap_.cap_radius * std::hypot(scale.ux, scale.uy) + 1;
  const double along = cap_.cap_radius * std::hypot(scale.vx, scale.vy) + 1;
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

}  // namespace lab::detector
