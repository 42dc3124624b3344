// Which two circles are of one cap.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "tracker_svc/detector.hpp"
#include "tracker_svc/detector/cap_check.hpp"

namespace lab::detector {
namespace {

constexpr float kRoughSpacing = 0.006F;  // [m] by which two rough centres may miss the spacing
constexpr float kAgain = 0.012F;         // [m] for two that an edge may have displaced
constexpr double kScaleDoubt = 0.0009;   // [m] of the spacing: a camera that is 2.5 % off
constexpr double kMostDoubt = 0.0015;    // [m] whatever the covariance says
constexpr double kSigmas = 4;
constexpr double kOverlap = 1.7;  // [cap radii] between two axes, at least
constexpr float kClearer = 2;     // [1] times the contrast of another rim

}  // namespace

void Detector::gatherPairs(const optics::GreyView& picture, std::size_t first,
                           std::vector<Rejection>* rejected) {
  pairs_.clear();
  if (first == spots_.size()) return;
  // Sorted by row, each spot needs to be held against few others only.
  order_.clear();
  for (std::size_t i = 0; i < spots_.size(); ++i) {
    if (taken_[i] == 0) order_.push_back(i);
  }
  std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(spots_[a].y, a) < std::tie(spots_[b].y, b);
  });
  const float reach = (static_cast<float>(cap_.spacing()) + kRoughSpacing) * scale_.largest();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Spot& one = spots_[order_[i]];
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const Spot& other = spots_[order_[j]];
      const float dx = other.x - one.x;
      const float dy = other.y - one.y;
      if (dy > reach) break;
      if (dx * dx + dy * dy > reach * reach || std::max(order_[i], order_[j]) < first) continue;
      if (one.can_be_big && other.can_be_small) addCirclePair(order_[i], order_[j]);
      if (other.can_be_big && one.can_be_small) addCirclePair(order_[j], order_[i]);
    }
  }
  // Fits to what is no cap take long. Most are one, which shows at a rough look; where two round
  // circles have nobody else, the fits are short and the closer look behind them is enough.
  partners_.assign(spots_.size(), 0);
  for (const CirclePair& couple : pairs_) {
    for (const int spot : {couple.big, couple.small}) ++partners_[static_cast<std::size_t>(spot)];
  }
  const auto isSure = [&](int spot) {
    const auto at = static_cast<std::size_t>(spot);
    return partners_[at] == 1 && spots_[at].can_be_big != spots_[at].can_be_small;
  };
  std::erase_if(pairs_, [&](CirclePair& couple) {
    return !(isSure(couple.big) && isSure(couple.small)) && !hasRim(picture, couple, rejected);
  });
  std::sort(pairs_.begin(), pairs_.end(), [](const CirclePair& a, const CirclePair& b) {
    return std::tie(a.big, a.small) < std::tie(b.big, b.small);
  });
}

bool Detector::addCirclePair(std::size_t big_spot, std::size_t small_spot) {
  const Spot& big = spots_[big_spot];
  const Spot& small = spots_[small_spot];
  const auto spacing = static_cast<float>(cap_.spacing());
  const float reach = (spacing + kRoughSpacing) * scale_.largest();
  const float dx = big.x - small.x;
  const float dy = big.y - small.y;
  if (dx * dx + dy * dy > reach * reach) return false;
  const optics::Pixel middle = middleOf(big, small);
  const LocalScale& scale = scale_.near(middle.x, middle.y);
  if (scale.mean <= 0) return false;
  const float across = scale.inverse[0] * dx + scale.inverse[1] * dy;
  const float along = scale.inverse[2] * dx + scale.inverse[3] * dy;
  const float distance = std::sqrt(across * across + along * along);
  if (std::abs(distance - spacing) > kRoughSpacing) return false;
  pairs_.push_back({static_cast<int>(big_spot), static_cast<int>(small_spot), 0, 0});
  return true;
}

optics::Pixel Detector::middleOf(const Spot& big, const Spot& small) const {
  const auto share = static_cast<float>(cap_.big_offset / cap_.spacing());
  return {static_cast<double>(big.x - (big.x - small.x) * share),
          static_cast<double>(big.y - (big.y - small.y) * share)};
}

bool Detector::hasRim(const optics::GreyView& picture, CirclePair& couple,
                      std::vector<Rejection>* rejected) const {
  const optics::Pixel middle = middleOf(spots_[static_cast<std::size_t>(couple.big)],
                                        spots_[static_cast<std::size_t>(couple.small)]);
  const LocalScale scale = scale_.at(middle.x, middle.y);
  for (const RimSampling look : {RimSampling::kRough, RimSampling::kAll}) {
    couple.rim = rimContrast(picture, middle, scale, cap_, imaging_, look, kSaturatedWhite);
    if (couple.rim >= kLeastRim) return true;
  }
  if (rejected != nullptr) rejected->push_back({middle, Reason::kNoCap, couple.rim, kLeastRim});
  return false;
}

void Detector::lookAgain(const optics::GreyView& picture, std::vector<Rejection>* rejected) {
  // A light edge may have made a circle look like a smaller one beside it. Two leftovers that are
  // about as far apart as the circles of a cap are centred again, as circles of the right sizes.
  pairs_.clear();
  order_.clear();
  for (std::size_t i = 0; i < spots_.size(); ++i) {
    if (taken_[i] == 0) order_.push_back(i);
  }
  const float most = (static_cast<float>(cap_.spacing()) + kAgain) * scale_.largest();
  const float least = (static_cast<float>(cap_.spacing()) - kAgain) * scale_.smallest();
  for (const std::size_t i : order_) {
    std::optional<Spot> big;
    bool looked = false;
    for (const std::size_t j : order_) {
      const float dx = spots_[i].x - spots_[j].x;
      const float dy = spots_[i].y - spots_[j].y;
      const float square = dx * dx + dy * dy;
      if (i == j || square > most * most || square < least * least) continue;
      if (!looked) big = search_.centredAs(spots_[i], true);
      looked = true;
      if (!big) break;
      const std::optional<Spot> small = search_.centredAs(spots_[j], false);
      if (!small) continue;
      spots_.push_back(*big);
      spots_.push_back(*small);
      circles_.resize(2 * spots_.size());
      taken_.resize(spots_.size(), 0);
      if (addCirclePair(spots_.size() - 2, spots_.size() - 1) &&
          !hasRim(picture, pairs_.back(), rejected)) {
        pairs_.pop_back();
      }
    }
  }
}

// What is no cap is fitted in vain, and for long. So a couple waits for others where they have the
// clearer rim, as between the circles of two robots, or where its small circle looks larger than
// the big one.
void Detector::settlePairs(const optics::GreyView& picture, std::vector<Rejection>* rejected) {
  clearest_.assign(spots_.size(), 0.0F);
  for (const CirclePair& couple : pairs_) {
    for (const int spot : {couple.big, couple.small}) {
      float& rim = clearest_[static_cast<std::size_t>(spot)];
      rim = std::max(rim, couple.rim);
    }
  }
  doubtful_.clear();
  std::erase_if(pairs_, [&](const CirclePair& couple) {
    const float rim = std::max(clearest_[static_cast<std::size_t>(couple.big)],
                               clearest_[static_cast<std::size_t>(couple.small)]);
    const float big = spots_[static_cast<std::size_t>(couple.big)].size;
    const float small = spots_[static_cast<std::size_t>(couple.small)].size;
    const bool is_doubtful = small > big || (rim >= kUsualRim && rim > kClearer * couple.rim);
    if (is_doubtful) doubtful_.push_back(couple);
    return is_doubtful;
  });
  settle(pairs_, picture, rejected);
  std::erase_if(doubtful_, [&](const CirclePair& couple) {
    return taken_[static_cast<std::size_t>(couple.big)] != 0 ||
           taken_[static_cast<std::size_t>(couple.small)] != 0;
  });
  settle(doubtful_, picture, rejected);
}

void Detector::settle(std::vector<CirclePair>& couples, const optics::GreyView& picture,
                      std::vector<Rejection>* rejected) {
  std::erase_if(couples, [&](CirclePair& couple) { return !measure(picture, couple, rejected); });
  couples.resize(choosePairs(couples, static_cast<int>(spots_.size())));
  for (const CirclePair& couple : couples) {
    taken_[static_cast<std::size_t>(couple.big)] = 1;
    taken_[static_cast<std::size_t>(couple.small)] = 1;
    const Detection pose = poseOf(couple, couple.rim);
    if (!overlapsSeen(pose)) {
      seen_.push_back(pose);
      cover(pose);
    } else if (rejected != nullptr) {
      rejected->push_back({pose.middle, Reason::kTaken, couple.cost, 0});
    }
  }
}

bool Detector::overlapsSeen(const Detection& pose) const {
  const double least = kOverlap * cap_.cap_radius;
  return std::ranges::any_of(seen_, [&](const Detection& other) {
    const double dx = pose.x - other.x;
    const double dy = pose.y - other.y;
    return dx * dx + dy * dy < least * least;
  });
}

bool Detector::measure(const optics::GreyView& picture, CirclePair& couple,
                       std::vector<Rejection>* rejected) {
  if (!fitBoth(picture, couple)) return false;
  const Circle& big = circleOf(couple.big, true);
  const Circle& small = circleOf(couple.small, false);
  const double dx = big.place.x - small.place.x;
  const double dy = big.place.y - small.place.y;
  const double spacing = std::sqrt(dx * dx + dy * dy);
  const double variance = ((big.covariance[0] + small.covariance[0]) * dx * dx +
                           2 * (big.covariance[1] + small.covariance[1]) * dx * dy +
                           (big.covariance[2] + small.covariance[2]) * dy * dy) /
                          (spacing * spacing);
  const double doubt = std::min(kMostDoubt, kScaleDoubt + kSigmas * std::sqrt(variance));
  const double off = spacing - cap_.spacing();
  if (!(std::abs(off) <= doubt)) {
    if (rejected != nullptr) {
      rejected->push_back({{(big.fit.x + small.fit.x) / 2, (big.fit.y + small.fit.y) / 2},
                           Reason::kSpacing,
                           static_cast<float>(spacing),
                           static_cast<float>(cap_.spacing() + (off > 0 ? doubt : -doubt))});
    }
    return false;
  }
  // Once more, where the fits have it: so the same wherever they began.
  const double share = cap_.big_offset / cap_.spacing();
  const optics::Pixel middle{big.fit.x - share * (big.fit.x - small.fit.x),
                             big.fit.y - share * (big.fit.y - small.fit.y)};
  couple.rim = rimContrast(picture, middle, scale_.at(middle.x, middle.y), cap_, imaging_,
                           RimSampling::kAll, std::min(big.fit.white, small.fit.white));
  if (couple.rim < kLeastRim) {
    if (rejected != nullptr) {
      rejected->push_back({middle, Reason::kNoCap, couple.rim, kLeastRim});
    }
    return false;
  }
  couple.cost =
      static_cast<float>(std::abs(off) / doubt) + std::max(0.0F, 1 - couple.rim / kUsualRim);
  return true;
}

}  // namespace lab::detector
