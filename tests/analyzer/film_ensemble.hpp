#pragma once

#include <cmath>
#include <vector>

#include "analyzer/program_analysis.hpp"
#include "walker.hpp"

namespace lab::analysis {

/// A film after stitching.
struct StitchedFilm {
  std::vector<Sample> samples;
  StitcherCounters counters;
  ProgramTally tally;
};

inline StitchedFilm stitch(const Film& film) {
  StitchedFilm result;
  TrackStitcher stitcher{StitcherConfig{}};
  Walker walker(film);
  walker.on_frame = [&](const TrackPoint& point) { stitcher.addFrame(point, result.samples); };
  walker.on_telemetry = [&](const RobotTelemetry& telemetry) {
    stitcher.addTelemetry(telemetry, result.samples);
  };
  walker.run();
  stitcher.flush(result.samples);
  result.counters = stitcher.counters();
  result.tally = stitcher.tally(0);
  return result;
}

inline ProgramResult analyseFilm(const Film& film, const StitchedFilm& stitched,
                                 double max_lag = 100) {
  ProgramAnalysis analysis(film.law, 1 / film.fps, max_lag);
  for (const Sample& sample : stitched.samples) {
    analysis.add(sample);
  }
  return analyse(film.law, analysis.data(), stitched.tally, CurveOptions{});
}

/// Mean and scatter of one number over films.
struct Scatter {
  double n = 0;
  double sum = 0;
  double sum2 = 0;

  void add(double x) {
    if (std::isfinite(x)) {
      n += 1;
      sum += x;
      sum2 += x * x;
    }
  }
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double deviation() const {
    return std::sqrt((sum2 - sum * sum / n) / (n - 1));
  }
  /// The deviation of the mean from `expected` in standard errors.
  [[nodiscard]] double z(double expected) const {
    return (mean() - expected) / (deviation() / std::sqrt(n));
  }
};

/// One lag over an ensemble of films.
struct LagScatter {
  double tau = 0;
  double exact = 0;
  Scatter value;
  Scatter sigma;
};

struct EnsembleCurves {
  std::vector<LagScatter> msd;
  std::vector<LagScatter> angular;

  void add(const ProgramResult& result) {
    addCurve(result.curves.msd, msd);
    addCurve(result.curves.angular_msd, angular);
  }

 private:
  static void addCurve(const std::vector<CurvePoint>& points, std::vector<LagScatter>& lags) {
    lags.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      lags[i].tau = points[i].tau;
      lags[i].exact = points[i].exact;
      lags[i].value.add(points[i].value);
      lags[i].sigma.add(points[i].sigma);
    }
  }
};

}  // namespace lab::analysis
