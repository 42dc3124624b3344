#include "runner/script/crowd_light.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace lab::runner {
namespace {

constexpr double kLargestValue = 1e9;  // a larger one was not measured
constexpr double kLongestGap = 5;  // [s] after a longer one, the time between two values is unknown
// Smaller changes are not sent: projectors have 256 levels.
constexpr double kSmallestChange = 1.0 / 512;

bool isWithin(const CrowdRule& rule, double value) {
  return (!rule.above || value > *rule.above) && (!rule.below || value < *rule.below);
}

}  // namespace

PiRule::PiRule(const CrowdRule& rule, double intensity)
    : rule_(rule), base_(intensity), intensity_(intensity) {}

double PiRule::take(double value, double dt) {
  if (!(std::abs(value) < kLargestValue)) return intensity_;
  const double error = rule_.target - value;
  const double step = rule_.integral_time > 0 ? error * dt / rule_.integral_time : 0;
  const auto wanted = [&](double integral) { return base_ + rule_.gain * (error + integral); };
  const double with_step = wanted(integral_ + step);
  const bool deeper = (with_step > rule_.highest && rule_.gain * step > 0) ||
                      (with_step < rule_.lowest && rule_.gain * step < 0);
  if (!deeper && std::isfinite(step)) integral_ += step;
  intensity_ = std::clamp(wanted(integral_), rule_.lowest, rule_.highest);
  return intensity_;
}

CrowdLight::CrowdLight(const Experiment& experiment, const std::vector<LayerSpec>& layers) {
  for (const LayerSpec& layer : layers) {
    const CrowdRule& rule = layer.crowd;
    const std::string& name = rule.gate.empty() ? rule.hold : rule.gate;
    Entry entry{
        layer, CrowdValue(experiment, name, rule.program), PiRule(rule, layer.intensity), true, {}};
    // Until the first value, a gate is closed and no robot has a quorum.
    entry.shown = rule.gate.empty() && !rule.quorum;
    given_ = given_ || rule.given();
    entries_.push_back(std::move(entry));
  }
}

bool CrowdLight::take(const collective_t& message) {
  bool changed = false;
  for (Entry& entry : entries_) changed = apply(entry, message) || changed;
  return changed;
}

bool CrowdLight::apply(Entry& entry, const collective_t& message) {
  const CrowdRule& rule = entry.layer.crowd;
  if (!rule.given()) return false;
  if (rule.quorum) {
    if (message.program.hash != 0) return false;
    std::vector<std::int32_t> robots;
    const std::vector<std::int32_t>& wanted = entry.layer.drive.robots;
    for (const crowd_member_t& member : message.members) {
      const bool follows =
          wanted.empty() || std::ranges::find(wanted, member.robot_id) != wanted.end();
      if (follows && isWithin(rule, static_cast<double>(member.density))) {
        robots.push_back(member.robot_id);
      }
    }
    std::ranges::sort(robots);
    const bool changed = robots != entry.robots;
    entry.robots = std::move(robots);
    entry.shown = !entry.robots.empty();
    return changed;
  }
  const std::int64_t before = entry.value.utime();
  if (!entry.value.take(message)) return false;
  if (!rule.gate.empty()) {
    const bool shown = std::isfinite(entry.value.now()) && isWithin(rule, entry.value.now());
    return std::exchange(entry.shown, shown) != shown;
  }
  const double gap = before == 0 ? 0 : units::seconds(entry.value.utime() - before);
  const double intensity = entry.pi.take(entry.value.now(), gap <= kLongestGap ? gap : 0);
  // Limits are reached exactly.
  const bool at_limit = intensity == rule.lowest || intensity == rule.highest;
  const double change = std::abs(intensity - entry.layer.intensity);
  if (change < kSmallestChange && !(at_limit && change > 0)) return false;
  entry.layer.intensity = intensity;
  return true;
}

std::vector<LayerSpec> CrowdLight::layers() const {
  std::vector<LayerSpec> layers;
  for (const Entry& entry : entries_) {
    if (!entry.shown) continue;
    layers.push_back(entry.layer);
    if (entry.layer.crowd.quorum) layers.back().drive.robots = entry.robots;
  }
  return layers;
}

}  // namespace lab::runner
