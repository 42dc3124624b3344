#include "runner/runs/lab_registry.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/files/atomic_file.hpp"
#include "common/files/own_folder.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

std::string listed(const std::vector<RunningLab>& labs, std::string RunningLab::*what) {
  std::string all;
  for (const RunningLab& lab : labs) all += (all.empty() ? "" : ", ") + lab.*what;
  return all;
}

bool isFolder(const std::string& path, const RunningLab& lab) {
  std::error_code error;
  return !lab.directory.empty() && fs::equivalent(path, lab.directory, error) && !error;
}

/// `name`, with a number appended if a running lab has it.
std::string freeName(const std::string& name, int own_pid) {
  std::vector<RunningLab> others = runningLabs();
  // A file with this pid was left by an earlier process.
  std::erase_if(others, [&](const RunningLab& lab) { return lab.pid == own_pid; });
  for (int number = 1;; ++number) {
    const std::string chosen = number == 1 ? name : name + "-" + std::to_string(number);
    if (std::ranges::find(others, chosen, &RunningLab::name) == others.end()) return chosen;
  }
}

/// Held while a name is chosen and written, so that labs that register at once get different names.
class NamesLock {
 public:
  NamesLock() {
    const fs::path file = registryDirectory() / "names.lock";
    descriptor_ = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
      if (descriptor_ >= 0) close(descriptor_);
      throw UserError("cannot write " + file.string());
    }
  }
  ~NamesLock() { close(descriptor_); }
  NamesLock(const NamesLock&) = delete;
  NamesLock& operator=(const NamesLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace

fs::path ownRegistry() {
  const fs::path folder = registryDirectory();
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw UserError("cannot make " + folder.string() +
                    ": set XDG_RUNTIME_DIR to a folder of yours");
  }
  if (!isOwnFolder(folder)) {
    throw UserError(folder.string() +
                    " belongs to somebody else: set XDG_RUNTIME_DIR to a folder of yours");
  }
  return folder;
}

RunningLab findLab(const std::string& name) {
  const std::vector<RunningLab> labs = runningLabs();
  if (labs.empty()) throw UserError("no lab runs on this machine: start one with lab run FILE");
  std::vector<RunningLab> meant;
  for (const RunningLab& lab : labs) {
    if (name.empty() || lab.name == name || isFolder(name, lab)) meant.push_back(lab);
  }
  if (meant.size() == 1) return meant.front();
  if (meant.empty()) {
    throw UserError("no lab named " + name + " runs; these do: " + listed(labs, &RunningLab::name));
  }
  if (name.empty()) {
    throw UserError("several labs run; say which with --lab NAME: " +
                    listed(meant, &RunningLab::name));
  }
  throw UserError("several labs are named " + name +
                  "; say which with --lab FOLDER: " + listed(meant, &RunningLab::directory));
}

fs::path registryFile(const std::string& ending) {
  return ownRegistry() / (std::to_string(getpid()) + ending);
}

RegistryFile::~RegistryFile() {
  std::error_code error;
  fs::remove(path_, error);
}

PortLock::PortLock(int port) {
  const fs::path file = ownRegistry() / ("port-" + std::to_string(port) + ".lock");
  descriptor_ = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ < 0) throw UserError("cannot write " + file.string());
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  close(descriptor_);
  throw UserError("another lab of yours is on port " + std::to_string(port) +
                  " (network.port): stop it, or set another port, or 0 for a free one");
}

PortLock::~PortLock() { close(descriptor_); }

Registration::Registration(const RunningLab& lab)
    : file_(ownRegistry() / (std::to_string(lab.pid) + ".json")) {
  const NamesLock lock;
  name_ = freeName(printable(lab.name), lab.pid);
  const nlohmann::json json{{"name", name_},
                            {"url", lab.url},
                            {"pid", lab.pid},
                            {"directory", lab.directory},
                            {"replay", lab.replay}};
  // The name of a folder may have bytes that are no text.
  const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  try {
    replaceFile(file_, text + "\n");
  } catch (const std::runtime_error& error) {
    throw UserError(error.what());
  }
}

Registration::~Registration() {
  std::error_code error;
  fs::remove(file_, error);
}

}  // namespace lab::runner
