#include "dds_gateway/light_desk.hpp"

#include <cmath>

#include "common/light_messages.hpp"
#include "common/units.hpp"
#include "dds_gateway/utf8.hpp"

namespace lab::gateway {
namespace {

constexpr std::int64_t kRepeat_us = 500'000;
constexpr int kFarewells = 3;
constexpr std::size_t kLongestLabel = 100;  // [byte] it goes onto the bus twice a second

}  // namespace

bool LightDesk::isOwned(dds::WriterId writer, std::int64_t now) const {
  return owner_ != 0 && owner_ != writer && now - heard_utime_ <= timeout_us_;
}

Answer LightDesk::show(dds::WriterId writer, double intensity, double hold,
                       const std::string& words, std::int64_t now) {
  if (!std::isfinite(intensity) || !std::isfinite(hold)) return Answer::kNotFinite;
  if (intensity < 0 || intensity > 1 || hold < 0 || hold > kLongestHold) return Answer::kOutOfRange;
  if (isOwned(writer, now)) return Answer::kOwned;
  std::string label = words.substr(0, kLongestLabel);
  repairUtf8(label);
  owner_ = writer;
  heard_utime_ = now;
  until_utime_ = hold > 0 ? now + units::microseconds(hold) : 0;
  const bool same = showing_ && command_.num_layers == 1 && command_.label == label &&
                    command_.layers.front().intensity == intensity;
  if (same) return Answer::kTaken;
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
  farewells_ = 0;
  sent_utime_ = 0;
  return Answer::kTaken;
}

Answer LightDesk::release(dds::WriterId writer, std::int64_t now) {
  if (isOwned(writer, now)) return Answer::kOwned;
  giveBack();
  return Answer::kTaken;
}

void LightDesk::giveBack() {
  owner_ = 0;
  if (!showing_) return;
  showing_ = false;
  farewells_ = kFarewells;
  sent_utime_ = 0;
  ++command_.seq;
  command_.release = 1;
  setLayers(command_, {});
}

std::optional<light_command_t> LightDesk::due(std::int64_t now) {
  if (showing_ && until_utime_ != 0 && now >= until_utime_) giveBack();
  if ((!showing_ && farewells_ == 0) || now - sent_utime_ < kRepeat_us) return std::nullopt;
  if (!showing_) --farewells_;
  sent_utime_ = now;
  return command_;
}

}  // namespace lab::gateway
