/// All child programs are started here.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <csignal>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// How a child process is started.
struct ChildSettings {
  static constexpr int kNothing = -1;    ///< as a stream: /dev/null
  static constexpr int kInherited = -2;  ///< as a stream: that of this process

  enum class Group {
    kShared,  ///< signals of the terminal reach it; it keeps the signals that this process ignores
    kSeparate,  ///< signals of the terminal do not reach it
    kSession    ///< as kSeparate, and without the terminal
  };

  /// The program first: a path, or a name that is looked up in PATH.
  std::vector<std::string> arguments{};
  /// "NAME=value"; nullopt: the environment of this process.
  std::optional<std::vector<std::string>> environment{};
  std::string folder{};   ///< its working directory; empty: that of this process
  int input = kNothing;   ///< descriptor for its standard input, not owned
  int output = kNothing;  ///< for its standard output
  int errors = kNothing;  ///< for its standard error
  /// Further descriptors: the number here, the number there. It inherits no others, so no socket of
  /// this process stays open in a child.
  std::vector<std::pair<int, int>> handed_on{};
  Group group = Group::kSeparate;
  /// The kernel sends it this signal when the thread that started it ends. 0: the child may outlive
  /// this process, and the destructor leaves it alone.
  int death_signal = SIGKILL;
  /// Signals that it ignores until it decides otherwise.
  std::vector<int> ignored_signals{};
};

/// A program that was started, until its end.
class ChildProcess {
 public:
  /// Returns once the program runs.
  /// @throws std::system_error "cannot start PROGRAM", with the code of exec (ENOENT: not there)
  explicit ChildProcess(const ChildSettings& settings);

  /// Kills it and waits, unless death_signal is 0.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }

  [[nodiscard]] bool running();

  /// Waits for its end. @return whether it has ended
  bool waitFor(std::chrono::milliseconds timeout);
  void wait();

  /// Sends a signal, from any thread. Does nothing after its end: the pid may be another's then.
  void signal(int number);

  /// Sends a signal to its process group; not for Group::kShared.
  void signalGroup(int number);

  /// Its exit code, or 128 + signal number; -1: it runs, or its end is not known.
  [[nodiscard]] int code() const;

  /// The signal that ended it, 0: none.
  [[nodiscard]] int endingSignal() const;

  /// "killed by signal 9", "exit code 1", "lost"; empty while it runs.
  [[nodiscard]] std::string ending() const;

 private:
  void send(pid_t receiver, int number);

  pid_t pid_ = -1;
  bool may_outlive_;
  FileDescriptor ended_;      ///< a pidfd: readable once it has ended
  mutable std::mutex mutex_;  ///< guards the members below; a signal never meets a pid in reuse
  bool reaped_ = false;
  std::optional<int> status_;  ///< as waitpid() gives it
};

}  // namespace lab
