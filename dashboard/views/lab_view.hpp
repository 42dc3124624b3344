/// Turns messages of the bus into the topics of the page. Independent of bus and clock.
#pragma once

#include <cstdint>
#include <functional>
#include <lab/experiment_status_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common/bus/bus.hpp"
#include "dashboard/control/controls.hpp"
#include "dashboard/health/health_view.hpp"
#include "dashboard/health/process_meter.hpp"
#include "dashboard/views/correlation_view.hpp"
#include "dashboard/views/crowd_view.hpp"
#include "dashboard/views/curves_view.hpp"
#include "dashboard/views/history_view.hpp"
#include "dashboard/views/light_picture.hpp"
#include "dashboard/views/robots_view.hpp"
#include "dashboard/views/run_info.hpp"
#include "dashboard/views/run_times.hpp"
#include "dashboard/views/timeline_view.hpp"
#include "dashboard/views/tracks_view.hpp"
#include "dashboard/web/http_guard.hpp"
#include "dashboard/web/hub.hpp"

namespace lab::dashboard {

/// The state of the web server in topic `health`.
struct ServerFacts {
  std::string host;
  std::int32_t pid = 0;
  int viewers = 0;
  Refusals refusals;
  std::map<std::int32_t, ProcessUse> uses;  ///< by process id, on this host
};

/// Takes every message of the bus and publishes topics to the hub. Its memory is bounded. Times are
/// us since 1970.
class LabView {
 public:
  static constexpr std::int64_t kFrame_us = 50'000;  ///< 20 Hz
  /// `trails` queries within this time share one response.
  static constexpr std::int64_t kTrails_us = 500'000;

  /// Loads the images of an experiment's light. @param run the name of the run
  using Images = std::function<light::ImageStore(const Experiment&, const std::string& run)>;

  /// @param sender,instance of the dashboard: for its commands, and to ignore its own messages
  ///   except heartbeats, because it receives them from the bus too
  LabView(Hub& hub, std::string sender, std::int64_t instance, Images images);

  /// Sets the experiment from its file, before the first message.
  void begin(const Experiment& experiment, const std::string& run);

  void take(const Packet& packet, std::int64_t now);

  /// Publishes moving things, at most at 20 Hz, and everything that changed. Call it at 40 Hz, so
  /// that a new frame waits 25 ms at most.
  /// @param watched whether a page is open
  void publishMoving(std::int64_t now, bool watched);

  /// Publishes totals. Call it once per second.
  void publishTotals(std::int64_t now, const ServerFacts& server);

  /// See LabRequestHandler::query().
  [[nodiscard]] std::optional<std::string> query(std::string_view what, std::string_view which,
                                                 std::int64_t now);

  [[nodiscard]] Controls& controls() { return controls_; }
  [[nodiscard]] const HealthView& health() const { return health_; }

 private:
  /// @return how much was not understood: messages, or robots in them
  using Take = std::function<std::int64_t(Bytes, std::int64_t now)>;

  template <class Message>
  void on(std::string_view channel, std::function<void(const Message&, std::int64_t now)> handler);
  void subscribe();
  [[nodiscard]] bool isWanted(std::string_view channel, const MessageHeader& header);
  void take(const experiment_event_t& event, std::int64_t now);
  void take(const experiment_status_t& status, std::int64_t now);
  void clearRun();
  void useExperiment();
  void publish(std::string_view topic, std::string text);
  void publishNamedTopic(const std::string& kind, const std::string& name, std::string text);
  void publishPools();
  [[nodiscard]] Json healthJson(std::int64_t now, const ServerFacts& server) const;
  [[nodiscard]] std::string cameraJson() const;

  Hub& hub_;
  std::string sender_;
  std::int64_t instance_;
  Images images_;
  std::map<std::string, Take, std::less<>> takes_;

  RunInfo run_info_;
  RobotsView robots_{run_info_};
  TracksView tracks_;
  RunTimes run_times_{run_info_};
  CurvesView curves_;
  CrowdView crowd_;
  CorrelationView correlation_{run_info_};
  HistoryView history_;
  TimelineView timeline_;
  HealthView health_;
  LightPicture light_;
  Controls controls_;
  std::optional<experiment_status_t> script_;
  std::optional<light_delivery_t> delivery_;

  std::map<std::string, std::int64_t, std::less<>>
      frames_;                          ///< number of the last frame, by sender
  std::set<std::string> named_topics_;  ///< topics that contain the name of a program
  std::string trails_;                  ///< the last response, or empty
  std::int64_t trails_utime_ = 0;
  std::int64_t bus_utime_ = 0;  ///< last message of another sender, 0: none
  std::int64_t light_utime_ = 0;
  std::int64_t runner_utime_ = 0;  ///< last message of the run's runner
  std::int64_t frame_utime_ = 0;   ///< when topic `frame` was published
  std::uint64_t frame_count_ = 0;
  std::uint64_t timeline_version_ = 0;
  bool run_info_changed_ = true;
};

}  // namespace lab::dashboard
