#include "common/process/installation.hpp"

#include <unistd.h>

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
  if (!packaged && !may_build) {
    return "you may not write in " + clone.string() +
           ": ask its owner to run ./lab build there, or make a clone of your own";
  }
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
  const fs::path texts = found.packaged ? root / "share" / "active-lab" : root;
  found.experiments = texts / "experiments";
  if (!found.packaged) found.clone = root;
  return found;
}

const Installation& installation() {
  static const Installation found = [] {
    Installation here = installationOf(fs::canonical("/proc/self/exe"));
    if (!here.packaged) here.may_build = access(here.programs.parent_path().c_str(), W_OK) == 0;
    return here;
  }();
  return found;
}

}  // namespace lab
