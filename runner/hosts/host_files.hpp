/// What another host needs of a run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

struct HostFile {
  std::string path;              ///< in the run's folder there
  std::filesystem::path source;  ///< empty: `text`
  std::string text;
};

/// Files beside the experiment: images, calibrations, recordings, certificates.
/// @param directory of the run here
[[nodiscard]] std::vector<HostFile> filesFor(const Experiment& experiment,
                                             const std::filesystem::path& directory);

/// The experiment as another host is to know it: paths as filesFor() names them.
[[nodiscard]] Experiment experimentElsewhere(Experiment experiment);

/// Whether buses are joined by gateways, one on each host.
[[nodiscard]] bool joinsByGateways(const Experiment& experiment,
                                   const std::vector<std::string>& hosts);

}  // namespace lab::runner
