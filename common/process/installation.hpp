/// How the running program came onto this machine: from a package or from a build. It decides where
/// shipped experiments lie, what its user types to call the lab, and how what is missing is had.
#pragma once

#include <filesystem>
#include <string>

namespace lab {

struct Installation {
  bool packaged = false;
  std::string command;                ///< as users type it: "active-lab", "./lab"
  std::filesystem::path programs;     ///< folder of the services' programs
  std::filesystem::path experiments;  ///< folder of the shipped experiment files; may not exist

  /// What brings a file of the lab that is not there: its package, or what `build` says.
  /// @param name "dds_gateway", "robot_firmware.hex"
  [[nodiscard]] std::string installHint(const std::string& name, const std::string& build) const;
};

/// By the path of a program alone: packages put it into PREFIX/lib/active-lab/bin, everything else
/// is taken as ROOT/build/PRESET/bin of a clone.
[[nodiscard]] Installation installationOf(const std::filesystem::path& program);

/// Of the running program.
[[nodiscard]] const Installation& installation();

}  // namespace lab
