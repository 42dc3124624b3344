/// Which labs run on this machine, so that `lab stop`, `lab spy` and `lab light` find them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lab::runner {

struct RunningLab {
  std::string name;       ///< of the run's folder, with a number behind it when that is taken
  std::string url;        ///< of its bus
  int pid = 0;            ///< of its runner
  std::string directory;  ///< of the run
  bool replay = false;    ///< a log being played: no robot obeys
};

/// The folder of the registrations: $XDG_RUNTIME_DIR/active-lab, or one in /tmp that belongs to the
/// user alone.
[[nodiscard]] std::filesystem::path registryDirectory();

/// Every registered lab whose runner lives. What dead runners left is removed.
[[nodiscard]] std::vector<RunningLab> runningLabs();

/// The lab meant by `name`, which may be its run's folder too, or the only one that runs when
/// `name` is empty.
/// @throws UserError when there is none, or several, with what tells them apart.
[[nodiscard]] RunningLab findLab(const std::string& name);

/// Where a runner keeps something of its own while it lives: <pid><ending> in the registry, closed
/// to others. What dead runners left there is removed by runningLabs().
/// @param ending ".web"
/// @throws UserError when the folder cannot be made.
[[nodiscard]] std::filesystem::path registryFile(const std::string& ending);

/// An registryFile() that is gone with the object.
class RegistryFile {
 public:
  /// @throws UserError when the folder cannot be made.
  explicit RegistryFile(const std::string& ending) : path_(registryFile(ending)) {}
  ~RegistryFile();
  RegistryFile(const RegistryFile&) = delete;
  RegistryFile& operator=(const RegistryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A bus that belongs to one lab for as long as the object lives: two labs that start at the same
/// moment cannot hear each other yet.
class PortLock {
 public:
  /// @throws UserError when another lab of this user holds the port.
  explicit PortLock(int port);
  ~PortLock();
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// A registration that lasts as long as the object. No two labs that run have the same name, also
/// when they began in the same second, in folders of the same name.
class Registration {
 public:
  /// @throws UserError when the folder cannot be written.
  explicit Registration(const RunningLab& lab);
  ~Registration();
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// What the lab is called: `lab.name`, or with a number behind it.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::filesystem::path file_;
  std::string name_;
};

}  // namespace lab::runner
