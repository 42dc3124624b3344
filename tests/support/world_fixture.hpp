/// Programs, hardware and light for tests of the simulated world.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot/dynamics/robot_program.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

inline constexpr std::int64_t kSecond = 1000000;  // [us]

inline dynamics::ProgramParams abpProgram(double v = 0.03, double epsilon = 0.5, double eta = 3) {
  dynamics::RobotProgram p;
  p.kind = dynamics::kAbp;
  p.v = v;
  p.epsilon = epsilon;
  p.eta = eta;
  return dynamics::toProgramParams(p).params;
}

inline dynamics::ProgramParams rtpProgram(double v, double gamma, double tau_t) {
  dynamics::RobotProgram p;
  p.kind = dynamics::kRtp;
  p.v = v;
  p.gamma = gamma;
  p.tau_t = tau_t;
  return dynamics::toProgramParams(p).params;
}

inline dynamics::ProgramParams bpProgram(double va, double V, double epsilon) {
  dynamics::RobotProgram p;
  p.kind = dynamics::kNoisyAbp;
  p.va = va;
  p.V = V;
  p.epsilon = epsilon;
  return dynamics::toProgramParams(p).params;
}

inline dynamics::ProgramParams wheelsProgram(double left, double right) {
  dynamics::RobotProgram p;
  p.kind = dynamics::kWheels;
  p.wheel_left = left;
  p.wheel_right = right;
  return dynamics::toProgramParams(p).params;
}

/// Settings that run one program for any light.
inline dynamics::CoreSettings always(const dynamics::ProgramParams& program) {
  dynamics::CoreSettings settings;
  settings.light.count = 1;
  settings.light.bands[0] = {0, 1024, 0};
  settings.programs[0] = program;
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

inline void startAll(World& world, const dynamics::CoreSettings& settings) {
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
