#include "dashboard/control/operator_request_reader.hpp"

#include "dashboard/control/json_object_reader.hpp"

namespace lab::dashboard {
namespace {

constexpr std::size_t kLongestRequestText = 500;  // characters
constexpr double kLongestHold = 86400;            // [s]
constexpr double kLongestLog = 1e7;               // [s]
constexpr double kSlowest = 0.01;                 // [1] log seconds a second
constexpr double kFastest = 1000;

/// What is wrong with the words is no reason not to stop.
std::string reasonOf(JsonObjectReader& form) {
  try {
    return form.text("reason", kLongestRequestText);
  } catch (const JsonObjectError&) {
    return {};
  }
}

OperatorRequest operatorRequestOf(const std::string& name, JsonObjectReader& form) {
  if (name == "stop") return StopRobots{reasonOf(form)};
  if (name == "release_stop") return ReleaseStop{};
  if (name == "pause") return PauseScript{};
  if (name == "resume") return ResumeScript{};
  if (name == "mark") return MarkRun{form.text("text", kLongestRequestText)};
  if (name == "end") return EndRun{form.text("why", kLongestRequestText)};
  if (name == "light") {
    const double intensity = form.number("intensity", 0, 1);
    return ShowLight{intensity, form.number("hold_s", 0, kLongestHold)};
  }
  if (name == "release_light") return ReleaseLight{};
  if (name == "seek") return SeekLog{form.number("to_s", 0, kLongestLog)};
  if (name == "speed") return SpeedLog{form.number("speed", kSlowest, kFastest)};
  throw JsonObjectError(
      "wish: expected stop, release_stop, pause, resume, mark, end, light, release_light, seek or "
      "speed");
}

}  // namespace

std::variant<OperatorRequest, InvalidRequest> readOperatorRequest(std::string_view json) {
  try {
    JsonObjectReader form(json);
    const OperatorRequest wish = operatorRequestOf(form.text("wish", kLongestRequestText), form);
    form.finish();
    return wish;
  } catch (const JsonObjectError& error) {
    return InvalidRequest{error.what()};
  }
}

}  // namespace lab::dashboard
