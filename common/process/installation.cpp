#include "common/process/installation.hpp"

#include "common/process/version.hpp"

namespace lab {
namespace fs = std::filesystem;

/// The package that contains a file, as in cmake/Packaging.cmake.
static std::string packageOf(const std::string& name) {
  if (name == "dds_gateway") return "active-lab-gateway";
  if (name == "robot_emulator" || name == "robot_firmware.elf") return "active-lab-emulator";
  return "active-lab";
}

std::string Installation::installHint(const std::string& name, const std::string& build) const {
  if (!packaged) return build;
  const std::string package = packageOf(name);
  return "sudo apt install ./" + package + "_" + kVersion + "_*.deb";
}

Installation installationOf(const fs::path& program) {
  Installation found;
  found.programs = program.parent_path();
  const fs::path above = found.programs.parent_path();
  found.packaged = found.programs.filename() == "bin" && above.filename() == "active-lab" &&
                   above.parent_path().filename() == "lib";
  found.command = found.packaged ? "active-lab" : "./lab";
  const fs::path root = above.parent_path().parent_path();
  found.experiments =
      found.packaged ? root / "share" / "active-lab" / "experiments" : root / "experiments";
  return found;
}

const Installation& installation() {
  static const Installation found = installationOf(fs::canonical("/proc/self/exe"));
  return found;
}

}  // namespace lab
