#include "common/service/manual_light.hpp"

#include "common/experiment/light_messages.hpp"
#include "common/math/units.hpp"

namespace lab {
namespace {

constexpr std::int64_t kRepeat_us = 500'000;
constexpr int kReleaseMessages = 3;

}  // namespace

void ManualLight::show(double intensity, double hold, const std::string& label, std::int64_t now) {
  until_utime_ = hold > 0 ? now + units::microseconds(hold) : 0;
  const bool same =
      showing_ && command_.label == label && command_.layers.front().intensity == intensity;
  if (same) return;
  ++command_.seq;
  command_.priority = light_command_t::MANUAL;
  command_.from_utime = now;
  command_.release = 0;
  command_.label = label;
  light::Layer uniform;
  uniform.kind = light::LayerKind::kUniform;
  uniform.intensity = intensity;
  setLayers(command_, {{uniform, {}}});
  showing_ = true;
  remaining_releases_ = 0;
  sent_utime_ = 0;
}

void ManualLight::release() {
  if (!showing_) return;
  showing_ = false;
  remaining_releases_ = kReleaseMessages;
  sent_utime_ = 0;
  ++command_.seq;
  command_.release = 1;
  setLayers(command_, {});
}

std::optional<light_command_t> ManualLight::due(std::int64_t now) {
  if (showing_ && until_utime_ != 0 && now >= until_utime_) release();
  if ((!showing_ && remaining_releases_ == 0) || now - sent_utime_ < kRepeat_us)
    return std::nullopt;
  if (!showing_) --remaining_releases_;
  sent_utime_ = now;
  return command_;
}

}  // namespace lab
