#include "analyzer/curves/lags.hpp"

#include <algorithm>
#include <cmath>

namespace lab::analysis {

std::vector<int> makeLagGrid(double frame_period, double max_lag, const ProgramLaw& law,
                             int count) {
  const int longest = std::max(1, static_cast<int>(std::floor(max_lag / frame_period + 1e-6)));
  std::vector<int> lags{1, longest};
  // The first points of a logarithmic grid round to the same frames: refine until enough differ.
  for (int points = count; points < 4 * count; points += 2) {
    lags.assign({1, longest});
    for (int i = 0; i < points; ++i) {
      const double exponent = static_cast<double>(i) / (points - 1);
      lags.push_back(static_cast<int>(std::lround(std::pow(longest, exponent))));
    }
    std::sort(lags.begin(), lags.end());
    lags.erase(std::unique(lags.begin(), lags.end()), lags.end());
    if (static_cast<int>(lags.size()) >= std::min(count - 2, longest)) {
      break;
    }
  }
  const double hold = law->held().value_or(HeldDraws{}).hold;
  if (hold > 0) {
    for (const double time : {hold, 2 * hold}) {
      const int frames = static_cast<int>(std::lround(time / frame_period));
      if (frames >= 1 && frames <= longest) {
        lags.push_back(frames);
      }
    }
    std::sort(lags.begin(), lags.end());
    lags.erase(std::unique(lags.begin(), lags.end()), lags.end());
  }
  return lags;
}

std::size_t nearestLag(const std::vector<int>& lags, double frames) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < lags.size(); ++i) {
    if (std::abs(lags[i] - frames) < std::abs(lags[best] - frames)) {
      best = i;
    }
  }
  return best;
}

}  // namespace lab::analysis
