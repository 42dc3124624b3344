// What a tracker has to reach in pictures of one kind, and whether it did.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace lab::cases {

// Where nothing is stated, nothing is asked.
struct AcceptanceLimits {
  double recall = 0;  // [1] of the robots, at least; with their heading the right way round
  double wrong = std::numeric_limits<double>::infinity();     // poses a picture, at most
  double position = std::numeric_limits<double>::infinity();  // [px] root mean square, 2-D
  double heading = std::numeric_limits<double>::infinity();   // [degrees] root mean square
  bool honest = false;      // the mean error squared is what the covariance says
  double recall_known = 2;  // [1] where `recall` is not reached yet: less than this is a failure,
                            // what is between is said
};

// What was found in some pictures.
struct Tally {
  int frames = 0;
  int robots = 0;       // that count
  int found = 0;        // of them
  int flipped = 0;      // of those, with the heading the wrong way round
  int wrong = 0;        // poses where there is no robot
  double position = 0;  // [px] root mean square of those not flipped, 2-D
  double heading = 0;   // [degrees] root mean square of the same
  double surprise = 0;  // [1] mean error squared over the covariance, 1 if that is right
  int surprises = 0;    // poses it is a mean of
};

// How far `surprise` may be from 1: a tenth, and three standard errors of a mean square.
double allowedNees(const Tally& tally);

// The probability of `count` or more where `expected` are expected of things that are rare and
// happen one by one (Poisson).
double chanceOf(int count, double expected);

// A bar that was not reached.
struct Shortfall {
  std::string what;    // one sentence
  bool known = false;  // and no failure
};

// Which bars were not reached.
//
// A share of robots, and a number of wrong poses, are counts of rare things: a tracker that is
// exactly as good as its bar has more of them in half of all runs. A run fails where less than one
// in a hundred runs of such a tracker has as many. A bar of 100 %, or of no wrong pose, has no such
// room.
std::vector<Shortfall> shortOf(const AcceptanceLimits& bars, const Tally& tally);

}  // namespace lab::cases
