/// The collective states of a whole lab, online and offline.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analyzer/collective/crowd_group.hpp"
#include "common/experiment/observable_names.hpp"

namespace lab::collective {

/// One robot in one camera frame, SI units.
struct CrowdPose {
  int robot = 0;
  double x = 0;
  double y = 0;
  double theta = units::kNan;  ///< [rad] any branch; nan: unknown
  int program = -1;            ///< key of the program it runs; -1: none
  int band = -1;               ///< index of the light band; -1: unknown
};

struct CrowdConfig {
  CrowdSettings settings;  ///< `period` is the wanted one; it becomes whole camera frames
  std::vector<Region> regions;
  std::vector<std::string> bands;  ///< names of the light bands
};

/// The last evaluated frame.
struct CrowdPicture {
  double time = 0;
  std::vector<CrowdRobot> robots;
  FrameObservation observation;
};

/// Takes camera frames in the order of time and gives the collective observables at any time, of
/// all robots and of the robots of each program. Robots of other programs do not count for those
/// of a program, not even as neighbours. The calls are the same online and offline.
///
/// Contacts, walls and changes of place are followed in every camera frame; everything else is
/// evaluated in five frames per second, because successive frames say nearly the same.
class CrowdAnalysis {
 public:
  static constexpr int kAll = -1;
  static constexpr std::size_t kMostRobots = kMostCrowdRobots;  ///< of a frame; others are not used
  static constexpr std::size_t kMostGroups = 16;  ///< programs beyond it are not analysed

  explicit CrowdAnalysis(const CrowdConfig& config);

  /// @param frame_period nominal [s]; 0: unknown
  void addFrame(double time, double frame_period, const std::vector<CrowdPose>& poses);

  /// All robots first, then the programs by key. Groups that never had two robots at a time are
  /// left out.
  [[nodiscard]] std::vector<CrowdResult> results() const;

  /// nullptr: there is no such group.
  [[nodiscard]] const CrowdGroup* group(int key) const;

  /// Poses that were not used: farther than a diameter outside of the arena, twice in a frame, or
  /// of robots beyond the limit.
  [[nodiscard]] std::size_t leftOut() const { return left_out_; }

  /// The most robots that a frame had, including those beyond the limit.
  [[nodiscard]] std::size_t mostRobots() const { return most_robots_; }

  /// The last evaluated frame; without robots if there was none.
  [[nodiscard]] const CrowdPicture& picture() const { return picture_; }

 private:
  struct Heading {
    double time = 0;
    double wrapped = 0;
    double continuous = 0;
  };
  struct Place {
    double time;
    double x;
    double y;
  };
  /// A group of the current frame.
  struct Members {
    CrowdGroup* group;
    std::vector<char> is_member;  ///< of each robot of the frame
    std::size_t count = 0;
  };

  void setPeriod(double frame_period);
  void forgetRobots(double time);
  void takePoses(double time, const std::vector<CrowdPose>& poses);
  void formGroups(const std::vector<CrowdPose>& poses);
  void addRates(double time, bool back, const std::vector<CrowdPose>& poses);
  void evaluate(double time);
  CrowdGroup& groupOf(int key);

  CrowdConfig config_;
  PlaceNames region_names_;
  PlaceNames band_names_;
  std::map<int, std::unique_ptr<CrowdGroup>> groups_;
  std::unique_ptr<ContactTracker> contacts_;
  std::unique_ptr<FrameObserver> observer_;
  PlaceTracker regions_;
  PlaceTracker bands_;
  std::map<int, Heading> headings_;   ///< of the robots that are known
  std::map<int, Place> evaluated_;    ///< positions in the last evaluated frame, by robot
  std::vector<CrowdRobot> robots_;    ///< of the current frame
  std::vector<std::size_t> sources_;  ///< their indices in the poses
  std::vector<Members> members_;
  CrowdPicture picture_;
  std::size_t left_out_ = 0;
  std::size_t most_robots_ = 0;
  double forgotten_time_ = units::kNan;  ///< when old robots were last forgotten
  double last_time_ = units::kNan;
  double next_evaluation_ = units::kNan;
};

}  // namespace lab::collective
