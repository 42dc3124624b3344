/// What the doctor says of DDS: who is in a domain, and who does not hear whom.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/doctor/doctor.hpp"

namespace lab::runner {

struct DdsEndpoint {
  bool writer = false;
  std::string topic;  ///< DDS's name: "rt/lab/robot1/pose"
  std::string type;
  bool reliable = false;
  bool latched = false;    ///< late joiners get the last ones
  std::string owner = {};  ///< key of its participant
};

struct DdsFacts {
  int domain = 0;
  bool secured = false;  ///< who has no certificate of the lab's is not seen
  std::string problem;   ///< why nothing can be said; empty: all is well
  int participants = 0;  ///< without the doctor's own
  std::vector<DdsEndpoint> endpoints;
};

/// Listens this long in the gateway's domain, as the gateway does. Nobody writes or reads for it.
/// @param directory of the experiment file
[[nodiscard]] DdsFacts surveyDds(const Gateway& gateway, const std::filesystem::path& directory,
                                 int listen_ms);

/// Writers and readers of one topic that DDS does not join, and why; it says nothing itself. A
/// reader of another type is none of these where its owner also reads the writer's type.
[[nodiscard]] std::vector<Finding> judgeDds(const DdsFacts& facts);

/// UDP ports that the experiment names and others hold; nothing where all are free.
[[nodiscard]] std::vector<Finding> judgePorts(const Experiment& experiment,
                                              const std::function<bool(int port)>& lcm_free,
                                              const std::function<bool(int port)>& dds_free);

}  // namespace lab::runner
