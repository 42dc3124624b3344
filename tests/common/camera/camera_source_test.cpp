#include "common/camera/camera_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lab {
namespace {

using testing::HasSubstr;

TEST(CameraSource, MayBeACameraAFileOrAnAddressOfACamera) {
  for (const char* source : {"sim", "pipeline", "/dev/video0", "v4l2:/dev/video0", "f*.png",
                             "film.mkv", "rtsp://camera/1", "http://camera/video", "srt://a:1"}) {
    EXPECT_EQ(cameraSourceProblem(source), "") << source;
  }
}

TEST(CameraSource, MayNotBeAnotherProtocolOfFfmpeg) {
  for (const char* source :
       {"file:///etc/passwd", "concat:http://a|file:///etc/passwd", "subfile,,start,0,end,9,,:a://",
        "pipe://0", "data://x", "tee:a://b", "unix:///run/x", "-i://x", "HTTP://a"}) {
    EXPECT_THAT(cameraSourceProblem(source), HasSubstr("allowed rtsp://")) << source;
  }
}

TEST(CameraSource, MayNotBeAPipelineInAFile) {
  EXPECT_THAT(cameraSourceProblem("gst:filesrc location=/a ! filesink location=/b"),
              HasSubstr("--camera-pipeline"));
}

TEST(CameraSource, OfAnAddressReachesNoFileOfThisMachine) {
  for (const char* source : {"rtsp://a", "rtsps://a", "rtp://a", "rtmp://a", "http://a",
                             "https://a", "udp://a", "tcp://a", "srt://a"}) {
    const std::string protocols = "," + protocolsOf(source) + ",";
    EXPECT_NE(protocols, ",,") << source;
    for (const char* local : {",file,", ",pipe,", ",concat,", ",subfile,", ",data,", ",unix,"}) {
      EXPECT_EQ(protocols.find(local), std::string::npos) << source << local;
    }
  }
}

}  // namespace
}  // namespace lab
