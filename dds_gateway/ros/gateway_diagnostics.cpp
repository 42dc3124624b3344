/// RosBridge's word about itself and the lab: /diagnostics.
#include <fmt/format.h>

#include "common/math/units.hpp"
#include "dds_gateway/ros/ros_bridge.hpp"

namespace lab::gateway {
namespace {

constexpr std::int64_t kStale_us = 3'000'000;  // services speak once a second
constexpr std::size_t kMostTopics = 300;  // with more, a message would be too large for comfort

std::int64_t lostBy(const service_status_t& status) {
  std::int64_t lost = 0;
  for (const stream_count_t& row : status.received) lost += row.lost;
  return lost;
}

}  // namespace

void RosBridge::sendDiagnostics() {
  if (!diagnostics_ || !diagnostics_->admit(loop_.now())) return;
  Diagnostics diagnostics;
  addServices(diagnostics);
  addTopics(diagnostics);
  if (commands_) commands_->addTo(diagnostics);
  diagnostics_->write(&diagnostics.make(loop_.now()));
}

void RosBridge::addServices(Diagnostics& diagnostics) const {
  for (const auto& [sender, heard] : services_) {
    const service_status_t& service = heard.status;
    Diagnostics::Status status;
    status.name = names_.lab() + ": " + sender;
    status.hardware = service.host;
    status.message = service.last_error;
    const std::int64_t lost = lostBy(service);
    if (service.state == service_status_t::FAULT) {
      status.level = Diagnostics::kError;
    } else if (service.state == service_status_t::ENDED) {
      status.level = Diagnostics::kStale;
      status.message = "ended";
    } else if (loop_.now() - heard.utime > kStale_us) {
      status.level = Diagnostics::kStale;
      status.message = "silent";
    } else if (!service.last_error.empty() || lost > 0) {
      status.level = Diagnostics::kWarn;
    }
    status.values = {{"version", service.version},
                     {"pid", std::to_string(service.pid)},
                     {"messages lost", std::to_string(lost)}};
    diagnostics.add(std::move(status));
  }
}

void RosBridge::addTopics(Diagnostics& diagnostics) {
  Diagnostics::Status status;
  status.name = names_.lab() + ": topics";
  std::int64_t timeouts = 0;
  std::int64_t refused = 0;
  std::string why;
  const auto outlets = publishers_.all();
  for (const RosPublishers::Handle& outlet : outlets) {
    const dds::Matching matching = outlet->writer().matching();
    timeouts += outlet->writer().timeouts();
    refused += matching.refused;
    if (matching.refused > 0) why = outlet->topic() + " with another " + matching.why;
    if (status.values.size() >= kMostTopics) continue;
    std::string text = fmt::format("readers {}, in {}, out {}, thinned {}, timeouts {}",
                                   matching.peers, outlet->offered(), outlet->writer().written(),
                                   outlet->thinned(), outlet->writer().timeouts());
    if (outlet->lastUtime() != 0) {
      text += fmt::format(", age {:.1f} s", units::seconds(loop_.now() - outlet->lastUtime()));
    }
    if (matching.refused > 0) {
      text += fmt::format(", readers refused {} (ROS side asks for another {})", matching.refused,
                          matching.why);
    }
    status.values.emplace_back(outlet->topic(), std::move(text));
  }
  if (outlets.size() > kMostTopics) {
    status.values.emplace_back("and more topics", std::to_string(outlets.size() - kMostTopics));
  }
  if (refused_robots_ > 0) {
    status.values.emplace_back("words of robots beyond the limit", std::to_string(refused_robots_));
  }
  const std::int64_t malformed = dds::malformedReceived();
  if (malformed > 0) {
    status.values.emplace_back("malformed, dropped", std::to_string(malformed));
    status.message = "somebody sends what is no message of its topic";
  }
  if (!warnings_.empty()) status.values.emplace_back("Cyclone DDS", warnings_);
  if (foreign_.count() > 0) {
    status.values.emplace_back("endpoints of another type", std::to_string(foreign_.count()));
    status.message = foreign_.last();
  }
  if (timeouts > 0) status.message = fmt::format("{} messages not taken in time", timeouts);
  if (refused > 0) status.message = "ROS side asks for " + why;
  const bool fine = malformed == 0 && timeouts == 0 && refused == 0 && foreign_.count() == 0;
  status.level = fine ? Diagnostics::kOk : Diagnostics::kWarn;
  diagnostics.add(std::move(status));
}

}  // namespace lab::gateway
