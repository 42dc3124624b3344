/// Results as plain data.
#pragma once

#include <string>
#include <vector>

#include "analyzer/collective/time_average.hpp"

namespace lab::collective {

/// A number over time, SI units.
struct Observable {
  std::string name;
  std::string unit;
  double now = units::kNan;      ///< in the last frame; nan: has no value in one frame
  double scatter = units::kNan;  ///< standard deviation over the frames
  Average average;
};

/// One point of a curve.
struct CurveSample {
  double x = 0;
  Average average;
  double weight = 0;  ///< what entered: pairs, robots, boxes or windows
};

struct ObservableCurve {
  std::string name;
  std::string x_name;
  std::string x_unit;
  std::string unit;
  std::vector<CurveSample> points;
};

}  // namespace lab::collective
