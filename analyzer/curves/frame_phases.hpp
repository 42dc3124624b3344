/// What remains of the phases at which frames lie within holds.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "analyzer/laws/law.hpp"
#include "analyzer/laws/phased_noise.hpp"

namespace lab::analysis {

class Estimator;

/// The exact laws are averages over the phase of the hold at which a window begins. If a hold lasts
/// a few frames (2, 3, 5/2), frames lie at a few phases only, the same ones until the clocks of
/// camera and robot have drifted apart. Curves at lags of a few frames then deviate from the law by
/// what these phases are, which no number of draws averages out: with holds of two frames by -10 to
/// 20 % at one frame. The deviations here are those of recordings in which the clocks agree better
/// than in all but kUnlucky of them.
class FramePhases {
 public:
  static constexpr int kPhases = 8;
  static constexpr double kUnlucky = 0.01;  ///< Share of recordings whose clocks agree better.
  using Deviations = std::array<double, kPhases>;

  /// @param observed time of all tracks, s
  FramePhases(const ProgramLaw& law, double frame_period, double observed, double tracks);
  /// The same of a law whose curves are simulated, of the angular MSD alone.
  /// @param angular_msd rad^2 at `tau` (s), which is not shorter than the hold
  FramePhases(const ProgramLaw& law, double tau, double angular_msd, double frame_period,
              double observed, double tracks);

  /// False: all deviations are 0.
  [[nodiscard]] bool matter() const { return noise_ != nullptr; }

  /// The number of frames after which they lie at the same phases again.
  [[nodiscard]] int repeat() const { return phases_; }

  /// The deviations from the law at a lag, m^2 or rad^2, if the first frame lies at one of equally
  /// spaced phases; their mean square is the variance.
  /// @param frames the lag, a whole number
  [[nodiscard]] Deviations of(bool angular, double frames) const;

  /// The mean variance by all clocks over that of the deviations here, at most 1.
  [[nodiscard]] double usual() const { return usual_; }

 private:
  void setTurning(double tau, double angular_msd);

  std::shared_ptr<const PhasedNoise> noise_;
  double hold_;                ///< s; 0: they are not equal
  bool drawn_wheels_ = false;  ///< The MSD deviates too.
  int phases_ = 1;             ///< Frames that lie at different phases, after which they repeat.
  double period_ = 0;          ///< Of the frames, if they do exactly, s.
  double left_ = 0;            ///< Share of the deviations that drift leaves.
  double usual_ = 1;
};

/// The standard errors, by this, of the angular MSD less the noise of the heading [rad^2].
/// @param lags in frames
[[nodiscard]] std::vector<double> phaseErrors(const FramePhases& phases, const Estimator& estimator,
                                              const std::vector<int>& lags);

/// The same of the MSD [m^2].
[[nodiscard]] std::vector<double> phaseErrors(const FramePhases& phases,
                                              const std::vector<int>& lags);

/// The standard errors by deviations, for each lag those of all phases.
[[nodiscard]] std::vector<double> errorsOf(const std::vector<FramePhases::Deviations>& lags);

}  // namespace lab::analysis
