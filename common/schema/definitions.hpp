/// The texts of lcmtypes/*.lcm, embedded by the build (CMakeLists.txt).
#pragma once

#include <string>
#include <vector>

namespace lab::schema {

[[nodiscard]] const std::vector<std::string>& definitionTexts();

}  // namespace lab::schema
