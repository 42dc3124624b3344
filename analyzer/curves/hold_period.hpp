/// The time between changes of the turning rate, from the headings alone.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "analyzer/tracks/track_stitcher.hpp"

namespace lab::analysis {

/// Spectra of when the turning rate changes, summed over blocks of some holds each.
struct HoldSpectra {
  static constexpr std::size_t kFrequencies = 51;  ///< 0.75 to 1.25 of that of the program.
  static constexpr std::size_t kGroups = 16;       ///< Blocks in turn; they give the error.
  using Spectrum = std::array<double, kFrequencies>;

  double hold = 0;   ///< Of the program, s; 0: there are no spectra.
  double reach = 0;  ///< Distance of the headings of a difference, in holds.
  std::array<Spectrum, kGroups> power{};
  std::array<double, kGroups> blocks{};

  void pool(const HoldSpectra& other);
};

/// The measured hold time.
struct HoldPeriod {
  double value = 0;       ///< s.
  double sigma = 0;       ///< Standard error, s.
  double programmed = 0;  ///< s.
  double blocks = 0;
  /// Deviation from the programmed one in standard errors; the error includes that of the robots'
  /// clocks.
  double z = 0;
};

/// Collects the spectra of one robot and program. A turning rate that is held changes at multiples
/// of the hold time only, so the squared second differences of the heading have a line at this
/// frequency, whatever is drawn. Their phase is not used beyond a block: clocks may drift.
class HoldPeriodFinder {
 public:
  /// Whether the frames are close enough together, and not so close that a hold has more than
  /// 20 000 of them.
  [[nodiscard]] static bool resolves(double hold, double frame_period);

  /// @param hold as programmed, s; every hold has this duration
  HoldPeriodFinder(double hold, double frame_period);

  void add(const Sample& sample);

  [[nodiscard]] const HoldSpectra& spectra() const { return spectra_; }

 private:
  struct Heading {
    double time = 0;  ///< Free time, s.
    double theta = 0;
  };
  struct Change {
    double time = 0;
    double square = 0;
  };

  void endBlock();
  /// Adds the power of the changes of the block, each with its amplitude.
  void addPower(const std::vector<double>& amplitudes, HoldSpectra::Spectrum& power) const;

  HoldSpectra spectra_;
  double period_;
  double block_;           ///< Duration of a block, s.
  std::size_t distance_;   ///< Of the headings of a difference, frames.
  std::size_t stride_;     ///< Between differences, frames.
  std::size_t count_ = 0;  ///< Frames so far.
  std::size_t next_group_ = 0;
  std::vector<Change> changes_;    ///< Of the block.
  double begin_ = 0;               ///< Of the block: free time, s.
  std::vector<Heading> headings_;  ///< The last ones, without a gap; a ring.
  std::size_t known_ = 0;          ///< Frames without a gap, up to last_.
  Sample last_;
};

/// Nothing if no line stands out, or if it lies too far from the programmed hold.
[[nodiscard]] std::optional<HoldPeriod> holdPeriod(const HoldSpectra& spectra);

}  // namespace lab::analysis
