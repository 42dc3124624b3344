/// Writes a log as an MCAP file for Rerun, Foxglove, Lichtblick, PlotJuggler and ROS 2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lab::runner {

/// One picture of a film, as JPEG.
struct FilmPicture {
  std::int64_t utime = 0;  ///< [us since 1970]
  std::vector<std::uint8_t> jpeg{};
  std::string camera{};  ///< name of one of several, which has its own topic; empty: there is one
};

struct McapOptions {
  bool bus = true;                 ///< every field of every message, as active_lab_bus/msg/...
  bool ros = true;                 ///< the gateway's topics: poses, tf, light field, ...
  std::optional<bool> each_robot;  ///< the gateway's topics of single robots; not given: if there
                                   ///< are at most kEachRobot
  static constexpr std::size_t kEachRobot = 20;
  bool compress = true;
  /// Gives the next picture of the films, in order of time; empty: there is no film.
  std::function<std::optional<FilmPicture>()> film{};
  /// Files to put into the file: name and contents.
  std::map<std::string, std::string> attachments{};
  std::string library{};  ///< name and version of this software
};

struct McapResult {
  std::int64_t messages = 0;  ///< of the log
  std::int64_t left_out = 0;  ///< damaged ones, and those of unknown types
  std::int64_t pictures = 0;
};

/// Payloads are CDR, schemas ros2msg, so that tools need no plug-in. The topic of a channel of the
/// bus is
/// "/bus/CHANNEL"; the other topics are those of docs/ros2.md. The time of a message is its arrival
/// at the recorder, its publish time is its utime.
/// @param directory of the run, with the images of its light script
/// @throws std::runtime_error if the file cannot be written
McapResult writeMcap(const std::vector<std::filesystem::path>& log,
                     const std::filesystem::path& directory, const std::filesystem::path& file,
                     const McapOptions& options);

/// Makes the log again from the topics "/bus/...".
/// @return number of messages; 0: the file has none of these topics
/// @throws UserError if the file cannot be read, or a message is not what its schema says
std::int64_t writeLogOfMcap(const std::filesystem::path& file, const std::filesystem::path& log);

}  // namespace lab::runner
