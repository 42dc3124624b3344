/// Whether the running program was installed from a package or built from a clone. This decides
/// where the shipped experiments are, which command users type, and how missing parts are
/// installed.
#pragma once

#include <filesystem>
#include <string>

namespace lab {

struct Installation {
  bool packaged = false;
  std::string command;                ///< what users type: "active-lab", "./lab"
  std::filesystem::path programs;     ///< folder of the services' programs
  std::filesystem::path experiments;  ///< folder of the shipped experiments; may not exist
  std::filesystem::path clone;        ///< folder of the clone; empty for a package
  bool may_build = true;              ///< whether this user may write the build folder of the clone

  /// How to get a missing file of this software.
  /// @param name "dds_gateway", "robot_firmware.hex"
  /// @param build the hint for a clone that this user may build
  [[nodiscard]] std::string installHint(const std::string& name, const std::string& build) const;
};

/// Decides by the path of a program alone: a package installs it into PREFIX/lib/active-lab/bin,
/// and any other path is taken as ROOT/build/PRESET/bin of a clone that may be built.
[[nodiscard]] Installation installationOf(const std::filesystem::path& program);

/// The installation of the running program.
[[nodiscard]] const Installation& installation();

}  // namespace lab
