/// The DDS domain in which the lab meets ROS 2, as the experiment's [gateway] says.
#pragma once

#include <filesystem>

#include "common/experiment/experiment.hpp"
#include "dds_gateway/dds/domain.hpp"

namespace lab::gateway {

/// @param directory of the experiment file: files it names are relative to it
/// @throws ExperimentError naming the key that is at fault
[[nodiscard]] dds::Domain joinDomain(const Gateway& gateway,
                                     const std::filesystem::path& directory);

}  // namespace lab::gateway
