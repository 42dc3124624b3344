#include "tracker_svc/detector/unpaired_circles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "tracker_svc/detector/cap_check.hpp"
#include "tracker_svc/detector/saturation.hpp"

namespace lab::detector {
namespace {

constexpr int kHeadings = 126;        // tested headings, 0.9 mm apart at the rim
constexpr int kMostPartners = 2;      // a neighbour or a shadow may have a higher score
constexpr int kBesideIt = 10;         // headings that count as the same
constexpr std::size_t kRough = 2;     // tests every second heading at first
constexpr double kSure = 4;           // [standard errors] of a rim: it is the best of many
constexpr int kMostInVainAside = 4;   // fits without a cap, beside spots that may be displaced
constexpr int kMostHintsAside = 60;   // such spots: each is examined from eight sides
constexpr float kScoreAside = 0.15F;  // [1] smallest rim times darkness there
constexpr double kAside = 0.8;        // [radii]
constexpr int kDirectionsAside = 8;
constexpr float kDark = 0.9F;   // [1] of the surrounding white may be left inside, with glare
constexpr float kBlack = 0.5F;  // [1] and without
constexpr double kAgain = 0.1;  // [small radii] between two spots that are the same
constexpr float kClear = 4;     // [standard errors] darker than white
constexpr float kHardly = 2;    // [read noise] by which single pixels must be darker
// Limits per picture, so that a cluttered floor does not delay the tracker. Real robots cause a few
// single spots per picture, in stripes as fine as a circle a few dozen.
constexpr int kMostHints = 300;  // single spots whose partner is searched
// Fits without a cap, each of which may take a millisecond.
constexpr int kMostInVain = 40;
// [m] tolerance of the spacing: one of many candidates, so no more than a camera scale that is 2.5
// % off
constexpr double kMostOff = 0.0009;
constexpr float kAway = 1.4F;   // [radii] at which white is sampled around a circle
constexpr float kCore = 0.35F;  // [radii] inside for any error of the heading
// [rad] offsets of the heading: the approximate place is known to one or two millimetres
constexpr std::array<double, 3> kBeside = {0, 0.06, -0.06};

/// Mean of a square with a side of 2 half + 1 pixels.
float meanAround(const optics::GreyView& picture, float x, float y, int half) {
  const int middle_x = static_cast<int>(x + 0.5F);
  const int middle_y = static_cast<int>(y + 0.5F);
  int sum = 0;
  for (int dy = -half; dy <= half; ++dy) {
    const std::uint8_t* row = picture.row(middle_y + dy) + middle_x;
    for (int dx = -half; dx <= half; ++dx) sum += row[dx];
  }
  const int side = 2 * half + 1;
  return static_cast<float>(sum) / static_cast<float>(side * side);
}

/// Share of the light left inside a circle, relative to the brightest pair of opposite neighbours
/// (its darker end): a light edge leaves the pair parallel to it. 1 if not darker than noise.
float leftInside(const optics::GreyView& picture, float x, float y, float radius,
                 const optics::Imaging& imaging) {
  constexpr float kDiagonal = std::numbers::sqrt2_v<float> / 2;
  constexpr float kPairs[4][2] = {{1, 0}, {0, 1}, {kDiagonal, kDiagonal}, {kDiagonal, -kDiagonal}};
  const float away = kAway * radius;
  const int half = std::max(static_cast<int>(kCore * radius), 1);
  if (!picture.contains(static_cast<double>(x), static_cast<double>(y),
                        static_cast<double>(away) + half + 1)) {
    return 1;
  }
  float white = 0;
  for (const auto& pair : kPairs) {
    const float dx = away * pair[0];
    const float dy = away * pair[1];
    white = std::max(white, std::min(meanAround(picture, x + dx, y + dy, 1),
                                     meanAround(picture, x - dx, y - dy, 1)));
  }
  const float inside = meanAround(picture, x, y, half);
  const auto black = static_cast<float>(imaging.black);
  const auto read = static_cast<float>(imaging.read_noise);
  const float noise = std::sqrt(read * read + static_cast<float>(imaging.shot_gain) * white) / 3;
  if (white - inside < kClear * noise || white <= black) return 1;
  return (inside - black) / (white - black);
}

double distance(const optics::Place& a, const optics::Place& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

double angleOf(int heading) { return 2 * std::numbers::pi * heading / kHeadings; }

struct Heading {
  float cosine = 0;
  float sine = 0;
};

const std::array<Heading, kHeadings>& headings() {
  static const std::array<Heading, kHeadings> kAll = [] {
    std::array<Heading, kHeadings> all;
    for (int i = 0; i < kHeadings; ++i) {
      all[static_cast<std::size_t>(i)] = {static_cast<float>(std::cos(angleOf(i))),
                                          static_cast<float>(std::sin(angleOf(i)))};
    }
    return all;
  }();
  return kAll;
}

/// A cheap test with nine pixels, which rejects most of the floor: false if the middle is hardly
/// darker than both ends of every pair.
bool mayBeDark(const optics::GreyView& picture, float x, float y, int away, float noise) {
  const int middle_x = static_cast<int>(x + 0.5F);
  const int middle_y = static_cast<int>(y + 0.5F);
  if (!picture.contains(static_cast<double>(x), static_cast<double>(y), away + 1)) return false;
  const std::uint8_t* at = picture.row(middle_y) + middle_x;
  const std::ptrdiff_t column = away * picture.stride;
  const int diagonal = away * 181 / 256;
  const std::ptrdiff_t down = diagonal * picture.stride;
  const int white =
      std::max(std::max(std::min(at[away], at[-away]), std::min(at[column], at[-column])),
               std::max(std::min(at[down + diagonal], at[-down - diagonal]),
                        std::min(at[down - diagonal], at[diagonal - down])));
  return static_cast<float>(white - at[0]) > noise;
}

}  // namespace

void UnpairedCircles::search(std::vector<Rejection>* rejected) {
  struct Done {
    optics::Place place;
    bool big;
  };
  std::vector<Done> done;  // spots centred again occur twice
  const auto isNew = [&](const optics::Place& place, bool big) {
    return std::ranges::none_of(done, [&](const Done& other) {
      return big == other.big && distance(place, other.place) < kAgain * setup_.cap.small_radius;
    });
  };
  int hints = kMostHints;
  int in_vain = 0;
  const std::size_t known = circles_.size();
  for (const bool aside : {false, true}) {      // direct candidates first
    if (aside && known_.isLightEven()) return;  // only uneven light displaces spots
    const int most_in_vain =
        aside ? std::min(in_vain + kMostInVainAside, kMostInVain) : kMostInVain;
    if (aside) hints = std::min(hints, kMostHintsAside);
    done.clear();
    for (std::size_t i = 0; i < known; ++i) {
      for (const bool big : {true, false}) {
        const Spot spot = circles_.spots()[i];
        // Saturated white may be brighter than 255, and the circle larger than it looks.
        const bool full = spot.white + static_cast<float>(setup_.imaging.black) >= kSaturated;
        if (circles_.isAssigned(i) || !(big ? spot.can_be_big || full : spot.can_be_small))
          continue;
        const optics::Pixel at{static_cast<double>(spot.x), static_cast<double>(spot.y)};
        if (!aside && !isBlack(at, big)) continue;
        const std::optional<optics::Place> rough = setup_.camera.toPlane(at, setup_.cap.height);
        if (!rough || known_.leavesNoRoomAt(*rough) || !isNew(*rough, big)) continue;
        if (hints-- == 0) return;
        if (in_vain >= most_in_vain) break;
        done.push_back({*rough, big});
        std::optional<optics::Place> begin;
        if (aside) {
          begin = placeAside(*rough, big);
          if (!begin) continue;
        } else if (partnersOf(*rough, big, kRough).empty()) {
          continue;
        }
        in_vain += tryUnpaired(static_cast<int>(i), big, begin, rejected);
      }
    }
  }
}

int UnpairedCircles::tryUnpaired(int spot, bool big, const std::optional<optics::Place>& aside,
                                 std::vector<Rejection>* rejected) {
  const FittedCircles::Circle before = circles_.of(spot, big);
  const FittedCircles::Circle& circle =
      aside ? circles_.fitFrom(setup_.camera.project(aside->x, aside->y, setup_.cap.height), spot,
                               big)
            : circles_.fit(spot, big);
  const std::size_t known = known_.size();
  int in_vain = 1;
  if (circle.fit.fault == FitFault::kNone && !known_.leavesNoRoomAt(circle.place)) {
    for (const Partner& partner : partnersOf(circle.place, big, 1)) {
      in_vain += pairBeside(spot, big, partner.theta, rejected);
      if (known_.size() > known) return in_vain - 1;
    }
  }
  // A fit at a displaced place does not count for the spot.
  if (aside) circles_.restore(spot, big, before);
  return in_vain;
}

bool UnpairedCircles::isBlack(optics::Pixel at, bool big) const {
  const float radius = static_cast<float>(big ? setup_.cap.big_radius : setup_.cap.small_radius) *
                       setup_.scale.at(at.x, at.y).mean;
  return leftInside(circles_.picture(), static_cast<float>(at.x), static_cast<float>(at.y), radius,
                    setup_.imaging) <= kBlack;
}

// A light edge may displace a spot by nearly a radius.
std::optional<optics::Place> UnpairedCircles::placeAside(optics::Place rough, bool big) const {
  const double away = kAside * (big ? setup_.cap.big_radius : setup_.cap.small_radius);
  std::optional<optics::Place> best;
  float most = kScoreAside;
  for (int i = 0; i < kDirectionsAside; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirectionsAside;
    const optics::Place place{rough.x + away * std::cos(angle), rough.y + away * std::sin(angle)};
    if (!isBlack(setup_.camera.project(place.x, place.y, setup_.cap.height), big)) continue;
    const std::vector<Partner> partners = partnersOf(place, big, kRough);
    if (partners.empty() || partners[0].score <= most) continue;
    most = partners[0].score;
    best = place;
  }
  return best;
}

std::vector<UnpairedCircles::Partner> UnpairedCircles::partnersOf(optics::Place circle, bool big,
                                                                  std::size_t step) const {
  const double offset = big ? setup_.cap.big_offset : setup_.cap.small_offset;
  const double apart = (big ? setup_.cap.small_offset : setup_.cap.big_offset) - offset;
  const auto radius = static_cast<float>(big ? setup_.cap.small_radius : setup_.cap.big_radius);
  const optics::Pixel at = setup_.camera.project(circle.x, circle.y, setup_.cap.height);
  const LocalScale scale = setup_.scale.at(at.x, at.y);
  if (scale.mean <= 0) return {};
  const auto x = static_cast<float>(at.x);
  const auto y = static_cast<float>(at.y);
  const auto far = static_cast<float>(apart);
  const int away = static_cast<int>(kAway * radius * scale.mean);
  const float noise = kHardly * static_cast<float>(setup_.imaging.read_noise);
  bool dark = false;
  std::array<float, kHeadings> score{};
  for (std::size_t i = 0; i < kHeadings; i += step) {
    const Heading& heading = headings()[i];
    const float du = scale.forward[0] * heading.cosine + scale.forward[1] * heading.sine;
    const float dv = scale.forward[2] * heading.cosine + scale.forward[3] * heading.sine;  // [px/m]
    if (i % 2 == 0) dark = mayBeDark(circles_.picture(), x + far * du, y + far * dv, away, noise);
    if (!dark) continue;
    const float left = leftInside(circles_.picture(), x + far * du, y + far * dv,
                                  radius * scale.mean, setup_.imaging);
    if (left > kDark) continue;
    const optics::Pixel middle{at.x - offset * static_cast<double>(du),
                               at.y - offset * static_cast<double>(dv)};
    const float rim =
        rimContrast(circles_.picture(), middle, scale, setup_.cap, setup_.imaging,
                    step > 1 ? RimSampling::kRough : RimSampling::kAll, kSaturatedWhite);
    if (rim >= kLeastRim) score[i] = rim * (1 - left);
  }
  std::vector<Partner> best;
  for (int n = 0; n < kMostPartners; ++n) {
    const auto top = std::max_element(score.begin(), score.end());
    if (*top <= 0) break;
    const auto heading = static_cast<int>(top - score.begin());
    best.push_back({angleOf(heading), *top});
    for (int off = -kBesideIt; off <= kBesideIt; ++off) {
      score[static_cast<std::size_t>((heading + off + kHeadings) % kHeadings)] = 0;
    }
  }
  return best;
}

int UnpairedCircles::pairBeside(int spot, bool big, double theta,
                                std::vector<Rejection>* rejected) {
  int fits = 0;
  const optics::Place circle = circles_.of(spot, big).place;
  const double apart = big ? setup_.cap.small_offset - setup_.cap.big_offset
                           : setup_.cap.big_offset - setup_.cap.small_offset;
  const int partner = static_cast<int>(circles_.size());
  for (const double beside : kBeside) {
    const optics::Pixel start =
        setup_.camera.project(circle.x + apart * std::cos(theta + beside),
                              circle.y + apart * std::sin(theta + beside), setup_.cap.height);
    if (!circles_.picture().contains(start.x, start.y)) continue;
    Spot other;
    other.x = static_cast<float>(start.x);
    other.y = static_cast<float>(start.y);
    other.can_be_big = !big;
    other.can_be_small = big;
    circles_.add(other);
    CirclePair pair{big ? spot : partner, big ? partner : spot, 0, 0};
    ++fits;
    if (circles_.fitFrom(start, partner, !big, true).fit.fault == FitFault::kNone &&
        pairs_.measure(pair, nullptr) && pair.rim > leastRim(pair) &&
        std::abs(distance(circle, circles_.of(partner, !big).place) - setup_.cap.spacing()) <
            kMostOff) {
      const std::size_t before = known_.size();
      pairs_.settleOne(pair, rejected);
      if (known_.size() > before) return fits - 1;
      circles_.release(spot);
    }
    circles_.removeLast();
  }
  return fits;
}

// In dim light, noise gives some rim contrast in the best of many directions.
float UnpairedCircles::leastRim(const CirclePair& pair) const {
  constexpr double kPairs = 24;  // pixel pairs whose median is the rim contrast
  const double white = std::max(0.5 * static_cast<double>(circles_.of(pair.big, true).fit.white +
                                                          circles_.of(pair.small, false).fit.white),
                                1.0);
  const double noise = std::sqrt(setup_.imaging.read_noise * setup_.imaging.read_noise + 1.0 / 12 +
                                 setup_.imaging.shot_gain * white);
  const double error = 1.25 * noise / (2 * white) / std::sqrt(kPairs);
  return std::max(kLeastRim, static_cast<float>(kSure * error));
}

}  // namespace lab::detector
