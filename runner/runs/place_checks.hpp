/// Checks of the folders and devices that an experiment names, and that a run does not copy. They
/// open no device.
#pragma once

#include <filesystem>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// Checks the names of link.security and gateway.security, and the files of those that a run in
/// real time reads. A folder that does not exist, and files that this user may not read, are
/// accepted: certificates are secret, and a file may be checked, or run in virtual time, on a
/// machine without them.
/// @param source folder to which the paths are relative
/// @throws UserError that names the key
void checkCertificates(const Experiment& experiment, const std::filesystem::path& source);

/// Checks that this user can read the folders that the gateways of a run in real time will read.
/// @throws UserError that names the key
void requireCertificates(const Experiment& experiment, const std::filesystem::path& source);

/// Checks serial.ports and the sources of the cameras that services on this machine open. Absent
/// ones are accepted: a file may be checked on another machine than that of the lab.
/// @throws UserError that names the key
void checkDevices(const Experiment& experiment);

}  // namespace lab::runner
