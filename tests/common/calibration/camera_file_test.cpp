#include "common/calibration/camera_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/experiment/experiment_file.hpp"
#include "light/optics/simulated_camera.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

/// The OpenCV form for a camera above the arena that looks straight down.
constexpr const char* kOpenCv = R"({
  "width": 1280, "height": 720,
  "K": [[1250.5, 0, 647.2], [0, 1251.5, 353.7], [0, 0, 1]],
  "dist": [-0.12, 0.02, 0.0004, -0.0003, 0.01],
  "R": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
  "t": [-60, 45, 172],
  "geometry": {"arena_w_cm": 110, "arena_h_cm": 80, "robot_radius_cm": 3.8, "cap_radius_cm": 3.5,
    "cap_plane_z_cm": 5.5, "big_radius_cm": 0.8, "small_radius_cm": 0.5,
    "big_offset_cm": 1.7, "small_offset_cm": -1.6},
  "noise": {"read_noise_dn": 1.5, "shot_gain": 0.03, "blur_px": 0.8, "black_level": 3}
})";

class CameraFile : public testing::Test {
 protected:
  std::filesystem::path written(const std::string& text) {
    auto file = folder_ / "camera.json";
    std::ofstream(file) << text;
    return file;
  }
  CameraCalibration read(const std::string& text) { return readCameraFile(written(text)); }

  std::string refusal(const std::string& text) {
    try {
      static_cast<void>(read(text));
    } catch (const ExperimentError& error) {
      return error.what();
    }
    return "accepted";
  }

  static std::string with(const std::string& old, const std::string& now,
                          std::string text = kOpenCv) {
    return text.replace(text.find(old), old.size(), now);
  }

  static CameraCalibration sample() {
    CameraCalibration calibration;
    calibration.camera = optics::simulatedCamera(1280, 720, 1.2, 0.9);
    calibration.cap.small_radius = 0.1 / 3;
    calibration.cap.big_radius = 0.11 / 3;
    calibration.cap.big_offset = 0.1;
    calibration.cap.cap_radius = 0.5 / 3;
    calibration.cap.robot_radius = 0.52 / 3;
    calibration.imaging = optics::Imaging{0.7, 1.1, 0.02, 1.9};
    calibration.arena_width = 1.1;
    calibration.residual = 0.00042;
    calibration.imaging->gamma = 2.2;
    return calibration;
  }

  TemporaryFolder folder_;
};

TEST_F(CameraFile, OwnFormKeepsEveryNumberToTheLastBit) {
  const CameraCalibration before = sample();

  const CameraCalibration after = read(cameraFileText(before));

  EXPECT_EQ(after.camera, before.camera);
  EXPECT_EQ(after.cap, before.cap);
  EXPECT_EQ(after.imaging, before.imaging);
  EXPECT_EQ(after.arena_width, before.arena_width);
  EXPECT_EQ(after.arena_height, before.arena_height);
  EXPECT_EQ(after.residual, before.residual);
  EXPECT_EQ(after.imaging->gamma, 2.2);
}

TEST_F(CameraFile, UnmeasuredValuesAreLeftOut) {
  CameraCalibration before = sample();
  before.imaging.reset();
  before.residual.reset();

  const CameraCalibration after = read(cameraFileText(before));

  EXPECT_FALSE(after.imaging);
  EXPECT_FALSE(after.residual);

  before.imaging = optics::Imaging{.blur = 1.1};
  EXPECT_FALSE(read(cameraFileText(before)).imaging->gamma);
}

TEST_F(CameraFile, OpenCvFormIsInCentimetres) {
  const CameraCalibration found = read(kOpenCv);

  EXPECT_EQ(found.camera.width, 1280);
  EXPECT_EQ(found.camera.height, 720);
  EXPECT_EQ(found.camera.fx, 1250.5);
  EXPECT_EQ(found.camera.fy, 1251.5);
  EXPECT_EQ(found.camera.cx, 647.2);
  EXPECT_EQ(found.camera.cy, 353.7);
  EXPECT_EQ(found.camera.k1, -0.12);
  EXPECT_EQ(found.camera.k2, 0.02);
  EXPECT_EQ(found.camera.p1, 0.0004);
  EXPECT_EQ(found.camera.p2, -0.0003);
  EXPECT_EQ(found.camera.k3, 0.01);
  EXPECT_EQ(found.camera.rotation[4], -1);
  EXPECT_DOUBLE_EQ(found.camera.translation[0], -0.6);
  EXPECT_DOUBLE_EQ(found.camera.translation[2], 1.72);
  EXPECT_DOUBLE_EQ(found.cap.height, 0.055);
  EXPECT_DOUBLE_EQ(found.cap.robot_radius, 0.038);
  EXPECT_DOUBLE_EQ(found.cap.cap_radius, 0.035);
  EXPECT_DOUBLE_EQ(found.cap.big_radius, 0.008);
  EXPECT_DOUBLE_EQ(found.cap.small_radius, 0.005);
  EXPECT_DOUBLE_EQ(found.cap.big_offset, 0.017);
  EXPECT_DOUBLE_EQ(found.cap.small_offset, -0.016);
  EXPECT_DOUBLE_EQ(found.arena_width, 1.1);
  EXPECT_DOUBLE_EQ(found.arena_height, 0.8);
  ASSERT_TRUE(found.imaging);
  EXPECT_EQ(*found.imaging, (optics::Imaging{0.8, 1.5, 0.03, 3}));
}

TEST_F(CameraFile, OpenCvFormNeedsNoGeometryAndNoNoise) {
  const CameraCalibration found = read(R"({"width": 640, "height": 480,
    "K": [500, 0, 320, 0, 500, 240, 0, 0, 1], "dist": [[0.1, 0, 0, 0]],
    "R": [1, 0, 0, 0, -1, 0, 0, 0, -1], "t": [[-60], [45], [172]]})");

  EXPECT_EQ(found.camera.k1, 0.1);
  EXPECT_EQ(found.camera.k3, 0);
  EXPECT_EQ(found.cap, optics::CapGeometry{});
  EXPECT_EQ(found.arena_width, 1.2);
  EXPECT_FALSE(found.imaging);
}

TEST_F(CameraFile, HasAnIdOfItsContent) {
  // Different files have different ids, equal files the same.
  const std::string first = read(kOpenCv).id;
  const std::string again = read(kOpenCv).id;
  const std::string other = read(std::string(kOpenCv) + "\n").id;

  EXPECT_EQ(first.size(), 12U);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

TEST_F(CameraFile, ErrorsNameFileAndKey) {
  EXPECT_THAT(refusal(with("\"fx\"", "\"fx\"", R"({"fx": 1})")),
              AllOf(HasSubstr("camera.json"), HasSubstr("neither \"form\"")));
  EXPECT_THAT(refusal(with("\"R\"", "\"Q\"")), HasSubstr("camera.json: R: is missing"));
  EXPECT_THAT(refusal(with("1280", "\"wide\"")),
              HasSubstr("width: found \"wide\", expected a number"));
  EXPECT_THAT(refusal(with("1280", "1280.5")), HasSubstr("width: found 1280.5, expected pixels"));
  EXPECT_THAT(refusal(with("1280", "0")), HasSubstr("width: found 0, allowed 1 to"));
  EXPECT_THAT(refusal(with("-60, 45, 172", "-60, 45")),
              HasSubstr("t: found 2 numbers, expected 3"));
  EXPECT_THAT(refusal(with("-60, 45, 172", "-60, null, 172")), HasSubstr("t: found null in it"));
  EXPECT_THAT(refusal(with("[1250.5, 0,", "[1250.5, 2,")), HasSubstr("K: expected [[fx, 0, cx]"));
  EXPECT_THAT(refusal(with("\"big_radius_cm\": 0.8", "\"big_radius_cm\": -1")),
              HasSubstr("geometry.big_radius_cm: found -1, allowed"));
  EXPECT_THAT(refusal(with("\"blur_px\"", "\"gamma\": 0, \"blur_px\"")),
              HasSubstr("noise.gamma: found 0, allowed 0.2 to 5"));
  EXPECT_THAT(refusal(with("\"small_radius_cm\": 0.5", "\"small_radius_cm\": 0.9")),
              HasSubstr("geometry.small_radius_cm: the small circle must be smaller"));
  EXPECT_THAT(refusal(with("\"big_offset_cm\": 1.7", "\"big_offset_cm\": -1.5")),
              HasSubstr("geometry.big_offset_cm: the circles overlap"));
  EXPECT_THAT(refusal(with("\"big_offset_cm\": 1.7", "\"big_offset_cm\": 2.8")),
              HasSubstr("geometry.cap_radius_cm: a circle reaches beyond the cap's rim"));
  EXPECT_THAT(refusal(with("\"big_offset_cm\": 1.7", "\"big_offset_cm\": -5")),
              HasSubstr("geometry.big_offset_cm: the big circle is in front"));
}

TEST_F(CameraFile, ImpossibleLensesAreRefused) {
  EXPECT_THAT(refusal(with("[1250.5, 0,", "[1e12, 0,")),
              HasSubstr("K: of 1e+12 px makes the big circles"));
  EXPECT_THAT(refusal(with("[1250.5, 0,", "[1.5, 0,")), HasSubstr("allowed 0.5 to"));
}

TEST_F(CameraFile, AnotherKindOfFileGivesOneLine) {
  EXPECT_THAT(refusal(std::string(200'000, '[')), HasSubstr("brackets within each other"));
  EXPECT_THAT(refusal(with("1280", "1e999")), HasSubstr("a number beyond 1e308"));
}

TEST_F(CameraFile, UnknownLensModelsAreRefused) {
  EXPECT_THAT(refusal(with("0.01]", "0.01, 0, 0, 0]")), HasSubstr("accepted"));
  EXPECT_THAT(refusal(with("0.01]", "0.01, 0.5, 0, 0]")),
              HasSubstr("dist: number 6 is 0.5, and only k1, k2, p1, p2, k3 are known"));
  EXPECT_THAT(refusal(with("[-0.12, 0.02, 0.0004, -0.0003, 0.01]", "[0.1]")),
              HasSubstr("dist: found 1 numbers"));
}

TEST_F(CameraFile, RotationsAreChecked) {
  EXPECT_THAT(refusal(with("[1, 0, 0]", "[1.1, 0, 0]")), HasSubstr("R: is no rotation"));
  EXPECT_THAT(refusal(with("[1, 0, 0]", "[-1, 0, 0]")), HasSubstr("R: is a mirror image"));
}

TEST_F(CameraFile, AWrongUnitOfLengthIsDetected) {
  EXPECT_THAT(refusal(with("-60, 45, 172", "-0.6, 0.45, 1.72")),
              HasSubstr("t: puts the camera 1.72 cm above the floor, allowed 10.5 to 1000 cm"));
  EXPECT_THAT(refusal(with("-60, 45, 172", "-600, 450, 1720")), HasSubstr("t: puts the camera"));
  EXPECT_THAT(refusal(with("-60, 45, 172", "-60, 45, -172")), HasSubstr("is z of the arena up?"));
}

TEST_F(CameraFile, OwnFormIsCheckedToo) {
  const std::string good = cameraFileText(sample());

  EXPECT_THAT(refusal(with("camera 1", "camera 2", good)),
              HasSubstr("form: found \"active-lab camera 2\", expected \"active-lab camera 1\""));
  EXPECT_THAT(refusal(with("\"k2\"", "\"kk\"", good)), HasSubstr("k2: is missing"));
  EXPECT_THAT(refusal(with("\"height_m\": 0.05", "\"height_m\": \"low\"", good)),
              HasSubstr("cap.height_m: found \"low\""));
  EXPECT_THAT(refusal(with("\"arena\"", "\"areena\"", good)), HasSubstr("arena: is missing"));
}

TEST_F(CameraFile, InvalidJsonNamesTheLine) {
  EXPECT_THAT(refusal("{\n  \"K\": [1,\n  oops\n}"), HasSubstr("camera.json:3: is no valid JSON"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("found array, expected"));
  EXPECT_THAT(refusal(""), HasSubstr("camera.json:1: is no valid JSON"));
}

TEST_F(CameraFile, AMissingFileIsReported) {
  try {
    static_cast<void>(readCameraFile(folder_ / "none.json"));
    FAIL();
  } catch (const ExperimentError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("none.json"),
                                    EndsWith("cannot be read: No such file or directory")));
  }
}

}  // namespace
}  // namespace lab
