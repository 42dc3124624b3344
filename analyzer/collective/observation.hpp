/// What one frame says about many robots. docs/collective.md has the formulas.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "analyzer/collective/pairs.hpp"
#include "analyzer/collective/rectangle.hpp"
#include "analyzer/collective/voronoi_cells.hpp"
#include "common/math/units.hpp"

namespace lab::collective {

/// One robot of a frame; SI units.
struct CrowdRobot {
  int id = 0;
  double x = 0;
  double y = 0;
  double theta = units::kNan;       ///< [rad] nan: unknown
  double velocity_x = units::kNan;  ///< [m/s] nan: unknown
  double velocity_y = units::kNan;
};

struct CrowdSettings {
  Rectangle arena;
  double diameter = 0.075;      ///< [m] of a robot
  double cluster_distance = 0;  ///< [m] between centres; 0: 1.1 diameters
  double period = 0.2;          ///< [s] between the frames that are evaluated
  double max_lag = 100;         ///< [s] of the mean square displacements

  [[nodiscard]] double clusterDistance() const {
    return cluster_distance > 0 ? cluster_distance : 1.1 * diameter;
  }
  /// Where centres can be.
  [[nodiscard]] Rectangle centres() const { return arena.shrunk(0.5 * diameter); }
};

/// Numbers of one frame. nan: not defined.
enum Scalar : std::size_t {
  kPolar,           ///< |mean of exp(i theta)|
  kNematic,         ///< |mean of exp(2 i theta)|
  kHexatic,         ///< mean of |psi_6|, of robots whose cell touches no wall
  kHexaticGlobal,   ///< |mean of psi_6|, of the same robots
  kLargestCluster,  ///< robots in the largest cluster
  kMeanCluster,     ///< mean size of the cluster of a robot
  kClusters,        ///< clusters of two robots or more
  kClustered,       ///< share of robots in them
  kDensityMean,     ///< mean local packing fraction of the robots
  kDensityScatter,  ///< its standard deviation over the robots
  kSpeed,           ///< mean speed [m/s]
  kSquareSpeed,     ///< mean of the squared speed [m^2/s^2]
  kScalars
};

/// Name and unit of a number, as in messages and files.
struct ScalarName {
  std::string_view name;
  std::string_view unit;
};
[[nodiscard]] ScalarName nameOf(Scalar scalar);

struct FrameObservation {
  std::array<double, kScalars> values{};
  std::vector<double> densities;   ///< local packing fraction of each robot; nan: unknown
  std::vector<double> hexatics;    ///< |psi_6| of each robot; nan: its cell touches a wall
  std::vector<int> clusters;       ///< of each robot; 0: alone, else from 1, the largest first
  std::vector<int> cluster_sizes;  ///< of the cluster of each robot
};

/// Evaluates frames; keeps its memory.
class FrameObserver {
 public:
  explicit FrameObserver(const CrowdSettings& settings) : settings_(settings) {}

  /// @return valid until the next call
  const FrameObservation& observe(const std::vector<CrowdRobot>& robots);

 private:
  void order(const std::vector<CrowdRobot>& robots);
  void cells();
  void cluster();

  CrowdSettings settings_;
  FrameObservation result_;
  std::vector<Point> points_;
  std::vector<std::size_t> order_;
  Clusters clusters_;
};

}  // namespace lab::collective
