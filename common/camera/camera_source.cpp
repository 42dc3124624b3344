#include "common/camera/camera_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace lab {
namespace {

constexpr std::string_view kVideoDevicePrefix = "v4l2:";

struct Scheme {
  std::string_view begin;
  std::string_view protocols;
};

// A server may redirect within these protocols only. Without a list, a playlist that it sends may
// name files of this machine.
constexpr std::string_view kHttp = "http,https,tcp,tls,httpproxy";
constexpr std::string_view kRtsp = "rtsp,rtsps,rtp,srtp,rtcp,udp,tcp,tls,http,https,httpproxy";
constexpr std::array<Scheme, 9> kSchemes{{{"rtsp://", kRtsp},
                                          {"rtsps://", kRtsp},
                                          {"rtp://", "rtp,srtp,rtcp,udp"},
                                          {"rtmp://", "rtmp,tcp"},
                                          {"http://", kHttp},
                                          {"https://", kHttp},
                                          {"udp://", "udp"},
                                          {"tcp://", "tcp"},
                                          {"srt://", "srt,udp"}}};

}  // namespace

bool isVideoDeviceSource(const std::string& source) {
  return source.starts_with(kVideoDevicePrefix) || source.starts_with("/dev/");
}

std::string videoDevicePath(const std::string& source) {
  return source.starts_with(kVideoDevicePrefix) ? source.substr(kVideoDevicePrefix.size()) : source;
}

bool isCameraAddress(const std::string& source) { return source.find("://") != std::string::npos; }

std::string protocolsOf(const std::string& address) {
  const auto* const found = std::ranges::find_if(
      kSchemes, [&](const Scheme& scheme) { return address.starts_with(scheme.begin); });
  return found == kSchemes.end() ? std::string() : std::string(found->protocols);
}

std::string cameraSourceProblem(const std::string& source) {
  if (source.starts_with(kPipelinePrefix)) {
    return fmt::format(
        "found the pipeline \"{:.60}\", which can run programs and write files, allowed in a file: "
        "\"{}\", and the pipeline on the command line, --camera-pipeline \"ELEMENT ! ...\"",
        source, kPipelineCamera);
  }
  if (isCameraAddress(source) && protocolsOf(source).empty()) {
    return fmt::format(
        "found the address \"{:.60}\", allowed rtsp://, rtsps://, rtp://, rtmp://, http://, "
        "https://, udp://, tcp:// and srt://",
        source);
  }
  return {};
}

}  // namespace lab
