#include "analyzer/service/collective_message.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include "common/experiment/observable_names.hpp"

namespace lab::analysis {
namespace {

using collective::Observable;
using collective::ObservableCurve;

observable_t toMessage(const Observable& number) {
  observable_t message{};
  message.name = number.name;
  message.unit = number.unit;
  message.now = number.now;
  message.mean = number.average.value;
  message.sigma = number.average.sigma;
  message.low = number.average.low;
  message.high = number.average.high;
  return message;
}

observable_curve_t toMessage(const ObservableCurve& curve) {
  observable_curve_t message{};
  message.name = curve.name;
  message.x_unit = curve.x_unit;
  message.unit = curve.unit;
  for (const collective::CurveSample& point : curve.points) {
    message.x.push_back(static_cast<float>(point.x));
    message.value.push_back(static_cast<float>(point.average.value));
    message.low.push_back(static_cast<float>(point.average.low));
    message.high.push_back(static_cast<float>(point.average.high));
  }
  message.num_points = static_cast<std::int32_t>(message.x.size());
  return message;
}

void addMembers(const collective::CrowdPicture& picture, collective_t& message) {
  for (std::size_t i = 0; i < picture.robots.size(); ++i) {
    crowd_member_t member{};
    member.robot_id = picture.robots[i].id;
    member.cluster = static_cast<std::int16_t>(picture.observation.clusters[i]);
    member.density = static_cast<float>(picture.observation.densities[i]);
    member.hexatic = static_cast<float>(picture.observation.hexatics[i]);
    message.members.push_back(member);
  }
  message.num_members = static_cast<std::int32_t>(message.members.size());
}

}  // namespace

std::vector<collective_t> collectiveMessages(const CollectiveFeed& feed) {
  std::vector<collective_t> messages;
  for (const collective::CrowdResult& result : feed.analysis().results()) {
    collective_t message{};
    message.utime = feed.pictureUtime();
    message.program = feed.programOf(result.group);
    message.observed = result.observed;
    message.robots = result.robots;
    for (const Observable& number : result.numbers) {
      message.observables.push_back(toMessage(number));
    }
    for (std::size_t i = 0; i < result.regions.names.size(); ++i) {
      const double now = i < result.regions.now.size() ? result.regions.now[i] : units::kNan;
      message.observables.push_back(
          toMessage(Observable{std::string(kShareIn) + result.regions.names[i], "1", now,
                               units::kNan, result.regions.shares[i]}));
    }
    message.num_observables = static_cast<std::int32_t>(message.observables.size());
    for (const ObservableCurve& curve : result.curves) message.curves.push_back(toMessage(curve));
    message.num_curves = static_cast<std::int32_t>(message.curves.size());
    if (result.group == collective::CrowdAnalysis::kAll) {
      addMembers(feed.analysis().picture(), message);
    }
    messages.push_back(std::move(message));
  }
  return messages;
}

}  // namespace lab::analysis
