/// What the source of a camera may be. A source in an experiment file may come from a stranger, and
/// ffmpeg and GStreamer can read, write and execute more than pictures.
#pragma once

#include <string>

namespace lab {

/// In an experiment file: the pipeline that the command line gives (--camera-pipeline).
inline constexpr const char* kPipelineCamera = "pipeline";

/// Begins a GStreamer pipeline, on command lines only.
inline constexpr const char* kPipelinePrefix = "gst:";

/// Whether the source is a video device, "/dev/video0" or "v4l2:/dev/video0".
[[nodiscard]] bool isVideoDeviceSource(const std::string& source);

/// The path of such a device.
[[nodiscard]] std::string videoDevicePath(const std::string& source);

/// Whether ffmpeg reads the source through a protocol: it has "://".
[[nodiscard]] bool isCameraAddress(const std::string& source);

/// The protocols that ffmpeg may use for this address, as for -protocol_whitelist. Empty if the
/// address does not begin with one of rtsp://, rtsps://, rtp://, rtmp://, http://, https://,
/// udp://, tcp:// and srt://.
[[nodiscard]] std::string protocolsOf(const std::string& address);

/// Why an experiment file may not name this source: "found ..., allowed ..."; empty if it may.
[[nodiscard]] std::string cameraSourceProblem(const std::string& source);

}  // namespace lab
