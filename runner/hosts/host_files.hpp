/// The files of a run that its other hosts need.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// Where filesFor() puts gateway.configuration, relative to the folder of the run on that host.
inline constexpr const char* kDdsConfigurationElsewhere = "gateway/configuration";

struct HostFile {
  std::string path;              ///< relative to the folder of the run on that host
  std::filesystem::path source;  ///< if empty, `text` is the content
  std::string text;
};

/// The files that the experiment names: images, calibrations, recordings, certificates.
/// @param directory folder of the run on this host
[[nodiscard]] std::vector<HostFile> filesFor(const Experiment& experiment,
                                             const std::filesystem::path& directory);

/// The experiment for another host, with the paths that filesFor() assigns.
[[nodiscard]] Experiment experimentElsewhere(Experiment experiment);

/// Whether the LCM buses of the hosts are joined by a dds_gateway on each host.
[[nodiscard]] bool joinsByGateways(const Experiment& experiment,
                                   const std::vector<std::string>& hosts);

}  // namespace lab::runner
