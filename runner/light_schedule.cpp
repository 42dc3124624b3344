#include "runner/light_schedule.hpp"

namespace lab::runner {

std::optional<ScheduledStep> scheduledStep(const LightScript& script, double duration, int number) {
  const std::size_t steps = script.steps.size();
  if (steps == 0 || number < 0) return std::nullopt;
  const std::size_t pass = static_cast<std::size_t>(number) / steps;
  const std::size_t index = static_cast<std::size_t>(number) % steps;
  if (pass > 0 && !script.repeat) return std::nullopt;
  const double at = static_cast<double>(pass) * script.length + script.steps[index].at;
  if (at >= duration) return std::nullopt;
  return ScheduledStep{number, index, at};
}

}  // namespace lab::runner
