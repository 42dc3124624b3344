/// Collective states as JSON for the page.
#pragma once

#include <cstdint>
#include <lab/collective_t.hpp>
#include <map>
#include <string>
#include <vector>

namespace lab::dashboard {

/// Keeps the newest COLLECTIVE of all robots and of each program, and polar order and largest
/// cluster over time: a point every 2 s; at 600 points every second one is dropped and the time
/// between points doubles.
class CrowdView {
 public:
  static constexpr std::size_t kMaxPoints = 600;
  static constexpr std::size_t kMaxPrograms = 64;
  static constexpr std::int64_t kStep_us = 2'000'000;

  /// @param start of the run [us since 1970]; if 0 (unknown), time counts from the first point
  void take(const collective_t& message, std::int64_t start);
  void clear() { groups_.clear(); }

  /// Programs that have changed since the previous call; "" stands for all robots.
  [[nodiscard]] std::vector<std::string> takeChanged();

  /// JSON of topic `crowd` or `crowd/PROGRAM`; empty if there is none. Lengths are in cm.
  [[nodiscard]] std::string json(const std::string& program) const;

 private:
  /// A number over time.
  struct Line {
    std::vector<double> now;
    std::vector<double> low;  ///< of the average up to that time
    std::vector<double> high;
  };
  struct Group {
    collective_t message;
    std::int64_t begin_utime = 0;
    std::int64_t step_us = kStep_us;
    std::int64_t next_utime = 0;
    std::vector<double> times;          ///< [s]
    std::map<std::string, Line> lines;  ///< by name
    bool changed = false;
  };

  static void addPoint(Group& group);

  std::map<std::string, Group> groups_;
};

}  // namespace lab::dashboard
