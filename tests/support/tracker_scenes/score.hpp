// Compares the poses of a tracker with the ground truth.
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
  bool counts = true;  // both circles visible and with contrast
};

// The true robots of every frame, from truth.csv.
std::map<int, std::vector<TrueRobot>> readTruth(const std::filesystem::path& file);

// Indices of robots and poses of a frame without a partner.
struct Unmatched {
  std::vector<std::size_t> missed;  // robots that count
  std::vector<std::size_t> wrong;   // poses
};

// Accumulates the results over frames.
class Score {
 public:
  // Poses without covariance do not count for the NEES.
  Unmatched add(const std::vector<TrueRobot>& truth, const std::vector<detector::Detection>& poses,
                const optics::CameraModel& camera, double height, double seconds);

  [[nodiscard]] Tally tally() const;

  // Whether the NEES deviates from 1 by more than allowedNees().
  [[nodiscard]] bool isInconsistent() const;

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
  double nees_ = 0;
  int nees_count_ = 0;
  double fastest_ = 0;  // [s] summed over frames
};

}  // namespace lab::cases
