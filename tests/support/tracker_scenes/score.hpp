// What a tracker's poses are worth against truth.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/tracker_scenes/acceptance_limits.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::cases {

struct TrueRobot {
  double x = 0;        // [m]
  double y = 0;        // [m]
  double theta = 0;    // [rad]
  bool counts = true;  // both circles in view and not washed out by glare
};

// Frame by frame, from truth.csv.
std::map<int, std::vector<TrueRobot>> readTruth(const std::filesystem::path& file);

// What a frame's poses and robots have left over, by their place in the lists.
struct Unmatched {
  std::vector<std::size_t> missed;  // robots that count
  std::vector<std::size_t> wrong;   // poses
};

// Adds up over frames.
class Score {
 public:
  // Poses without covariance count for everything but the surprise.
  Unmatched add(const std::vector<TrueRobot>& truth, const std::vector<detector::Detection>& poses,
                const optics::CameraModel& camera, double height, double seconds);

  [[nodiscard]] Tally tally() const;

  // Whether the mean normalised error squared, for each degree of freedom, is off by more than a
  // tenth of what it should be and three of its standard errors.
  [[nodiscard]] bool isSurprising() const;

  [[nodiscard]] std::string text() const;  // one line of the table
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
