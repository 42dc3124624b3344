/// What the doctor says of DDS: who is in a domain, and who does not hear whom.
#pragma once

#include <string>
#include <vector>

#include "runner/doctor.hpp"

namespace lab::runner {

struct DdsEndpoint {
  bool writer = false;
  std::string topic;  ///< DDS's name: "rt/lab/robot1/pose"
  std::string type;
  bool reliable = false;
  bool latched = false;  ///< late joiners get the last ones
};

struct DdsFacts {
  int domain = 0;
  std::string problem;   ///< why nothing can be said; empty: all is well
  int participants = 0;  ///< without the doctor's own
  std::vector<DdsEndpoint> endpoints;
};

/// Listens in the domain for this long. @param address of the interface to use, "": this machine
[[nodiscard]] DdsFacts surveyDds(int domain, const std::string& address, int listen_ms);

/// Writers and readers of one topic that DDS does not join, and why; it says nothing itself.
[[nodiscard]] std::vector<Finding> judgeDds(const DdsFacts& facts);

}  // namespace lab::runner
