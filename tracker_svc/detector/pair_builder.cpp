#include "tracker_svc/detector/pair_builder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "tracker_svc/detector/cap_check.hpp"

namespace lab::detector {
namespace {

constexpr float kRoughSpacing = 0.006F;  // [m] error of the spacing of two spots
constexpr float kAgain = 0.012F;         // [m] the same, if a light edge may have displaced them
constexpr double kScaleDoubt = 0.0009;   // [m] of the spacing: a camera scale that is 2.5 % off
constexpr double kMostDoubt = 0.0015;    // [m] largest tolerance of the spacing
constexpr double kSigmas = 4;
constexpr float kClearer = 2;  // [1] factor on the contrast of another rim

}  // namespace

void PairBuilder::gather(std::size_t first, std::vector<Rejection>* rejected) {
  pairs_.clear();
  if (first == circles_.size()) return;
  // Sorted by row, so that each spot is compared with few others.
  order_.clear();
  for (std::size_t i = 0; i < circles_.size(); ++i) {
    if (!circles_.isAssigned(i)) order_.push_back(i);
  }
  std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(circles_.spots()[a].y, a) < std::tie(circles_.spots()[b].y, b);
  });
  const float reach =
      (static_cast<float>(setup_.cap.spacing()) + kRoughSpacing) * setup_.scale.largest();
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Spot& one = circles_.spots()[order_[i]];
    for (std::size_t j = i + 1; j < order_.size(); ++j) {
      const Spot& other = circles_.spots()[order_[j]];
      const float dx = other.x - one.x;
      const float dy = other.y - one.y;
      if (dy > reach) break;
      if (dx * dx + dy * dy > reach * reach || std::max(order_[i], order_[j]) < first) continue;
      if (one.can_be_big && other.can_be_small) addCirclePair(order_[i], order_[j]);
      if (other.can_be_big && one.can_be_small) addCirclePair(order_[j], order_[i]);
    }
  }
  // Fits to objects that are no caps are slow. The coarse rim check rejects most of these. For two
  // round circles without other partners the fits are fast and the check after them is enough.
  partners_.assign(circles_.size(), 0);
  for (const CirclePair& pair : pairs_) {
    for (const int spot : {pair.big, pair.small}) ++partners_[static_cast<std::size_t>(spot)];
  }
  const auto isSure = [&](int spot) {
    const auto at = static_cast<std::size_t>(spot);
    return partners_[at] == 1 &&
           circles_.spots()[at].can_be_big != circles_.spots()[at].can_be_small;
  };
  std::erase_if(pairs_, [&](CirclePair& pair) {
    return !(isSure(pair.big) && isSure(pair.small)) && !hasRim(pair, rejected);
  });
  std::sort(pairs_.begin(), pairs_.end(), [](const CirclePair& a, const CirclePair& b) {
    return std::tie(a.big, a.small) < std::tie(b.big, b.small);
  });
}

bool PairBuilder::addCirclePair(std::size_t big_spot, std::size_t small_spot) {
  const Spot& big = circles_.spots()[big_spot];
  const Spot& small = circles_.spots()[small_spot];
  const auto spacing = static_cast<float>(setup_.cap.spacing());
  const float reach = (spacing + kRoughSpacing) * setup_.scale.largest();
  const float dx = big.x - small.x;
  const float dy = big.y - small.y;
  if (dx * dx + dy * dy > reach * reach) return false;
  const optics::Pixel middle = middleOf(big, small);
  const LocalScale& scale = setup_.scale.near(middle.x, middle.y);
  if (scale.mean <= 0) return false;
  const float across = scale.inverse[0] * dx + scale.inverse[1] * dy;
  const float along = scale.inverse[2] * dx + scale.inverse[3] * dy;
  const float distance = std::sqrt(across * across + along * along);
  if (std::abs(distance - spacing) > kRoughSpacing) return false;
  pairs_.push_back({static_cast<int>(big_spot), static_cast<int>(small_spot), 0, 0});
  return true;
}

optics::Pixel PairBuilder::middleOf(const Spot& big, const Spot& small) const {
  const auto share = static_cast<float>(setup_.cap.big_offset / setup_.cap.spacing());
  return {static_cast<double>(big.x - (big.x - small.x) * share),
          static_cast<double>(big.y - (big.y - small.y) * share)};
}

bool PairBuilder::hasRim(CirclePair& pair, std::vector<Rejection>* rejected) const {
  const optics::Pixel middle = middleOf(circles_.spots()[static_cast<std::size_t>(pair.big)],
                                        circles_.spots()[static_cast<std::size_t>(pair.small)]);
  const LocalScale scale = setup_.scale.at(middle.x, middle.y);
  for (const RimSampling look : {RimSampling::kRough, RimSampling::kAll}) {
    pair.rim = rimContrast(circles_.picture(), middle, scale, setup_.cap, setup_.imaging, look,
                           kSaturatedWhite);
    if (pair.rim >= kLeastRim) return true;
  }
  if (rejected != nullptr) rejected->push_back({middle, Reason::kNoCap, pair.rim, kLeastRim});
  return false;
}

void PairBuilder::lookAgain(std::vector<Rejection>* rejected) {
  // A light edge may have made a circle look like a smaller one beside it. Two remaining spots at
  // about the spacing of a cap are centred again, as circles of the right sizes.
  pairs_.clear();
  order_.clear();
  for (std::size_t i = 0; i < circles_.size(); ++i) {
    if (!circles_.isAssigned(i)) order_.push_back(i);
  }
  const float most = (static_cast<float>(setup_.cap.spacing()) + kAgain) * setup_.scale.largest();
  const float least = (static_cast<float>(setup_.cap.spacing()) - kAgain) * setup_.scale.smallest();
  for (const std::size_t i : order_) {
    std::optional<Spot> big;
    bool looked = false;
    for (const std::size_t j : order_) {
      const float dx = circles_.spots()[i].x - circles_.spots()[j].x;
      const float dy = circles_.spots()[i].y - circles_.spots()[j].y;
      const float square = dx * dx + dy * dy;
      if (i == j || square > most * most || square < least * least) continue;
      if (!looked) big = search_.centredAs(circles_.spots()[i], true);
      looked = true;
      if (!big) break;
      const std::optional<Spot> small = search_.centredAs(circles_.spots()[j], false);
      if (!small) continue;
      circles_.add(*big);
      circles_.add(*small);
      if (addCirclePair(circles_.size() - 2, circles_.size() - 1) &&
          !hasRim(pairs_.back(), rejected)) {
        pairs_.pop_back();
      }
    }
  }
}

// Fits to objects that are no caps are slow. So a pair waits if one of its spots has another pair
// with a much clearer rim (as between circles of two robots), or if its small circle looks larger
// than its big one.
void PairBuilder::settlePairs(std::vector<Rejection>* rejected) {
  clearest_.assign(circles_.size(), 0.0F);
  for (const CirclePair& pair : pairs_) {
    for (const int spot : {pair.big, pair.small}) {
      float& rim = clearest_[static_cast<std::size_t>(spot)];
      rim = std::max(rim, pair.rim);
    }
  }
  doubtful_.clear();
  std::erase_if(pairs_, [&](const CirclePair& pair) {
    const float rim = std::max(clearest_[static_cast<std::size_t>(pair.big)],
                               clearest_[static_cast<std::size_t>(pair.small)]);
    const float big = circles_.spots()[static_cast<std::size_t>(pair.big)].size;
    const float small = circles_.spots()[static_cast<std::size_t>(pair.small)].size;
    const bool is_doubtful = small > big || (rim >= kUsualRim && rim > kClearer * pair.rim);
    if (is_doubtful) doubtful_.push_back(pair);
    return is_doubtful;
  });
  settle(pairs_, rejected);
  std::erase_if(doubtful_, [&](const CirclePair& pair) {
    return circles_.isAssigned(static_cast<std::size_t>(pair.big)) ||
           circles_.isAssigned(static_cast<std::size_t>(pair.small));
  });
  settle(doubtful_, rejected);
}

void PairBuilder::settle(std::vector<CirclePair>& pairs, std::vector<Rejection>* rejected) {
  std::erase_if(pairs, [&](CirclePair& pair) { return !measure(pair, rejected); });
  pairs.resize(choosePairs(pairs, static_cast<int>(circles_.size())));
  for (const CirclePair& pair : pairs) {
    circles_.assign(pair.big);
    circles_.assign(pair.small);
    const Detection pose = poseOf(pair);
    if (!known_.overlaps(pose)) {
      known_.add(pose);
      known_.cover(search_, pose);
    } else if (rejected != nullptr) {
      rejected->push_back({pose.middle, Reason::kTaken, pair.cost, 0});
    }
  }
}

bool PairBuilder::measure(CirclePair& pair, std::vector<Rejection>* rejected) {
  if (!circles_.fitBoth(pair)) return false;
  const FittedCircles::Circle& big = circles_.of(pair.big, true);
  const FittedCircles::Circle& small = circles_.of(pair.small, false);
  const double dx = big.place.x - small.place.x;
  const double dy = big.place.y - small.place.y;
  const double spacing = std::sqrt(dx * dx + dy * dy);
  const double variance = ((big.covariance[0] + small.covariance[0]) * dx * dx +
                           2 * (big.covariance[1] + small.covariance[1]) * dx * dy +
                           (big.covariance[2] + small.covariance[2]) * dy * dy) /
                          (spacing * spacing);
  const double doubt = std::min(kMostDoubt, kScaleDoubt + kSigmas * std::sqrt(variance));
  const double off = spacing - setup_.cap.spacing();
  if (!(std::abs(off) <= doubt)) {
    if (rejected != nullptr) {
      rejected->push_back({{(big.fit.x + small.fit.x) / 2, (big.fit.y + small.fit.y) / 2},
                           Reason::kSpacing,
                           static_cast<float>(spacing),
                           static_cast<float>(setup_.cap.spacing() + (off > 0 ? doubt : -doubt))});
    }
    return false;
  }
  // The rim is checked again at the fitted position, so that the result does not depend on the
  // start.
  const double share = setup_.cap.big_offset / setup_.cap.spacing();
  const optics::Pixel middle{big.fit.x - share * (big.fit.x - small.fit.x),
                             big.fit.y - share * (big.fit.y - small.fit.y)};
  pair.rim =
      rimContrast(circles_.picture(), middle, setup_.scale.at(middle.x, middle.y), setup_.cap,
                  setup_.imaging, RimSampling::kAll, std::min(big.fit.white, small.fit.white));
  if (pair.rim < kLeastRim) {
    if (rejected != nullptr) {
      rejected->push_back({middle, Reason::kNoCap, pair.rim, kLeastRim});
    }
    return false;
  }
  pair.cost = static_cast<float>(std::abs(off) / doubt) + std::max(0.0F, 1 - pair.rim / kUsualRim);
  return true;
}

MeasuredPoint PairBuilder::measuredPointOf(const FittedCircles::Circle& circle,
                                           const FittedCircles::Circle& other) const {
  const auto lookOf = [](const CircleFit& fit) {
    return PaintEstimate{static_cast<double>(fit.white), static_cast<double>(fit.ratio),
                         static_cast<double>(fit.ratio_error), static_cast<double>(fit.blur)};
  };
  MeasuredPoint out{circle.place, circle.covariance};
  const double moved = shiftByGlare(lookOf(circle.fit), lookOf(other.fit));
  if (moved > 0) {
    const double metres =
        moved / static_cast<double>(setup_.scale.at(circle.fit.x, circle.fit.y).mean);
    out.covariance[0] += metres * metres;
    out.covariance[2] += metres * metres;
  }
  return out;
}

Detection PairBuilder::poseOf(const CirclePair& pair) const {
  const FittedCircles::Circle& big = circles_.of(pair.big, true);
  const FittedCircles::Circle& small = circles_.of(pair.small, false);
  const CapPose pose =
      poseFromCircles(measuredPointOf(big, small), measuredPointOf(small, big), setup_.cap);
  Detection out;
  out.x = pose.x;
  out.y = pose.y;
  out.theta = pose.theta;
  out.covariance = pose.covariance;
  const double across = big.place.x - small.place.x;
  const double along = big.place.y - small.place.y;
  out.spacing = static_cast<float>(std::sqrt(across * across + along * along));
  out.white = (big.fit.white + small.fit.white) / 2;
  out.ratio = (big.fit.ratio + small.fit.ratio) / 2;
  const float blur = (big.fit.blur + small.fit.blur) / 2;
  out.blur = std::sqrt(std::max(0.0F, blur * blur - static_cast<float>(optics::kPixelBox)));
  out.big = {big.fit.x, big.fit.y};
  out.small = {small.fit.x, small.fit.y};
  out.middle = setup_.camera.project(out.x, out.y, setup_.cap.height);
  out.used = kUsedBig | kUsedSmall;
  if (big.fit.edge || small.fit.edge) out.used |= kUsedEdge;
  const float clean = 1 / std::max({1.0F, big.fit.residual, small.fit.residual});
  out.quality = 0.5F + 0.5F * std::min(1.0F, pair.rim / kUsualRim) * std::exp(-pair.cost / 2) *
                           std::sqrt(clean);
  return out;
}

void PairBuilder::settleOne(const CirclePair& pair, std::vector<Rejection>* rejected) {
  pairs_.assign(1, pair);
  settlePairs(rejected);
}

}  // namespace lab::detector
