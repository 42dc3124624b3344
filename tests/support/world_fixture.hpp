/// Programs, hardware and light for tests of the simulated world.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim_svc/world.hpp"
#include "tests/support/programs.hpp"

namespace lab::sim {

inline constexpr std::int64_t kSecond = 1000000;  // [us]

inline Program abpProgram(double v = 0.03, double epsilon = 0.5, double eta = 3) {
  return test::abp(v, epsilon, eta);
}

inline Program rtpProgram(double v, double gamma, double tau_t) {
  return test::rtp(v, gamma, tau_t);
}

inline Program bpProgram(double va, double V, double epsilon) {
  return test::noisyAbp(va, V, epsilon);
}

inline Program wheelsProgram(double left, double right) { return test::wheels(left, right); }

/// The programs of always(), which startAll() makes known to the world.
inline std::vector<Program>& programsInUse() {
  static std::vector<Program> programs;
  return programs;
}

/// Settings that run one program for any light.
inline dynamics::CoreSettings always(const Program& program) {
  programsInUse().push_back(program);
  dynamics::CoreSettings settings;
  settings.light.count = 1;
  settings.light.bands[0] = {0, 1024, 0};
  settings.programs[0] = program.hash;
  return settings;
}

/// Hardware without errors: ideal wheels, exact clocks, immediate boot.
inline WorldSettings idealHardware() {
  WorldSettings settings;
  settings.pwm_steps = false;
  settings.clock_error = 0;
  settings.boot_spread = 0;
  return settings;
}

inline std::vector<RobotSetup> robots(int n) {
  std::vector<RobotSetup> setups;
  for (int id = 1; id <= n; ++id) setups.push_back({id, std::nullopt, false});
  return setups;
}

inline std::vector<RobotSetup> robotAt(double x, double y, double theta) {
  return {{1, dynamics::Pose{x, y, theta}, false}};
}

/// Makes the programs of always() known to the world.
inline void addPrograms(World& world) {
  for (const Program& program : programsInUse()) world.addProgram(program.hash, program.code);
}

inline void startAll(World& world, const dynamics::CoreSettings& settings) {
  addPrograms(world);
  for (std::size_t i = 0; i < world.size(); ++i) {
    world.order(i, [&](dynamics::RobotCore& core, std::uint32_t now_ms) {
      core.configure(now_ms, settings);
      core.renewLease(now_ms, dynamics::RobotCore::kNoEventMs);
    });
  }
}

inline bool has(const RobotState& state, dynamics::CoreFlag flag) {
  return (state.core.flags & flag) != 0;
}

/// Light with a step at the line x = edge.
class StepLight : public LightSampler {
 public:
  StepLight(double edge, double left, double right) : edge_(edge), left_(left), right_(right) {}
  [[nodiscard]] double at(double x, double) const override { return x < edge_ ? left_ : right_; }

 private:
  double edge_, left_, right_;
};

}  // namespace lab::sim
