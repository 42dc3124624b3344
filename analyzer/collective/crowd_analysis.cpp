#include "analyzer/collective/crowd_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/math/angle.hpp"

namespace lab::collective {
namespace {

constexpr double kLongestGap = 1.5;     // periods between frames that give a velocity
constexpr double kLongestInterval = 1;  // [s] a longer one between frames counts as no time
constexpr double kConfirm = 0.3;        // [s] before a change of place counts
constexpr double kLongestAbsence = 60;  // [s] then a robot is forgotten
// Tracks of particles get new ids all the time. With more than these, only the last frame counts.
constexpr std::size_t kMostKnown = 10 * CrowdAnalysis::kMostRobots;

PlaceNames withRest(const std::vector<std::string>& names, const char* rest) {
  PlaceNames places{names};
  if (!names.empty()) places.names.emplace_back(rest);
  return places;
}

std::vector<std::string> namesOf(const std::vector<Region>& regions) {
  std::vector<std::string> names;
  for (const Region& region : regions) names.push_back(region.name);
  return names;
}

}  // namespace

CrowdAnalysis::CrowdAnalysis(const CrowdConfig& config)
    : config_(config),
      region_names_(withRest(namesOf(config.regions), "elsewhere")),
      band_names_(withRest(config.bands, "no band")),
      regions_(kConfirm),
      bands_(kConfirm) {}

void CrowdAnalysis::setPeriod(double frame_period) {
  double& period = config_.settings.period;
  if (frame_period > 0) {
    period = frame_period * std::max(1.0, std::round(period / frame_period));
  }
  contacts_ = std::make_unique<ContactTracker>(config_.settings);
  observer_ = std::make_unique<FrameObserver>(config_.settings);
}

void CrowdAnalysis::addFrame(double time, double frame_period,
                             const std::vector<CrowdPose>& poses) {
  if (!contacts_) setPeriod(frame_period);
  // After a step of the clock backwards everything goes on from there.
  const bool back = time <= last_time_;
  forgetRobots(time);
  takePoses(time, poses);
  formGroups(poses);
  addRates(time, back, poses);
  last_time_ = time;
  const double period = config_.settings.period;
  const double early = 0.5 * std::min(frame_period, period);
  if (!back && time < next_evaluation_ - early) return;
  evaluate(time);
  // The schedule keeps its phase, unless frames were missing.
  const bool late = !(time < next_evaluation_ + period);
  next_evaluation_ = (late || back ? time : next_evaluation_) + period;
}

void CrowdAnalysis::forgetRobots(double time) {
  const bool recent = std::abs(time - forgotten_time_) < kLongestAbsence;
  if (recent && headings_.size() <= kMostKnown) return;
  forgotten_time_ = time;
  const auto forget = [this](const auto& isOld) {
    std::erase_if(headings_, [&](const auto& robot) {
      const auto& [id, heading] = robot;
      if (!isOld(heading.time)) return false;
      evaluated_.erase(id);
      regions_.forget(id);
      bands_.forget(id);
      contacts_->forget(id);
      for (const auto& [key, group] : groups_) group->forget(id);
      return true;
    });
  };
  forget([&](double seen) { return std::abs(time - seen) > kLongestAbsence; });
  if (headings_.size() > kMostKnown) forget([&](double seen) { return seen != last_time_; });
}

void CrowdAnalysis::takePoses(double time, const std::vector<CrowdPose>& poses) {
  robots_.clear();
  sources_.clear();
  std::size_t beyond = 0;
  const double margin = config_.settings.diameter;
  const Rectangle& arena = config_.settings.arena;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const CrowdPose& pose = poses[i];
    const bool inside = pose.x > arena.left - margin && pose.x < arena.right + margin &&
                        pose.y > arena.bottom - margin && pose.y < arena.top + margin;
    auto heading = headings_.find(pose.robot);
    const bool known = heading != headings_.end();
    const bool twice = known && heading->second.time == time;
    const bool possible = inside && !twice;
    if (possible && robots_.size() >= kMostRobots) ++beyond;
    if (!possible || robots_.size() >= kMostRobots) {
      ++left_out_;
      continue;
    }
    if (!known)
      heading = headings_.emplace(pose.robot, Heading{time, pose.theta, pose.theta}).first;
    Heading& last = heading->second;
    const double turn = wrapAngle(pose.theta - last.wrapped);
    last.continuous = std::isfinite(turn) ? last.continuous + turn : pose.theta;
    last.wrapped = pose.theta;
    last.time = time;
    robots_.push_back({pose.robot, pose.x, pose.y, last.continuous});
    sources_.push_back(i);
  }
  most_robots_ = std::max(most_robots_, robots_.size() + beyond);
}

CrowdGroup& CrowdAnalysis::groupOf(int key) {
  std::unique_ptr<CrowdGroup>& group = groups_[key];
  if (!group) {
    group = std::make_unique<CrowdGroup>(key, config_.settings, region_names_, band_names_);
  }
  return *group;
}

void CrowdAnalysis::formGroups(const std::vector<CrowdPose>& poses) {
  members_.clear();
  std::map<int, std::size_t> counts;
  for (const std::size_t source : sources_) ++counts[poses[source].program];
  if (robots_.size() >= 2 || groups_.contains(kAll)) {
    members_.push_back({&groupOf(kAll), std::vector<char>(robots_.size(), 1), robots_.size()});
  }
  for (const auto& [key, count] : counts) {
    if (key < 0) continue;
    const bool exists = groups_.contains(key);
    if (!exists && (count < 2 || groups_.size() > kMostGroups)) continue;
    Members members{&groupOf(key), std::vector<char>(robots_.size(), 0), count};
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      members.is_member[i] = poses[sources_[i]].program == key ? 1 : 0;
    }
    members_.push_back(std::move(members));
  }
}

void CrowdAnalysis::addRates(double time, bool back, const std::vector<CrowdPose>& poses) {
  const double interval = time - last_time_;
  const double dt =
      !back && interval <= kLongestInterval ? interval : 0;  // also of the first frame
  const ContactFrame& contacts = contacts_->take(time, robots_);
  for (const Members& members : members_) {
    const std::span<double> rates = members.group->rates();
    rates[RateChannels::kTime] += dt;
    rates[RateChannels::kRobotTime] += dt * static_cast<double>(members.count);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (members.is_member[i] == 0) continue;
      if (contacts.touching[i] != 0) rates[RateChannels::kTouching] += dt;
      if (contacts.at_wall[i] != 0) rates[RateChannels::kAtWall] += dt;
    }
    for (const auto& [i, j] : contacts.pairs) {
      if (members.is_member[i] != 0 && members.is_member[j] != 0) {
        rates[RateChannels::kPairTime] += dt;
      }
    }
    for (const EndedContact& contact : contacts.ended) {
      if (members.is_member[contact.first] == 0 || members.is_member[contact.second] == 0) continue;
      rates[RateChannels::kContactEnds] += 1;
      members.group->addContact(contact.duration);
    }
    for (const std::size_t i : contacts.left_wall) {
      if (members.is_member[i] != 0) rates[RateChannels::kWallEnds] += 1;
    }
  }
  if (config_.regions.empty() && config_.bands.empty()) return;
  std::vector<std::vector<double>> counts(members_.size(),
                                          std::vector<double>(region_names_.names.size(), 0.0));
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const CrowdRobot& robot = robots_[i];
    PlaceTracker::Change region;
    PlaceTracker::Change band;
    if (!config_.regions.empty()) {
      const auto found =
          std::find_if(config_.regions.begin(), config_.regions.end(),
                       [&](const Region& one) { return one.contains(robot.x, robot.y); });
      region = regions_.take(time, robot.id, static_cast<int>(found - config_.regions.begin()));
    }
    if (!config_.bands.empty()) band = bands_.take(time, robot.id, poses[sources_[i]].band);
    for (std::size_t m = 0; m < members_.size(); ++m) {
      const Members& members = members_[m];
      if (members.is_member[i] == 0) continue;
      const std::span<double> rates = members.group->rates();
      const RateChannels& channels = members.group->channels();
      if (region.to >= 0) {
        const auto to = static_cast<std::size_t>(region.to);
        counts[m][to] += 1;
        rates[channels.regionTime(to)] += dt;
        if (region.from >= 0 && region.from != region.to) {
          rates[channels.regionChange(static_cast<std::size_t>(region.from), to)] += 1;
        }
      }
      if (band.to >= 0) {
        const auto to = static_cast<std::size_t>(band.to);
        rates[channels.bandTime(to)] += dt;
        if (band.from >= 0 && band.from != band.to) {
          rates[channels.bandChange(static_cast<std::size_t>(band.from), to)] += 1;
        }
      }
    }
  }
  for (std::size_t m = 0; m < members_.size(); ++m) {
    members_[m].group->setRegionCounts(counts[m]);
  }
}

void CrowdAnalysis::evaluate(double time) {
  const double longest = kLongestGap * config_.settings.period;
  for (CrowdRobot& robot : robots_) {
    const auto [place, fresh] = evaluated_.try_emplace(robot.id, Place{time, robot.x, robot.y});
    Place& before = place->second;
    const double dt = time - before.time;
    if (!fresh && dt > 0 && dt <= longest) {
      robot.velocity_x = (robot.x - before.x) / dt;
      robot.velocity_y = (robot.y - before.y) / dt;
    }
    before = {time, robot.x, robot.y};
  }
  picture_.time = time;
  picture_.robots = robots_;
  picture_.observation = observer_->observe(robots_);
  std::vector<CrowdRobot> some;
  for (const Members& members : members_) {
    if (members.count == robots_.size()) {
      members.group->take(time, robots_, picture_.observation);
      continue;
    }
    some.clear();
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (members.is_member[i] != 0) some.push_back(robots_[i]);
    }
    members.group->take(time, some, observer_->observe(some));
  }
}

std::vector<CrowdResult> CrowdAnalysis::results() const {
  std::vector<CrowdResult> results;
  for (const auto& [key, group] : groups_) results.push_back(group->result());
  std::erase_if(results, [](const CrowdResult& result) { return result.frames == 0; });
  return results;
}

const CrowdGroup* CrowdAnalysis::group(int key) const {
  const auto found = groups_.find(key);
  return found == groups_.end() ? nullptr : found->second.get();
}

}  // namespace lab::collective
