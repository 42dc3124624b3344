#include "dds_gateway/ros/light_arbiter.hpp"

#include <cmath>

#include "common/text/utf8.hpp"

namespace lab::gateway {
namespace {

constexpr std::size_t kLongestLabel = 100;  // [byte] it is published twice a second

}  // namespace

bool LightArbiter::isOwned(dds::WriterId writer, std::int64_t now) const {
  return owner_ != 0 && owner_ != writer && now - heard_utime_ <= timeout_us_;
}

Answer LightArbiter::show(dds::WriterId writer, double intensity, double hold,
                          const std::string& words, std::int64_t now) {
  if (!std::isfinite(intensity) || !std::isfinite(hold)) return Answer::kNotFinite;
  if (intensity < 0 || intensity > 1 || hold < 0 || hold > kLongestHold) return Answer::kOutOfRange;
  if (isOwned(writer, now)) return Answer::kOwned;
  std::string label = words.substr(0, kLongestLabel);
  repairUtf8(label);
  owner_ = writer;
  heard_utime_ = now;
  light_.show(intensity, hold, label, now);
  return Answer::kTaken;
}

Answer LightArbiter::release(dds::WriterId writer, std::int64_t now) {
  if (isOwned(writer, now)) return Answer::kOwned;
  owner_ = 0;
  light_.release();
  return Answer::kTaken;
}

std::optional<light_command_t> LightArbiter::due(std::int64_t now) {
  const bool was_shown = light_.isShown();
  std::optional<light_command_t> command = light_.due(now);
  if (was_shown && !light_.isShown()) owner_ = 0;  // the hold has expired
  return command;
}

}  // namespace lab::gateway
