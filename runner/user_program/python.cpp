#include "runner/user_program/python.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "common/process/installation.hpp"

extern char** environ;

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDebianPackages = "/usr/lib/python3/dist-packages";

/// Whether the package is there, with its compiled part.
bool hasPackage(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder / "active_lab", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("_core.") && name.ends_with(".so")) return true;
  }
  return false;
}

}  // namespace

std::string pythonProgram() {
  for (const char* environment : {"VIRTUAL_ENV", "CONDA_PREFIX"}) {
    if (std::getenv(environment) != nullptr) return "python3";
  }
  return access("/usr/bin/python3", X_OK) == 0 ? "/usr/bin/python3" : "python3";
}

fs::path pythonFolder() {
  const fs::path built = installation().programs.parent_path() / "python";
  if (!installation().packaged && hasPackage(built)) return built;
  if (hasPackage(kDebianPackages)) return kDebianPackages;
  return {};
}

std::string pythonHint() {
  return installation().packaged ? "sudo apt install ./python3-active-lab_*.deb"
                                 : "install pybind11-dev, python3-dev, python3-numpy and "
                                   "python3-pandas, then ./lab build";
}

std::vector<std::string> pythonEnvironment(std::vector<std::string> added) {
  if (const fs::path folder = pythonFolder(); !folder.empty() && folder != kDebianPackages) {
    const char* others = std::getenv("PYTHONPATH");
    added.push_back("PYTHONPATH=" + folder.string() +
                    (others == nullptr || *others == '\0' ? "" : ":" + std::string(others)));
  }
  std::vector<std::string> all = added;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::string name = text.substr(0, text.find('=') + 1);
    const bool replaced = std::ranges::any_of(
        added, [&](const std::string& other) { return other.starts_with(name); });
    if (!replaced) all.push_back(text);
  }
  return all;
}

}  // namespace lab::runner
