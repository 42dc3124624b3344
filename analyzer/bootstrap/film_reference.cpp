#include "analyzer/bootstrap/film_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr double kMostFrames = 4e7;   // of all films
constexpr double kLongestFilm = 5e5;  // frames
constexpr double kMostDraws = 1e8;    // of all films: about 20 s of a core
constexpr int kFewestFilms = 80;
constexpr int kMostFilms = 400;
constexpr double kLeastShare = 0.9;  // of films; those with windows of a lag are a selection
constexpr double kFilmsPerLag = 3;   // length of a film, in lags

}  // namespace

void setFilms(FilmPlan& plan, double track) {
  const double frames = std::min(track / plan.frame_period, kLongestFilm);
  plan.duration = frames * plan.frame_period;
  plan.films = static_cast<int>(std::clamp(kMostFrames / std::max(frames, 1.0),
                                           static_cast<double>(kFewestFilms),
                                           static_cast<double>(kMostFilms)));
}

FilmReference::FilmReference(FilmPlan plan) : plan_(std::move(plan)) {
  // Frames may be hours apart, and each of them costs all draws since the one before.
  const double draw = plan_.law->drawTime() / plan_.law->changesPerDraw();
  if (draw > 0) {
    plan_.duration = std::min(plan_.duration, kMostDraws / std::max(plan_.films, 1) * draw);
  }
  for (const int lag : plan_.lags) {
    if (kFilmsPerLag * lag * plan_.frame_period > plan_.duration) break;
    lags_.push_back(lag);
    curves_.lags.push_back(lag * plan_.frame_period);
  }
  curves_.duration = plan_.duration * (1 - plan_.gaps.unseen);
  curves_.cut = plan_.gaps.cut;
  curves_.law.assign(2 * lags_.size(), 0);
  counts_.assign(2 * lags_.size(), 0);
}

void FilmReference::advance(int films) {
  RecordingPoses poses;
  RecordingStretches stretches;
  for (; films > 0 && !complete(); --films) {
    const std::uint64_t seed = plan_.seed + static_cast<std::uint64_t>(made_++);
    simulateRecording(
        {plan_.law, plan_.duration, plan_.frame_period, plan_.sigma, plan_.sigma_theta, 0}, seed,
        poses);
    if (plan_.gaps.lost > 0 || plan_.gaps.cut) {
      stretches =
          drawStretches(plan_.gaps, plan_.frame_period, plan_.frame_period, poses.x.size(), ~seed);
    }
    const std::vector<double> curves = recordingCurves(poses, lags_, lags_, 1, stretches);
    // A film without any window does not count. Gaps may leave no window of a long lag in some
    // films, or in all; expected() leaves out such lags.
    if (lags_.empty() || std::isnan(curves.front())) continue;
    ++curves_.recordings;
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (std::isnan(curves[i])) continue;
      curves_.law[i] += (curves[i] - curves_.law[i]) / ++counts_[i];
    }
    curves_.values.insert(curves_.values.end(), curves.begin(), curves.end());
  }
}

double FilmReference::expected(bool angular, std::size_t lag) const {
  if (lag >= lags_.size() || curves_.recordings == 0) return units::kNan;
  const int films = counts_[angular ? lags_.size() + lag : lag];
  if (films < kLeastShare * curves_.recordings) return units::kNan;
  return angular ? curves_.law[lags_.size() + lag] - 2 * plan_.sigma_theta * plan_.sigma_theta
                 : curves_.law[lag] - 4 * plan_.sigma * plan_.sigma;
}

}  // namespace lab::analysis
