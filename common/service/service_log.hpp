/// The log of a service, on its standard error.
#pragma once

#include <string>

namespace lab {

/// Makes the default logger of spdlog. What is logged may contain texts of files and of other
/// hosts, so it is written as printableLines().
/// @param name of the service, in each entry
void startLog(const std::string& name);

}  // namespace lab
