#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/bootstrap/curve_covariance.hpp"

namespace lab::analysis {

/// Simulated films of a program, from which its expected curves and their scatter follow.
struct FilmPlan {
  ProgramLaw law;         ///< Must have a motion.
  std::vector<int> lags;  ///< Frames, ascending.
  double frame_period = 0;
  double duration = 0;     ///< Of each film, s.
  double sigma = 0;        ///< Tracker noise per axis, m.
  double sigma_theta = 0;  ///< rad.
  RecordingGaps gaps;      ///< Of the measured recording.
  int films = 0;
  std::uint64_t seed = 1;
};

/// The number of films of a plan for a measured track, and the duration of each: they have at most
/// 4e7 frames together, whatever was measured.
/// @param track duration of a measured track, s
void setFilms(FilmPlan& plan, double track);

/// The films of a plan, made one after the other. The same plan gives the same bits.
class FilmReference {
 public:
  /// @param plan its films get shorter if they would have more than 1e8 draws together
  explicit FilmReference(FilmPlan plan);

  /// Simulates up to `films` more.
  void advance(int films);
  void finish() { advance(plan_.films); }
  [[nodiscard]] bool complete() const { return made_ >= plan_.films; }

  [[nodiscard]] const FilmPlan& plan() const { return plan_; }
  /// The curves, of lags that are at most a third of a film; `law` is their mean, with the noise.
  [[nodiscard]] const SimulatedCurves& curves() const { return curves_; }
  /// The expected curve without noise, m^2 or rad^2; nan: the lag is too long, or the gaps leave
  /// too few films with windows of this lag.
  [[nodiscard]] double expected(bool angular, std::size_t lag) const;

 private:
  FilmPlan plan_;
  std::vector<int> lags_;  ///< Of plan_.lags, those that are short enough.
  SimulatedCurves curves_;
  std::vector<int> counts_;  ///< By column of `curves_`: films with windows of this lag.
  int made_ = 0;
};

}  // namespace lab::analysis
