/// DDS checks of `lab doctor`: participants of a domain, and incompatible writers and readers.
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
  std::string topic;  ///< DDS topic name, as "rt/lab/robot1/pose"
  std::string type;
  bool reliable = false;
  bool latched = false;    ///< durability other than volatile: late readers get the last samples
  std::string owner = {};  ///< key of the participant
};

struct DdsFacts {
  int domain = 0;
  bool secured =
      false;  ///< with DDS Security: participants without a certificate of the lab are not visible
  std::string problem;   ///< why the survey failed; empty if it did not
  int participants = 0;  ///< without this program
  std::vector<DdsEndpoint> endpoints;
};

/// Discovers the participants of the gateway's domain for `listen_ms`, with the gateway's DDS
/// configuration. Creates no writers or readers of user topics.
/// @param directory folder of the experiment file
[[nodiscard]] DdsFacts surveyDds(const Gateway& gateway, const std::filesystem::path& directory,
                                 int listen_ms);

/// Reports writers and readers of the same topic with incompatible type or QoS: DDS itself reports
/// nothing to the user. A different type is not reported if the participant of the reader also
/// reads the type of the writer.
[[nodiscard]] std::vector<Finding> judgeDds(const DdsFacts& facts);

/// Warns about UDP ports that the experiment uses and that other programs occupy.
[[nodiscard]] std::vector<Finding> judgePorts(const Experiment& experiment,
                                              const std::function<bool(int port)>& lcm_free,
                                              const std::function<bool(int port)>& dds_free);

}  // namespace lab::runner
