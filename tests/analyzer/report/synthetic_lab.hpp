/// A small lab in virtual time that writes its messages to a log. Its robots run the paper's
/// programs under uniform light and reverse at the walls. Tests can make it lose messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/service/node.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::report {

using support::readFile;

/// A program with its key in the experiment file.
struct NamedProgram {
  std::string name;
  Program program;
};

/// An experiment whose light changes every `step` s from one program to the next.
[[nodiscard]] Experiment syntheticExperiment(int robots, double duration, double fps,
                                             const std::vector<NamedProgram>& programs,
                                             double step);

/// The paper's figure 2: ABP with v = 3 cm/s, epsilon = 0.5 s, eta = 3 rad/s.
[[nodiscard]] NamedProgram paperAbp();
[[nodiscard]] NamedProgram paperBp();   ///< V = 7 cm/s, epsilon = 0.2 s
[[nodiscard]] NamedProgram paperRtp();  ///< v = 5 cm/s, gamma = 1 /s, tau_t = 0.5 s

class SyntheticRobot;

class SyntheticLab {
 public:
  /// @param keeps whether the logger receives a message; all by default.
  using Keeps = std::function<bool(const Packet&)>;

  SyntheticLab(const std::filesystem::path& log, Experiment experiment, Keeps keeps = {});
  ~SyntheticLab();

  /// Runs the whole experiment and ends every service cleanly.
  void run();

  /// The parts of run(), for tests that act during the run.
  void begin();
  void runUntil(double seconds);  ///< since the start
  void end();

  /// Restarts sim_svc as after a crash: without closing messages, with a new instance and new
  /// robots.
  void restartSimulation();

  Node& runner() { return *runner_; }
  void fault(const std::string& text);
  void mark(const std::string& text);
  /// Like `lab mark`: sends its request twice, then its final counts.
  void markByHand(const std::string& text);

 private:
  void tick();
  void showStep(std::size_t number);
  void publishLight(bool changed);
  void publishEvent(std::int8_t kind, const std::string& text);

  Experiment experiment_;
  VirtualLoop loop_;
  MemoryBus bus_;
  LogWriter writer_;
  std::vector<std::unique_ptr<Node>>
      killed_;  ///< kept, because their timers still run; their messages are ignored
  std::unique_ptr<Node> runner_;
  std::unique_ptr<Node> projector_;
  std::unique_ptr<Node> simulation_;
  std::vector<std::unique_ptr<SyntheticRobot>> robots_;
  std::int64_t frame_ = 0;
  std::size_t step_ = 0;
  std::int64_t step_utime_ = 0;
  bool lit_ = false;
};

}  // namespace lab::report
