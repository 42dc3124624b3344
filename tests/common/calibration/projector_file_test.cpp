#include "common/calibration/projector_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/experiment/experiment_file.hpp"
#include "light/optics/simulated_projector.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ProjectorCalibration sample() {
  // A pinhole from four corners, as from a calibration by hand.
  ProjectorCalibration calibration;
  optics::CameraParameters& lens = calibration.lens;
  lens.width = 1920;
  lens.height = 1080;
  lens.fx = 3100.5;
  lens.fy = 2300.25;
  lens.cx = 959.5;
  lens.cy = 539.5;
  lens.k1 = 0.3;
  lens.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
  lens.translation = {-0.6, 0.45, 2.1};
  calibration.method = "camera";
  calibration.camera_id = "0123456789ab";
  calibration.residual = 1e-4;
  calibration.accuracy = 2e-4;
  calibration.worst = 3e-4;
  calibration.covered = 0.97;
  return calibration;
}

class ProjectorFile : public testing::Test {
 protected:
  fs::path written(const std::string& text) {
    const fs::path path = folder_ / "projector.json";
    std::ofstream(path) << text;
    return path;
  }

  /// The error message of a file after `change`.
  std::string refusal(const std::function<void(nlohmann::json&)>& change) {
    nlohmann::json file = nlohmann::json::parse(projectorFileText(sample()));
    change(file);
    return refusalOf(file.dump());
  }

  std::string refusalOf(const std::string& text) {
    try {
      static_cast<void>(readProjectorFile(written(text)));
    } catch (const ExperimentError& error) {
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

TEST_F(ProjectorFile, ReadsWhatItWrote) {
  const ProjectorCalibration wrote = sample();
  const ProjectorCalibration read = readProjectorFile(written(projectorFileText(wrote)));
  EXPECT_EQ(read.lens, wrote.lens);
  EXPECT_EQ(read.method, wrote.method);
  EXPECT_EQ(read.camera_id, wrote.camera_id);
  EXPECT_EQ(read.residual, wrote.residual);
  EXPECT_EQ(read.accuracy, wrote.accuracy);
  EXPECT_EQ(read.worst, wrote.worst);
  EXPECT_EQ(read.covered, wrote.covered);
  EXPECT_EQ(read.id.size(), 12U);
  EXPECT_EQ(projectorFileText(read), projectorFileText(wrote));
}

TEST_F(ProjectorFile, OneClearErrorForEachProblem) {
  EXPECT_THAT(refusalOf("{"), HasSubstr("projector.json:1: is no valid JSON"));
  EXPECT_THAT(refusalOf("{}"), HasSubstr("is no projector calibration"));
  EXPECT_THAT(
      refusal([](auto& file) { file["form"] = "active-lab camera 1"; }),
      HasSubstr("form: found \"active-lab camera 1\", expected \"active-lab projector 1\""));
  EXPECT_THAT(refusal([](auto& file) { file.erase("fx_px"); }),
              HasSubstr("fx_px: is missing (docs/calibration.md"));
  EXPECT_THAT(refusal([](auto& file) { file["fy_px"] = -3; }), HasSubstr("fy_px: found -3"));
  EXPECT_THAT(refusal([](auto& file) { file["fx_px"] = 0; }), HasSubstr("fx_px: found 0"));
  EXPECT_THAT(refusal([](auto& file) { file["rotation"][0] = 2; }), HasSubstr("is no rotation"));
  EXPECT_THAT(refusal([](auto& file) { file["k1"] = -9; }), HasSubstr("is of no lens"));
  EXPECT_THAT(refusal([](auto& file) { file["arena"]["width_m"] = "wide"; }),
              HasSubstr("arena.width_m: found \"wide\", expected a number"));
  try {
    static_cast<void>(readProjectorFile(folder_ / "none.json"));
    FAIL();
  } catch (const ExperimentError& error) {
    EXPECT_THAT(error.what(), HasSubstr("none.json: cannot be read"));
  }
}

TEST_F(ProjectorFile, AMirroredPictureIsAllowed) {
  ProjectorCalibration mirrored = sample();
  mirrored.lens.fx = -mirrored.lens.fx;
  EXPECT_EQ(refusalOf(projectorFileText(mirrored)), "accepted");
}

TEST_F(ProjectorFile, IsUsedOnlyForItsPictureAndArena) {
  Experiment experiment;
  EXPECT_TRUE(activeProjectorCalibration(experiment, (folder_ / ""), 640, 480).model.isNominal());
  EXPECT_EQ(activeProjectorCalibration(experiment, (folder_ / ""), 640, 480).id, "");
  written(projectorFileText(sample()));
  experiment.projector.calibration = "projector.json";
  const ActiveProjectorCalibration found =
      activeProjectorCalibration(experiment, (folder_ / ""), 1920, 1080);
  EXPECT_FALSE(found.model.isNominal());
  EXPECT_EQ(found.id.size(), 12U);
  EXPECT_NO_THROW(checkProjectorFile(experiment, (folder_ / "")));
  try {
    static_cast<void>(activeProjectorCalibration(experiment, (folder_ / ""), 1280, 800));
    FAIL();
  } catch (const ExperimentError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("found a calibration of 1920 x 1080 pixels, expected 1280 x 800"));
  }
  experiment.arena_width = 1.3;
  EXPECT_THROW(checkProjectorFile(experiment, (folder_ / "")), ExperimentError);
  experiment.arena_width = 1.2;
  experiment.projector.width = 800;
  EXPECT_THROW(checkProjectorFile(experiment, (folder_ / "")), ExperimentError);
  // The size of a display is not known before it is opened.
  experiment.projector.display = "1";
  EXPECT_NO_THROW(checkProjectorFile(experiment, (folder_ / "")));
}

}  // namespace
}  // namespace lab
