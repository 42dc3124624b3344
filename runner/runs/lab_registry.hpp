/// Registers the labs that run on this machine, so that `lab stop`, `lab spy` and `lab light` find
/// them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/process/running_labs.hpp"

namespace lab::runner {

/// The folder of the registry, which is made if it is not there. Another user may have made it in
/// /tmp first, so its owner is checked.
/// @throws UserError if it cannot be made, or is not of this user
[[nodiscard]] std::filesystem::path ownRegistry();

/// The lab of that name or run folder; if `name` is empty, the only running one.
/// @throws UserError when there is none, or several, with their names
[[nodiscard]] RunningLab findLab(const std::string& name);

/// Path of a private file of this runner: <pid><ending> in the registry. runningLabs() removes
/// those of dead runners.
/// @param ending as ".web"
/// @throws UserError when the folder cannot be made
[[nodiscard]] std::filesystem::path registryFile(const std::string& ending);

/// A registryFile() that is removed with the object.
class RegistryFile {
 public:
  /// @throws UserError when the folder cannot be made
  explicit RegistryFile(const std::string& ending) : path_(registryFile(ending)) {}
  ~RegistryFile();
  RegistryFile(const RegistryFile&) = delete;
  RegistryFile& operator=(const RegistryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Reserves the port of a bus while the object lives. Needed because two labs that start at the
/// same moment do not notice each other on the bus.
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

/// Registers a lab while the object lives. Names of running labs are unique, also when labs start
/// in the same second in folders of the same name.
class Registration {
 public:
  /// @throws UserError when the folder cannot be written.
  explicit Registration(const RunningLab& lab);
  ~Registration();
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// `lab.name` as printable(), with a number appended if it was taken.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::filesystem::path file_;
  std::string name_;
};

}  // namespace lab::runner
