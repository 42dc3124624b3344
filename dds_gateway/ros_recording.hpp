/// What the gateway would have published of a run, for recordings that ROS 2's tools open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <lab/analysis_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "common/bus/bus.hpp"
#include "common/experiment/experiment.hpp"

namespace lab::gateway {

/// The definition of a ROS 2 message in the form "ros2msg" of MCAP: its .msg file, and those of the
/// types in it.
/// @param name of a type that RosRecording gives: "geometry_msgs/msg/PoseStamped"
/// @throws std::out_of_range if the gateway has none of this name
[[nodiscard]] std::string rosDefinition(const std::string& name);

/// Makes the messages of the topics of docs/ros2.md: /tf, poses, light_field, analysis, and of each
/// robot its pose and its light. Names and frames are those of the gateway; its topic mapping does
/// not apply.
class RosRecording {
 public:
  /// One message. The views are valid during the call.
  struct Message {
    std::string_view topic;
    std::string_view type;
    std::int64_t utime = 0;  ///< [us since 1970] its stamp
    Bytes cdr;
  };
  using Sink = std::function<void(const Message&)>;

  struct Options {
    bool each_robot = true;  ///< topics of single robots
  };

  /// @param directory of the run, with the images of the light script
  RosRecording(const Experiment& experiment, const std::filesystem::path& directory,
               const Options& options, Sink sink);
  ~RosRecording();
  RosRecording(const RosRecording&) = delete;
  RosRecording& operator=(const RosRecording&) = delete;

  void take(const tracked_frame_t& frame);
  void take(const robot_status_t& status);
  void take(const light_status_t& status);
  void take(const analysis_t& analysis);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab::gateway
