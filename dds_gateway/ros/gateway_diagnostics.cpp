#include "dds_gateway/ros/gateway_diagnostics.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/math/units.hpp"
#include "dds_gateway/dds/domain.hpp"

namespace lab::gateway {
namespace {

constexpr std::int64_t kStale_us = 3'000'000;  // services publish their status once a second
constexpr std::size_t kMostTopics = 300;       // limits the size of the message
constexpr std::size_t kMostServices = 500;     // likewise, and the memory

std::int64_t lostBy(const service_status_t& status) {
  std::int64_t lost = 0;
  for (const stream_count_t& row : status.received) lost += row.lost;
  return lost;
}

}  // namespace

void GatewayDiagnostics::take(const service_status_t& status, std::int64_t now) {
  // A command by hand (`lab mark`) publishes only its last counts; it is no service.
  const bool ended = status.state == service_status_t::ENDED;
  const bool refused = ended || services_.size() >= kMostServices;
  if (refused && !services_.contains(status.sender)) return;
  services_[status.sender] = {status, now};
}

const ros::DiagnosticArray& GatewayDiagnostics::make(Diagnostics& diagnostics, std::int64_t now,
                                                     std::int64_t refused_robots,
                                                     RosCommands* commands) {
  addServices(diagnostics, now);
  addTopics(diagnostics, now, refused_robots);
  if (commands != nullptr) commands->addTo(diagnostics);
  return diagnostics.make(now);
}

void GatewayDiagnostics::addServices(Diagnostics& diagnostics, std::int64_t now) const {
  for (const auto& [sender, received] : services_) {
    const service_status_t& service = received.status;
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
    } else if (now - received.utime > kStale_us) {
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

void GatewayDiagnostics::addTopics(Diagnostics& diagnostics, std::int64_t now,
                                   std::int64_t refused_robots) {
  Diagnostics::Status status;
  status.name = names_.lab() + ": topics";
  std::int64_t timeouts = 0;
  std::int64_t refused = 0;
  std::string why;
  const auto publishers = publishers_.all();
  for (const RosPublishers::Handle& publisher : publishers) {
    const dds::Matching matching = publisher->writer().matching();
    timeouts += publisher->writer().timeouts();
    refused += matching.refused;
    if (matching.refused > 0) why = publisher->topic() + " with another " + matching.why;
    if (status.values.size() >= kMostTopics) continue;
    std::string text = fmt::format(
        "readers {}, in {}, out {}, thinned {}, timeouts {}", matching.peers, publisher->offered(),
        publisher->writer().written(), publisher->thinned(), publisher->writer().timeouts());
    if (publisher->lastUtime() != 0) {
      text += fmt::format(", age {:.1f} s", units::seconds(now - publisher->lastUtime()));
    }
    if (matching.refused > 0) {
      text += fmt::format(", readers refused {} (ROS side asks for another {})", matching.refused,
                          matching.why);
    }
    status.values.emplace_back(publisher->topic(), std::move(text));
  }
  if (publishers.size() > kMostTopics) {
    status.values.emplace_back("and more topics", std::to_string(publishers.size() - kMostTopics));
  }
  if (refused_robots > 0) {
    status.values.emplace_back("messages of robots beyond the limit",
                               std::to_string(refused_robots));
  }
  const std::int64_t malformed = dds::malformedReceived();
  if (malformed > 0) {
    status.values.emplace_back("malformed, dropped", std::to_string(malformed));
    status.message = "received payloads that are not messages of their topic";
  }
  if (!warnings_.empty()) status.values.emplace_back("Cyclone DDS", warnings_);
  if (foreign_.count() > 0) {
    status.values.emplace_back("endpoints of another type", std::to_string(foreign_.count()));
    status.message = foreign_.last();
  }
  if (timeouts > 0) status.message = fmt::format("{} writes timed out", timeouts);
  if (refused > 0) status.message = "ROS side asks for " + why;
  const bool fine = malformed == 0 && timeouts == 0 && refused == 0 && foreign_.count() == 0;
  status.level = fine ? Diagnostics::kOk : Diagnostics::kWarn;
  diagnostics.add(std::move(status));
}

}  // namespace lab::gateway
