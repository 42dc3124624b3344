#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/film_commands.hpp"
#include "tests/support/film_samples.hpp"
#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::track_markers_test {
namespace {

namespace fs = std::filesystem;
using support::readFile;
using testing::HasSubstr;

/// A film of moving markers, and the calibration of its camera.
class TrackMarkers : public testing::Test {
 protected:
  void film(const std::string& kind_name, double side) {
    cases::MarkerKind kind = cases::markerKind(kind_name);
    kind.count = 6;
    std::vector<cases::TrueMarker> markers = placeMarkers(kind, 4);
    fs::create_directory(folder_ / "film");
    for (int k = 0; k < kPictures; ++k) {
      kind.settings.seed = static_cast<std::uint64_t>(k) + 1;
      for (cases::TrueMarker& marker : markers) marker.x += 0.001;
      writePng(folder_ / ("film/f000" + std::to_string(k) + ".png"),
               paintMarkers(kind.settings, markers));
    }
    CameraCalibration calibration;
    calibration.camera = cameraOf(kind.settings).parameters();
    calibration.imaging = optics::Imaging{.gamma = 1};
    std::ofstream(folder_ / "camera.json") << cameraFileText(calibration);
    options_.source = (folder_ / "film").string();
    options_.calibration = folder_ / "camera.json";
    options_.out = folder_ / "poses.csv";
    options_.tag_size_cm = side;
  }

  [[nodiscard]] std::string problem() const {
    try {
      static_cast<void>(track(options_));
    } catch (const UserError& error) {
      return error.what();
    }
    return "none";
  }

  static constexpr int kPictures = 4;
  TemporaryFolder folder_;
  TrackOptions options_;
};

TEST_F(TrackMarkers, WritesBlobsWithAreaAndSwap) {
  film("blobs_clean", 0);
  options_.marker = "blobs";
  options_.diameters_cm = {1, 2.2};
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("6 to 6 blobs in each, 6 tracks"), HasSubstr("swaps are expected"),
                    HasSubstr("0 cm above the floor")));
  const std::string poses = readFile(options_.out);
  EXPECT_THAT(poses, testing::StartsWith("frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s,area_cm2,"
                                         "length_cm,width_cm,merged,swap\n"));
  EXPECT_EQ(std::ranges::count(poses, '\n'), 1 + kPictures * 6);
}

TEST_F(TrackMarkers, WritesTheNumbersOfTags) {
  film("tags_clean", 4);
  options_.marker = "tags";
  EXPECT_EQ(track(options_), kDone);
  const std::string poses = readFile(options_.out);
  EXPECT_THAT(poses,
              testing::StartsWith("frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s,tag\n0,1,"));
  EXPECT_EQ(std::ranges::count(poses, '\n'), 1 + kPictures * 6);
  EXPECT_THAT(poses, HasSubstr(",5\n"));
}

TEST_F(TrackMarkers, NeedsNoCalibrationBelowACameraStraightAbove) {
  film("blobs_clean", 0);
  options_.calibration.clear();
  options_.marker = "blobs";
  options_.diameters_cm = {1, 2.2};
  options_.cm_per_px = 0.135;
  EXPECT_EQ(track(options_), kDone);
  EXPECT_EQ(std::ranges::count(readFile(options_.out), '\n'), 1 + kPictures * 6);
}

TEST_F(TrackMarkers, SaysWhichOptionIsMissingOrTooMuch) {
  film("tags_clean", 0);
  options_.marker = "tags";
  EXPECT_THAT(problem(), HasSubstr("--tag-size-cm: found nothing"));
  options_.tag_size_cm = 4;
  options_.tag_family = "tag99";
  EXPECT_THAT(problem(), HasSubstr("--tag-family: found \"tag99\", expected one of tag36h11"));
  options_.tag_family.clear();
  options_.blob_tone = "bright";
  EXPECT_THAT(problem(),
              HasSubstr("--blob: found with --marker tags, expected with --marker blobs"));
  options_.blob_tone.clear();
  options_.tag_size_cm = 0;
  options_.marker = "blobs";
  EXPECT_THAT(problem(), HasSubstr("--diameter-cm: found nothing"));
  options_.diameters_cm = {2, 1};
  EXPECT_THAT(problem(), HasSubstr("--diameter-cm: found 2 1"));
  options_.diameters_cm = {1, 2};
  options_.calibration.clear();
  EXPECT_THAT(problem(), HasSubstr("found no --calibration"));
  EXPECT_FALSE(fs::exists(options_.out));
}

}  // namespace
}  // namespace lab::runner::track_markers_test
