#include "runner/record/recorder_service.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <lab/service_status_t.hpp>
#include <memory>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kFlush_us = 100'000;  // as lcm-logger
constexpr double kMega = 1e6;

/// The number of this sender's SERVICE_STATUS messages that a closing message states.
std::int64_t lastSeq(const service_status_t& status) {
  for (const channel_count_t& count : status.sent) {
    if (count.channel == channels::kServiceStatus) return count.messages;
  }
  return 0;
}

class RecorderService final : public Service {
 public:
  RecorderService(const ServiceContext& context, const std::filesystem::path& log)
      : node_(context.node), writer_(log) {
    node_.subscribeAll([this](const Packet& packet) { take(packet); });
    context.loop.every(kFlush_us, context.loop.now() + kFlush_us, [this] { writer_.flush(); });
    node_.ready();
  }

  ~RecorderService() override {
    spdlog::info("recorded {} messages, {:.1f} MB", messages_, static_cast<double>(bytes_) / kMega);
  }

  /// What waits on the bus before the node's last message is still recorded.
  [[nodiscard]] bool isForwarding() override {
    if (closed_) writer_.flush();
    return !closed_;
  }

 private:
  void take(const Packet& packet) {
    writer_.write(packet);
    ++messages_;
    bytes_ += packet.data.size();
    if (packet.channel == channels::kServiceStatus) notice(packet);
  }

  void notice(const Packet& packet) {
    service_status_t status{};
    if (!decode(packet.data, status) || status.sender != node_.identity().name ||
        status.instance != node_.identity().instance) {
      return;
    }
    closed_ = status.state == service_status_t::ENDED && status.seq >= lastSeq(status);
  }

  Node& node_;
  LogWriter writer_;
  std::int64_t messages_ = 0;
  std::uint64_t bytes_ = 0;
  bool closed_ = false;  ///< the node's last message is recorded
};

}  // namespace

ServiceDescription recorderDescription() {
  ServiceDescription description;
  description.name = "recorder";
  description.summary = "Records everything on the bus in a log, as the stock lcm-logger does";
  description.needs_experiment = false;
  const auto log = std::make_shared<std::filesystem::path>();
  description.add_options = [log](CLI::App& app) {
    app.add_option("--log", *log, "File for the log; it must not exist")
        ->required()
        ->check(CLI::NonexistentPath);
  };
  description.make = [log](const ServiceContext& context) -> std::unique_ptr<Service> {
    return std::make_unique<RecorderService>(context, *log);
  };
  return description;
}

}  // namespace lab::runner
