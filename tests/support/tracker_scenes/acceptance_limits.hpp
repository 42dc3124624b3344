// Limits that a tracker must meet in pictures of one kind, and the comparison with its results.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace lab::cases {

// The defaults allow everything.
struct AcceptanceLimits {
  double recall = 0;  // [1] least share of robots found, with a heading error below 90 degrees
  double wrong = std::numeric_limits<double>::infinity();     // most wrong poses per picture
  double position = std::numeric_limits<double>::infinity();  // [px] largest root mean square, 2-D
  double heading = std::numeric_limits<double>::infinity();   // [degrees] largest root mean square
  bool honest = false;      // the covariance must match the errors (NEES of 1)
  double recall_known = 2;  // [1] if `recall` is not reached yet: below this is a failure, between
                            // the two a known shortfall
};

// Results in a set of pictures.
struct Tally {
  int frames = 0;
  int robots = 0;       // robots that count
  int found = 0;        // of these, found
  int flipped = 0;      // of these, with a heading error above 90 degrees
  int wrong = 0;        // poses where there is no robot
  double position = 0;  // [px] root mean square without flipped ones, 2-D
  double heading = 0;   // [degrees] root mean square of the same poses
  double nees = 0;      // [1] normalised estimation error squared per degree of freedom; 1 is ideal
  int nees_count = 0;   // number of poses in that mean
};

// Allowed deviation of `nees` from 1: 0.1 plus three standard errors of the mean.
double allowedNees(const Tally& tally);

// Poisson probability of `count` or more events if `expected` are expected.
double chanceOf(int count, double expected);

// A limit that was not met.
struct Shortfall {
  std::string what;    // one sentence
  bool known = false;  // not a failure
};

// The limits that were not met.
//
// Missed robots and wrong poses are counts of rare events: a tracker exactly at its limit exceeds
// it in half of all runs. A run fails if such a tracker would have as many in less than 1 % of
// runs. A limit of 100 %, or of no wrong pose, has no such tolerance.
std::vector<Shortfall> shortOf(const AcceptanceLimits& limits, const Tally& tally);

}  // namespace lab::cases
