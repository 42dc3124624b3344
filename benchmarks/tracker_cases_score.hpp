// What a tracker's poses are worth against truth.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tracker_svc/detector.hpp"

namespace lab::cases {

struct TrueRobot {
  double x = 0;      // [m]
  double y = 0;      // [m]
  double theta = 0;  // [rad]
  bool counts = true;  // both circles in view and not washed out by glare
};

// Frame by frame, from truth.csv.
std::map<int, std::vector<TrueRobot>> readTruth(const std::filesystem::path& file);

// Adds up over frames.
class Score {
 public:
  // Poses without covariance count for everything but the surprise.
  void add(const std::vector<TrueRobot>& truth, const std::vector<tracker::Detection>& poses,
           const optics::CameraModel& camera, double height, double seconds);

  [[nodiscard]] std::string text() const;       // one line of the table
  [[nodiscard]] static std::string header();

 private:
  int frames_ = 0;
  int robots_ = 0;
  int found_ = 0;
  int wrong_ = 0;
  int flipped_ = 0;
  double position_ = 0;  // [px^2]
  double heading_ = 0;   // [rad^2]
  double surprise_ = 0;
  int surprises_ = 0;
  double fastest_ = 0;  // [s] summed over frames
};

}  // namespace lab::cases
