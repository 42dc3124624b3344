/// A closed log as a stream of decoded messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <lab/experiment_event_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/report/record/message_loss.hpp"

namespace lab::report {

/// Receivers of the decoded messages, called in the order of the log.
struct MessageSinks {
  std::function<void(const tracked_frame_t&)> frame;
  std::function<void(const robot_status_t&)> robots;
  std::function<void(const robot_command_t&)> command;  ///< unchecked; empty: not read
  std::function<void(const light_status_t&)> light;
  std::function<void(const experiment_event_t&)> event;
  std::function<void(const service_status_t&)> service;
  std::function<void(const link_status_t&)> link;
  std::function<void(const robot_senses_t&)> senses;  ///< empty: not read
};

/// Messages of one channel that are not used, and robots and detections that were removed from
/// messages, because something in them is impossible.
struct RefusedMessages {
  std::int64_t count = 0;   ///< messages
  std::int64_t robots = 0;  ///< and detections, in other messages
  std::string first;        ///< the reason for the first one: sender, field, found, expected
};

/// Counts of a finished reading.
struct LogFacts {
  std::int64_t events = 0;
  std::int64_t frames = 0;          ///< TRACKED_FRAME messages
  std::int64_t damaged_places = 0;  ///< damaged places that were skipped
  std::int64_t first_utime = 0;     ///< first arrival [us since 1970]
  std::int64_t last_utime = 0;      ///< last arrival
  bool virtual_time = false;        ///< the log has CLOCK messages
  std::vector<StreamLoss> streams;
  std::map<std::string, std::int64_t> decode_errors;  ///< by channel of the lab
  std::map<std::string, std::int64_t>
      other_channels;                              ///< messages on channels that are not the lab's
  std::map<std::string, RefusedMessages> refused;  ///< by channel of the lab
  std::int64_t bad_times = 0;                      ///< messages whose time of arrival is damaged
  std::int64_t foreign_senders =
      0;  ///< messages of senders beyond the limit, not counted by stream
};

/// The files behind RUN (a run's folder) or LOG (a log file, with its continuations).
/// @throws ReportError if there is none, or if it is empty or not an LCM log.
[[nodiscard]] std::vector<std::filesystem::path> logFiles(const std::filesystem::path& run_or_log);

/// The START event of the run: the first one whose contract version, types and experiment this
/// software reads, else the one of which it reads most. Only its sender's events are those of the
/// run.
[[nodiscard]] std::optional<experiment_event_t> findStart(
    const std::vector<std::filesystem::path>& files);

/// Reads the whole log once. Messages with impossible numbers (message_values.hpp), times that do
/// not continue their stream (arrival_clock.hpp), and events of others than the run's runner are
/// counted and not passed on. A log of several runs has one runner after the other.
/// @throws ReportError if the log has another contract version.
[[nodiscard]] LogFacts readMessages(const std::vector<std::filesystem::path>& files,
                                    const MessageSinks& sinks);

}  // namespace lab::report
