/// The labs that run on this machine. Each runner registers its lab in a file
/// (runner/runs/lab_registry.hpp); anybody of the same user may list them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lab {

struct RunningLab {
  std::string name;       ///< of the run's folder, as Registration::name()
  std::string url;        ///< of its bus
  int pid = 0;            ///< of its runner
  std::string directory;  ///< of the run
  bool replay = false;    ///< a replay of a log: there are no robots
};

/// The folder of the registrations: $XDG_RUNTIME_DIR/active-lab, or one in /tmp that only
/// the user can access.
[[nodiscard]] std::filesystem::path registryDirectory();

/// Whether a process has this id.
[[nodiscard]] bool processLives(int pid);

/// Every registered lab whose runner lives. Removes the files of dead runners, also those that
/// cannot be read. None if the folder belongs to another user, who could name any bus.
[[nodiscard]] std::vector<RunningLab> runningLabs();

/// The ending of the file, beside the registration, with the address of a lab's page.
inline constexpr const char* kPageFile = ".web";

/// The address of the lab's page with its token; empty: it has none, or the folder belongs to
/// another user.
[[nodiscard]] std::string pageOf(const RunningLab& lab);

}  // namespace lab
