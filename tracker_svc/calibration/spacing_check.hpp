/// A standing check of a camera's calibration: the two circles of every cap are a known length
/// apart, in every frame and everywhere in the arena. Numbers in, numbers out.
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
  double window = 5;            ///< [s] that are compared with what was before
  double baseline = 120;        ///< [s] of the start that later windows are compared with
  /// [m] that the spacing may be off at any one place, the same in every frame: the cap's make,
  /// what the circle fit does there. Frames do not average it away, places do.
  double place_error = 20e-6;
  double common_error = 0.001;  ///< [1] that the caps may all be made too wide, or too narrow
  double uneven_error = 0.001;  ///< [1/m] that the calibration's own error may change by
  double least_shift = 0.3e-3;  ///< [m] a move that changes positions less (rms) is none
  double most_shift = 1.5e-3;   ///< [m] a calibration that is off by more (rms) does not fit
};

/// What the spacings say of the calibration.
struct SpacingReport {
  double mean_error = 0;  ///< [m] measured less known spacing, over the last full window
  double sigma = 0;       ///< [m] standard error of mean_error
  double scale = 0;       ///< [1] mean_error / spacing: lengths are measured too long by this share
  double slope_x = 0;     ///< [1/m] how the scale changes along x of the arena
  double slope_y = 0;     ///< [1/m]
  double position_error = 0;  ///< [m] rms over the arena that the scale and its slopes stand for,
                              ///< less what their noise adds to it
  double position_sigma = 0;  ///< [m] standard error of position_error
  double shift = 0;           ///< [m] the same since the start: of what changed
  double chi2 = 0;            ///< [1] of the change, 3 degrees of freedom
  bool known = false;         ///< there was a window with caps in it
  bool moved = false;         ///< the camera is not where it was at the start
  bool fits = true;           ///< false: it is not where it was calibrated
  std::string text;           ///< for people: one line, empty when all is well
};

/// Takes every measured spacing and watches its scale and the slope of it over the arena.
///
/// A camera that goes up or down changes the scale; one that tilts changes the slopes: a tilt of a
/// moves positions by h a and the scale along x by 1.5 a / h a metre (mean over all headings), h
/// the height above the caps. Sideways moves and turns about its own axis change no spacing: they
/// cannot be seen here.
///
/// Windows of `window` are fitted by scale + slopes, each over the means of places 10 cm wide, with
/// `place_error` in each. The windows of the first `baseline` give the reference, and the scatter
/// among them widens the errors where it is larger than expected. Two windows in a row beyond 1 in
/// 60,000 (chi^2 of 25 for 3 degrees of freedom, wider while few windows are known) and a shift of
/// more than `least_shift` make a move: less than one false alarm in a year when errors are normal,
/// less than one a day when they are half as large again as claimed.
class SpacingCheck {
 public:
  explicit SpacingCheck(const SpacingSettings& settings = {});

  /// A cap was seen at (x, y) [m] with its circles `spacing` [m] apart, sigma [m]. Times [s] may
  /// not go back. What is not finite or has no sigma is left out.
  void add(double time, double x, double y, double spacing, double sigma);

  [[nodiscard]] SpacingReport report(double time);

  /// What all that was added says, as one window, of a recording: `window` must be longer than it
  /// is. Errors are widened by the scatter of places about the fit, so that a codec's, which stay
  /// from frame to frame, are no slope; with three places or fewer nothing is known.
  [[nodiscard]] SpacingReport whole() const;

 private:
  using Vector = Eigen::Vector3d;  // scale, slope along x, slope along y
  using Matrix = Eigen::Matrix3d;

  struct Place {
    double weight = 0;  // sum of 1 / sigma^2
    double error = 0;   // weighted sums: of relative errors, and of where they were taken
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
  void take(const Fit& window);
  [[nodiscard]] Fit fitOf(const std::vector<Place>& places, Place& middle) const;
  [[nodiscard]] double varianceOf(const Place& place) const;
  [[nodiscard]] double widening() const;
  [[nodiscard]] bool misfits(const Vector& value, const Matrix& covariance,
                             SpacingReport& report) const;
  [[nodiscard]] Vector shiftWeights() const;
  [[nodiscard]] double shiftOf(const Vector& change, const Matrix& covariance) const;
  void describe(SpacingReport& report) const;

  SpacingSettings settings_;
  std::vector<Place> places_;  // of the window that is being filled, row by row
  int columns_ = 1;
  int rows_ = 1;
  std::optional<double> window_begin_;
  double covered_ = 0;  // [s] in baseline windows
  std::vector<Fit> first_;
  Fit baseline_;
  int beyond_ = 0;   // windows in a row that differ from the baseline
  int misfits_ = 0;  // windows in a row that differ from the calibration
  SpacingReport last_;
};

}  // namespace lab::calibration
