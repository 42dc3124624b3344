#include "dashboard/control/operator_request_reader.hpp"

#include "dashboard/control/json_object_reader.hpp"

namespace lab::dashboard {
namespace {

constexpr const char* kKey = "request";
constexpr const char* kFormerKey = "wish";
constexpr std::size_t kMaxRequestText = 500;  // characters
constexpr double kMaxHold = 86400;            // [s]
constexpr double kMaxLog = 1e7;               // [s]
constexpr double kMinSpeed = 0.01;            // [1] seconds of the log per second
constexpr double kMaxSpeed = 1000;

/// Invalid text must not prevent a stop: the reason is then empty.
std::string reasonOf(JsonObjectReader& json) {
  try {
    return json.text("reason", kMaxRequestText);
  } catch (const JsonObjectError&) {
    return {};
  }
}

OperatorRequest operatorRequestOf(const std::string& name, JsonObjectReader& json) {
  if (name == "stop") return StopRobots{reasonOf(json)};
  if (name == "release_stop") return ReleaseStop{};
  if (name == "pause") return PauseScript{};
  if (name == "resume") return ResumeScript{};
  if (name == "mark") return MarkRun{json.text("text", kMaxRequestText)};
  if (name == "end") return EndRun{json.text("why", kMaxRequestText)};
  if (name == "light") {
    const double intensity = json.number("intensity", 0, 1);
    return ShowLight{intensity, json.number("hold_s", 0, kMaxHold)};
  }
  if (name == "release_light") return ReleaseLight{};
  if (name == "seek") return SeekLog{json.number("to_s", 0, kMaxLog)};
  if (name == "speed") return SpeedLog{json.number("speed", kMinSpeed, kMaxSpeed)};
  throw JsonObjectError(
      "request: expected stop, release_stop, pause, resume, mark, end, light, release_light, seek "
      "or speed");
}

}  // namespace

std::variant<OperatorRequest, InvalidRequest> readOperatorRequest(std::string_view text) {
  try {
    JsonObjectReader json(text);
    const char* key = json.has(kFormerKey) ? kFormerKey : kKey;
    const OperatorRequest request = operatorRequestOf(json.text(key, kMaxRequestText), json);
    json.finish();
    return request;
  } catch (const JsonObjectError& error) {
    return InvalidRequest{error.what()};
  }
}

}  // namespace lab::dashboard
