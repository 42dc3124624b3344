/// Joins the DDS domain of ROS 2, as configured by the experiment's [gateway].
#pragma once

#include <filesystem>

#include "common/experiment/experiment.hpp"
#include "dds_gateway/dds/domain.hpp"

namespace lab::gateway {

/// @param directory folder of the experiment file; its file names are relative to it
/// @throws ExperimentError that names the faulty key
[[nodiscard]] dds::Domain joinDomain(const Gateway& gateway,
                                     const std::filesystem::path& directory);

}  // namespace lab::gateway
