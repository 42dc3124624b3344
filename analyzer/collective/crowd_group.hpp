/// Accumulates the observables of a group of robots: all of them, or those of a program.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analyzer/collective/contact_tracker.hpp"
#include "analyzer/collective/density.hpp"
#include "analyzer/collective/density_map.hpp"
#include "analyzer/collective/observable.hpp"
#include "analyzer/collective/observation.hpp"
#include "analyzer/collective/pair_correlations.hpp"
#include "analyzer/collective/places.hpp"
#include "analyzer/collective/whole_motion.hpp"

namespace lab::collective {

/// Names of the places of one kind, such as the regions; the last one is the rest.
struct PlaceNames {
  std::vector<std::string> names;
};

/// Time and changes in places of one kind.
struct PlaceResult {
  std::vector<std::string> names;
  std::vector<Average> shares;  ///< of the robots' time
  std::vector<double> now;      ///< share of the robots in the last frame; empty: unknown
  std::vector<Average> stays;   ///< [s] mean duration of a stay: time over number of ends
  /// Changes per second [1/s], from the place of the row to that of the column.
  std::vector<std::vector<Average>> flux;
};

/// A number in consecutive stretches of the recording, for pictures.
struct Stretch {
  double begin = 0;  ///< [s]
  double end = 0;
  std::vector<double> values;  ///< by Scalar; nan: not defined
  std::vector<double> sigmas;  ///< standard errors of the values as averages over the stretch
};

struct CrowdResult {
  int group = -1;          ///< key of the program; -1: all robots
  std::size_t frames = 0;  ///< that were evaluated
  double observed = 0;     ///< [s] time that they stand for
  double robots = 0;       ///< mean number
  std::vector<Observable> numbers;
  std::vector<ObservableCurve> curves;
  Modes modes;  ///< of the densities of cells
  PlaceResult regions;
  PlaceResult bands;
};

/// Rates: what happens between two evaluated frames, from all camera frames.
struct RateChannels {
  std::size_t regions = 0;  ///< number of places of each kind
  std::size_t bands = 0;

  enum First : std::size_t {
    kTime,         ///< [s]
    kRobotTime,    ///< [s] summed over robots
    kTouching,     ///< [s] robots that touch another one
    kAtWall,       ///< [s]
    kPairTime,     ///< [s] pairs in contact
    kContactEnds,  ///< contacts that ended
    kWallEnds,     ///< stays at a wall that ended
    kFirstPlace
  };
  [[nodiscard]] std::size_t regionTime(std::size_t i) const { return kFirstPlace + i; }
  [[nodiscard]] std::size_t regionChange(std::size_t from, std::size_t to) const {
    return kFirstPlace + regions + from * regions + to;
  }
  [[nodiscard]] std::size_t bandTime(std::size_t i) const {
    return kFirstPlace + regions + regions * regions + i;
  }
  [[nodiscard]] std::size_t bandChange(std::size_t from, std::size_t to) const {
    return bandTime(0) + bands + from * bands + to;
  }
  [[nodiscard]] std::size_t count() const { return bandTime(0) + bands + bands * bands; }
};

class CrowdGroup {
 public:
  CrowdGroup(int key, const CrowdSettings& settings, const PlaceNames& regions,
             const PlaceNames& bands);

  /// The sums of the time since the last evaluated frame: add to them in every camera frame.
  [[nodiscard]] std::span<double> rates() { return rates_.frame(); }
  [[nodiscard]] const RateChannels& channels() const { return channels_; }
  void addContact(double duration);

  /// Numbers of robots in each region in the current frame.
  void setRegionCounts(const std::vector<double>& counts) { region_counts_ = counts; }

  /// Takes an evaluated frame of at least one robot. Averages and correlations take it if there
  /// are two robots or more.
  void take(double time, const std::vector<CrowdRobot>& robots,
            const FrameObservation& observation);

  /// Frees the memory of a robot that has not been seen for long.
  void forget(int robot) { motion_.forget(robot); }

  [[nodiscard]] CrowdResult result() const;

  /// At most `most` stretches of equally many frames.
  [[nodiscard]] std::vector<Stretch> stretches(std::size_t most) const;
  [[nodiscard]] CrowdMap map() const { return map_.map(); }

 private:
  // Channels of a number: sum, sum of squares, frames in which it is defined.
  static constexpr std::size_t kPerScalar = 3;
  static constexpr std::size_t kBlocks = 1024;
  static constexpr std::size_t kSizes = 24;  // classes of cluster sizes

  [[nodiscard]] ObservableCurve clusterSizes() const;
  [[nodiscard]] ObservableCurve contactTimes() const;
  void addRates(CrowdResult& result) const;
  [[nodiscard]] PlaceResult places(const PlaceNames& names, bool of_bands) const;

  int key_;
  CrowdSettings settings_;
  PlaceNames region_names_;
  PlaceNames band_names_;
  RateChannels channels_;
  BlockedSums scalars_;
  BlockedSums rates_;
  BlockedSums sizes_;
  PairCorrelations pairs_;
  DensityDistribution density_;
  NumberFluctuations fluctuations_;
  DensityMap map_;
  WholeMotion motion_;
  std::vector<double> contact_times_;  ///< counts by class of duration
  std::array<double, kScalars> now_{};
  std::vector<double> region_counts_;
  std::size_t frames_ = 0;
  double first_time_ = 0;
  double last_time_ = 0;
  double robots_ = 0;  ///< sum over frames
};

}  // namespace lab::collective
