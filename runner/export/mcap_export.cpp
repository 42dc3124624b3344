#include "runner/export/mcap_export.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "analyzer/log_source.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_header.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/schema/cdr_writer.hpp"
#include "common/schema/ros_encoding.hpp"
#include "common/schema/schema.hpp"
#include "dds_gateway/ros_recording.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/export/mcap_reader.hpp"
#include "runner/export/mcap_writer.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBusTopics = "/bus/";
constexpr const char* kRosSchema = "ros2msg";
constexpr const char* kCdr = "cdr";
constexpr std::uintmax_t kMostExpansion = 300;  // a log of the lab: about 2

/// Of sensor_msgs, which the gateway does not publish.
constexpr const char* kCompressedImage = "sensor_msgs/msg/CompressedImage";
constexpr const char* kCompressedImageDefinition =
    "std_msgs/Header header\n"
    "string format  # jpeg\n"
    "uint8[] data\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

std::uint64_t nanoseconds(std::int64_t utime) {
  return utime <= 0 ? 0 : static_cast<std::uint64_t>(utime) * 1000;
}

class McapExport {
 public:
  McapExport(const fs::path& directory, const fs::path& file, const McapOptions& options)
      : directory_(directory),
        options_(options),
        writer_(file, options.library, {options.compress}) {}

  McapResult write(const std::vector<fs::path>& log) {
    beginRos(log);
    nextPicture();
    std::uint64_t first = 0;
    readLog(log, [&](const Packet& packet) {
      if (first == 0) first = nanoseconds(packet.received_utime);
      writePictures(packet.received_utime);
      take(packet);
    });
    writePictures(std::numeric_limits<std::int64_t>::max());
    for (const auto& [name, text] : options_.attachments) {
      const bool json = name.ends_with(".json");
      writer_.addAttachment(name, json ? "application/json" : "text/plain", text, first);
    }
    writer_.close();
    return result_;
  }

 private:
  void beginRos(const std::vector<fs::path>& log) {
    if (!options_.ros) return;
    const auto start = report::findStart(log);
    if (!start) return;
    try {
      experiment_ = parseExperiment(start->text, "experiment in the log");
    } catch (const ExperimentError&) {
      return;  // of a version that this one cannot read: the bus's topics remain
    }
    // Only a complete folder of a run has the images of its light script.
    if (!fs::is_directory(directory_ / "images")) experiment_->light.steps.clear();
    const bool few = experiment_->robots.size() <= McapOptions::kEachRobot;
    ros_ = std::make_unique<gateway::RosRecording>(
        *experiment_, directory_,
        gateway::RosRecording::Options{.each_robot = options_.each_robot.value_or(few)},
        [this](const gateway::RosRecording::Message& message) {
          const std::uint16_t channel =
              channelOf(std::string(message.topic), std::string(message.type),
                        [&] { return gateway::rosDefinition(std::string(message.type)); });
          writer_.addMessage(channel, log_time_, nanoseconds(message.utime), message.cdr);
        });
  }

  template <class Definition>
  std::uint16_t channelOf(const std::string& topic, const std::string& type,
                          const Definition& definition) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) return known->second;
    auto schema = schemas_.find(type);
    if (schema == schemas_.end()) {
      schema = schemas_.emplace(type, writer_.addSchema(type, kRosSchema, definition())).first;
    }
    return channels_.emplace(topic, writer_.addChannel(schema->second, topic, kCdr)).first->second;
  }

  void take(const Packet& packet) {
    ++result_.messages;
    log_time_ = nanoseconds(packet.received_utime);
    const schema::Type* type = schema::messageSchema().findHash(
        schema::fingerprintOf(packet.data.data(), packet.data.size()));
    const auto cdr = type == nullptr ? std::nullopt : schema::toCdr(*type, packet.data);
    if (!cdr) {
      ++result_.left_out;
      return;
    }
    if (options_.bus) {
      const std::uint16_t channel =
          channelOf(std::string(kBusTopics) + std::string(packet.channel), schema::rosName(*type),
                    [&] { return schema::rosDefinition(*type); });
      const auto header = peekHeader(packet.data);
      writer_.addMessage(channel, log_time_, header ? nanoseconds(header->utime) : log_time_, *cdr);
    }
    if (!ros_) return;
    if (packet.channel == channels::kTrackedFrame) toRos<tracked_frame_t>(packet);
    if (packet.channel == channels::kRobotStatus) toRos<robot_status_t>(packet);
    if (packet.channel == channels::kLightStatus) toRos<light_status_t>(packet);
    if (packet.channel == channels::kAnalysis) toRos<analysis_t>(packet);
  }

  template <class Message>
  void toRos(const Packet& packet) {
    Message message{};
    if (!decode(packet.data, message)) return;
    const auto impossible = removeImpossible(message);
    if (!impossible || impossible->usable) ros_->take(message);
  }

  void nextPicture() { picture_ = options_.film ? options_.film() : std::nullopt; }

  /// Pictures and messages are merged by time, so that tools play both without searching.
  void writePictures(std::int64_t until) {
    for (; picture_ && picture_->utime <= until; nextPicture()) {
      schema::CdrWriter cdr;
      cdr.number(static_cast<std::int32_t>(picture_->utime / 1'000'000));
      cdr.number(static_cast<std::uint32_t>(picture_->utime % 1'000'000 * 1000));
      const std::string frame =
          picture_->camera.empty() ? "lab/camera" : "lab/camera/" + picture_->camera;
      cdr.text(frame);
      cdr.text("jpeg");
      cdr.length(picture_->jpeg.size());
      cdr.bytes(picture_->jpeg.data(), picture_->jpeg.size());
      const std::uint16_t channel = channelOf("/" + frame + "/compressed", kCompressedImage,
                                              [] { return kCompressedImageDefinition; });
      const std::uint64_t time = nanoseconds(picture_->utime);
      writer_.addMessage(channel, time, time, cdr.encoding());
      ++result_.pictures;
    }
  }

  fs::path directory_;
  const McapOptions& options_;
  mcap::Writer writer_;
  std::optional<Experiment> experiment_;
  std::unique_ptr<gateway::RosRecording> ros_;
  std::map<std::string, std::uint16_t> schemas_, channels_;
  std::optional<FilmPicture> picture_;
  std::uint64_t log_time_ = 0;
  McapResult result_;
};

}  // namespace

McapResult writeMcap(const std::vector<fs::path>& log, const fs::path& directory,
                     const fs::path& file, const McapOptions& options) {
  return McapExport(directory, file, options).write(log);
}

std::int64_t writeLogOfMcap(const fs::path& file, const fs::path& log) {
  const std::uintmax_t most_bytes = kMostExpansion * fs::file_size(file);
  std::uintmax_t bytes = 0;
  std::unique_ptr<LogWriter> writer;
  std::int64_t count = 0;
  const mcap::ReadResult read = mcap::read(file, [&](const mcap::Message& message) {
    if (!message.topic.starts_with(kBusTopics)) return;
    const schema::Type* type = schema::typeOfRosName(message.schema);
    if (type == nullptr || message.encoding != kCdr) return;
    const auto encoding = schema::fromCdr(
        *type, {reinterpret_cast<const std::uint8_t*>(message.data.data()), message.data.size()});
    if (!encoding) {
      throw UserError(file.string() + ": a message on " + std::string(message.topic) + " is no " +
                      std::string(message.schema) +
                      " of this version: it was written by another version, or is damaged");
    }
    bytes += encoding->size();
    if (bytes > most_bytes) {
      throw UserError(fmt::format(
          "{}: found messages of more than {} times the size of the file, expected measurements, "
          "which Zstandard does not compress like that: it may be made to fill the disk",
          file.string(), kMostExpansion));
    }
    if (!writer) writer = std::make_unique<LogWriter>(log);
    writer->write({message.topic.substr(kBusTopics.size()), *encoding,
                   static_cast<std::int64_t>(message.log_time / 1000)});
    ++count;
  });
  static_cast<void>(read);
  if (writer) writer->flush();
  return count;
}

}  // namespace lab::runner
