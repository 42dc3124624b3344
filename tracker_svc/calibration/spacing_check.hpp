/// Monitors a camera calibration while it is in use: the spacing of the two circles of every cap is
/// known, in every frame and everywhere in the arena. No input or output.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace lab::calibration {

struct SpacingSettings {
  double spacing = 0.036;       ///< [m] between the centres of the two circles
  double arena_width = 1.20;    ///< [m]
  double arena_height = 0.90;   ///< [m]
  double camera_height = 1.67;  ///< [m] of the camera above the caps
  double window = 5;            ///< [s] length of the windows
  double baseline = 120;        ///< [s] of initial windows that serve as reference
  /// [m] systematic error of the spacing at one place, equal in all frames: from the make of the
  /// caps and from the circle fit. Averages over places but not over frames.
  double place_error = 20e-6;
  double common_error = 0.001;  ///< [1] common relative error of the width of all caps
  double uneven_error = 0.001;  ///< [1/m] slope of the calibration's own scale error
  /// [m] rms change of positions below which the camera counts as unmoved
  double least_shift = 0.3e-3;
  /// [m] rms error of positions above which the calibration is rejected
  double most_shift = 1.5e-3;
};

/// State of the calibration according to the spacings.
struct SpacingReport {
  double mean_error = 0;      ///< [m] measured minus known spacing, over the last complete window
  double sigma = 0;           ///< [m] standard error of mean_error
  double scale = 0;           ///< [1] mean_error / spacing: relative error of lengths
  double slope_x = 0;         ///< [1/m] change of the scale along x of the arena
  double slope_y = 0;         ///< [1/m]
  double position_error = 0;  ///< [m] rms over the arena due to the scale and its slopes,
                              ///< corrected for their noise
  double position_sigma = 0;  ///< [m] standard error of position_error
  double shift = 0;           ///< [m] rms change of positions since the start
  double chi2 = 0;            ///< [1] of that change, with 3 degrees of freedom
  bool known = false;         ///< whether a window with caps is complete
  bool moved = false;         ///< the camera has moved since the start
  bool fits = true;           ///< false: the camera has moved since its calibration
  std::string text;           ///< one line for users, empty if there is no problem
};

/// Estimates the scale of measured spacings and its slopes over the arena.
///
/// If the camera moves up or down, the scale changes; if it tilts, the slopes change: a tilt of a
/// displaces positions by h a and changes the scale along x by 1.5 a / h per metre (mean over all
/// headings), h being the height above the caps. Sideways moves and rotations about the optical
/// axis change no spacing and cannot be detected here.
///
/// Each window of `window` seconds is fitted by a scale and two slopes, over means of cells 10 cm
/// wide with an error of `place_error` each. The windows of the first `baseline` seconds are the
/// reference; their scatter widens the errors if it is larger than expected. The camera counts as
/// moved after two consecutive windows beyond 1 in 60,000 (chi^2 of 25 with 3 degrees of freedom,
/// wider while there are few windows) and a shift above `least_shift`: less than one false alarm
/// per year for normal errors, less than one per day if the errors are 50 % larger than assumed.
class SpacingCheck {
 public:
  explicit SpacingCheck(const SpacingSettings& settings = {});

  /// Adds a cap at (x, y) [m] with its circles `spacing` [m] apart, standard error sigma [m]. Times
  /// [s] must not decrease. Values that are not finite and sigmas of 0 are ignored.
  void add(double time, double x, double y, double spacing, double sigma);

  [[nodiscard]] SpacingReport report(double time);

  /// Evaluates a whole recording as one window: `window` must be longer than the recording. Errors
  /// are widened by the scatter of cells about the fit, so that codec artefacts, which persist over
  /// frames, are not taken for slopes; requires more than three cells.
  [[nodiscard]] SpacingReport whole() const;

 private:
  using Vector = Eigen::Vector3d;  // scale, slope along x, slope along y
  using Matrix = Eigen::Matrix3d;

  struct Place {
    double weight = 0;  // sum of 1 / sigma^2
    double error = 0;   // weighted sums of relative errors and of their places
    double x = 0;
    double y = 0;
    [[nodiscard]] Vector slopes() const { return {1, x / weight, y / weight}; }
  };
  struct Fit {
    Matrix information = Matrix::Zero();
    Vector gradient = Vector::Zero();
    [[nodiscard]] Vector value() const;
    [[nodiscard]] Matrix covariance() const;
  };

  void closeWindows(double time);
  void evaluate(const Fit& window);
  [[nodiscard]] Fit fitOf(const std::vector<Place>& places, Place& middle) const;
  [[nodiscard]] double varianceOf(const Place& place) const;
  [[nodiscard]] double widening() const;
  [[nodiscard]] bool misfits(const Vector& value, const Matrix& covariance,
                             SpacingReport& report) const;
  [[nodiscard]] Vector shiftWeights() const;
  [[nodiscard]] double shiftOf(const Vector& change, const Matrix& covariance) const;
  void describe(SpacingReport& report) const;

  SpacingSettings settings_;
  std::vector<Place> places_;  // of the current window, row by row
  int columns_ = 1;
  int rows_ = 1;
  std::optional<double> window_begin_;
  double covered_ = 0;  // [s] covered by reference windows
  std::vector<Fit> first_;
  Fit baseline_;
  int beyond_ = 0;   // consecutive windows that differ from the reference
  int misfits_ = 0;  // consecutive windows that differ from the calibration
  SpacingReport last_;
};

}  // namespace lab::calibration
