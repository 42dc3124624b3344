#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/calibration/camera_file.hpp"
#include "common/experiment/experiment_file.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/film/film_commands.hpp"
#include "runner/film/movie_writer.hpp"
#include "tests/support/file_size_limit.hpp"
#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"
#include "tests/tracker_svc/painted_film.hpp"
#include "tracker_svc/film_reader.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using support::readFile;
using testing::HasSubstr;
using tracker::PaintedFilm;

int linesIn(const std::string& text) { return static_cast<int>(std::ranges::count(text, '\n')); }

/// A folder with a film of five pictures and the calibration of its camera.
class TrackCommand : public testing::Test {
 protected:
  TrackCommand() {
    film("film", 1);
    CameraCalibration calibration;
    calibration.camera = PaintedFilm::settings().camera;
    write("camera.json", cameraFileText(calibration));
    calibration.camera = optics::simulatedCamera(1280, 960, 1.2, 0.9);
    write("other.json", cameraFileText(calibration));
    options_.source = (folder_ / "film").string();
    options_.calibration = folder_ / "camera.json";
    options_.out = folder_ / "poses.csv";
  }

  void film(const std::string& name, double gamma, int dark = 0) const {
    fs::create_directory(folder_ / name);
    PaintedFilm film(gamma);
    for (int k = 0; k < 5; ++k) {
      film.setLight(k < dark ? 0 : 0.8);
      writePng(folder_ / (name + "/f000" + std::to_string(k) + ".png"), film.frame(k));
    }
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// The pictures as a movie with a checksum for every slice.
  [[nodiscard]] fs::path movie() const {
    fs::path file = folder_ / "whole.avi";
    const std::string command = "ffmpeg -v error -framerate 30 -i '" + options_.source +
                                "/f%04d.png' -c:v ffv1 -level 3 -slicecrc 1 '" + file.string() +
                                "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return file;
  }

  /// The message of the exception of track(), or "none".
  [[nodiscard]] std::string problem() const {
    try {
      static_cast<void>(track(options_));
    } catch (const UserError& error) {
      return error.what();
    } catch (const ExperimentError& error) {
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
  TrackOptions options_;
};

TEST_F(TrackCommand, WritesARowForEveryRobotInEveryPicture) {
  EXPECT_EQ(track(options_), kDone);

  const std::string poses = readFile(options_.out);
  EXPECT_EQ(poses.substr(0, poses.find('\n')), "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s");
  EXPECT_EQ(linesIn(poses), 1 + 5 * 3);
  EXPECT_THAT(poses, HasSubstr("\n4,3,"));
  EXPECT_FALSE(fs::exists(options_.out.string() + ".part"));
}

// The folder of a film may come from a stranger.
TEST_F(TrackCommand, ShowsControlCharactersOfNamesAsText) {
  fs::rename(folder_ / "film", folder_ / "film\x1b[2J");
  write("film\x1b[2J/f0009.png", "no picture");
  options_.source = (folder_ / "film\x1b[2J").string();
  options_.out = folder_ / "poses\x1b[2J.csv";
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kClosedEarly);
  EXPECT_THAT(
      testing::internal::GetCapturedStdout(),
      AllOf(HasSubstr("/poses\\x1b[2J.csv\n"),
            HasSubstr("/film\\x1b[2J/f0009.png: is not a picture"), Not(HasSubstr("\x1b"))));
}

TEST_F(TrackCommand, ReadsAFilmWithGamma) {
  film("webcam", 2.2);
  options_.source = (folder_ / "webcam").string();
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("with a gamma of 2.2"),
                    HasSubstr("at 3 of 3 places caps are found only with it"),
                    Not(HasSubstr("from frame"))));
  EXPECT_EQ(linesIn(readFile(options_.out)), 1 + 5 * 3);
}

TEST_F(TrackCommand, ReportsFromWhichFrameOnTheGammaWasKnown) {
  film("late", 2.2, 2);
  for (int k = 4; k >= 0; --k) {  // frames are numbered by the file names
    const std::string name = std::to_string(k) + ".png";
    fs::rename(folder_ / ("late/f000" + name), folder_ / ("late/f001" + name));
  }
  options_.source = (folder_ / "late").string();
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(
      testing::internal::GetCapturedStdout(),
      AllOf(HasSubstr("with a gamma of 2.2"),
            HasSubstr("only from frame 12 on; earlier frames were read with another gamma")));
  EXPECT_THAT(readFile(options_.out), HasSubstr("\n12,3,"));
}

TEST_F(TrackCommand, UsesTheGammaOfTheCalibration) {
  CameraCalibration calibration;
  calibration.camera = PaintedFilm::settings().camera;
  calibration.imaging = optics::Imaging{.gamma = 5};  // with which no cap appears round
  write("wrong.json", cameraFileText(calibration));
  options_.calibration = folder_ / "wrong.json";
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("no robot was found"),
                    HasSubstr("with a gamma of 5, as the calibration says")));
}

TEST_F(TrackCommand, GivesARobotThatReplacesAnotherANewId) {
  fs::create_directory(folder_ / "two");
  PaintedFilm film;
  for (int k = 0; k < 12; ++k) {  // at rest for 3 s, no robot for 2 s, then another one 45 cm away
    std::vector<sim::PaintedRobot> robots;
    if (k < 6) robots = {{0.62, 0.54, 1}};
    if (k >= 10) robots = {{0.17, 0.54, 1}};
    writePng(folder_ / fmt::format("two/f{:04}.png", k), film.paint(robots, k));
  }
  options_.source = (folder_ / "two").string();
  options_.fps = 2;

  EXPECT_EQ(track(options_), kDone);

  EXPECT_THAT(readFile(options_.out), AllOf(HasSubstr("\n5,1,"), HasSubstr("\n10,2,")));
}

/// The camera rotated about its own x axis.
optics::CameraParameters tilted(optics::CameraParameters camera, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const auto turn = [&](double& y, double& z) {
    const double before = y;
    y = c * before - s * z;
    z = s * before + c * z;
  };
  for (std::size_t k = 0; k < 3; ++k) turn(camera.rotation[3 + k], camera.rotation[6 + k]);
  turn(camera.translation[1], camera.translation[2]);
  return camera;
}

TEST_F(TrackCommand, WarnsOfACalibrationThatDoesNotFitThePoses) {
  fs::create_directory(folder_ / "many");
  std::vector<sim::PaintedRobot> robots;
  for (int i = 0; i < 20; ++i) {
    robots.push_back({0.12 + 0.24 * (i % 5), 0.1 + 0.23 * (i / 5), 1.0 * i});
  }
  PaintedFilm film;
  for (int k = 0; k < 2; ++k) {
    writePng(folder_ / fmt::format("many/f{:04}.png", k), film.paint(robots, k));
  }
  options_.source = (folder_ / "many").string();
  options_.force = true;
  const auto output_with = [&](const CameraCalibration& calibration) {
    write("camera.json", cameraFileText(calibration));
    testing::internal::CaptureStdout();
    EXPECT_EQ(track(options_), kDone);
    return testing::internal::GetCapturedStdout();
  };
  CameraCalibration good;
  good.camera = PaintedFilm::settings().camera;
  EXPECT_THAT(output_with(good), testing::Not(HasSubstr("warning")));

  CameraCalibration tilt = good;
  tilt.camera = tilted(good.camera, 0.02);
  EXPECT_THAT(output_with(tilt), AllOf(HasSubstr("warning  the calibration does not fit"),
                                       HasSubstr("%/m along x and y"), Not(HasSubstr("outside"))));

  CameraCalibration small = good;
  small.arena_width = 0.6;
  EXPECT_THAT(output_with(small),
              HasSubstr("warning  40.0 % of the poses are outside the arena of 60 x "
                        "90 cm, by up to 48.0 cm"));
}

TEST_F(TrackCommand, WarnsOfVaryingSpacingEvenWithTooFewPlacesForAFit) {
  CameraCalibration calibration;
  calibration.camera = tilted(PaintedFilm::settings().camera, 0.1);
  write("camera.json", cameraFileText(calibration));
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("the distance of the circles varies by"),
                    testing::Not(HasSubstr("does not fit"))));
}

TEST_F(TrackCommand, ReadsEverySecondPictureOnRequest) {
  options_.every = 2;

  EXPECT_EQ(track(options_), kDone);

  const std::string poses = readFile(options_.out);
  EXPECT_EQ(linesIn(poses), 1 + 3 * 3);
  EXPECT_THAT(poses, testing::Not(HasSubstr("\n1,")));
}

TEST_F(TrackCommand, ReportsTheAssumedRateOfPicturesWithoutTimes) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              HasSubstr("30 pictures per second are assumed: set --fps"));
  EXPECT_THAT(readFile(options_.out), HasSubstr(",0.133333\n"));

  options_.fps = 2;
  options_.force = true;
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::Not(HasSubstr("--fps")));
  EXPECT_THAT(readFile(options_.out), HasSubstr(",2.000000\n"));
}

TEST_F(TrackCommand, RefusesFpsBesideATableOfTimes) {
  write("film/frames.csv", "frame,t_s\n0,0\n1,0.5\n2,1\n3,1.5\n4,2\n");
  options_.fps = 10;
  EXPECT_THAT(problem(), HasSubstr("found --fps and the times of frames.csv"));
  EXPECT_FALSE(fs::exists(options_.out));
}

// The times of a slow-motion movie are those of playback, not of recording.
TEST_F(TrackCommand, UsesTheRateOfTheUserForAMovie) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  options_.source = movie().string();
  options_.fps = 200;
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("those of 200 frames per second"));
  EXPECT_THAT(readFile(options_.out), HasSubstr(",0.005000\n"));
}

TEST_F(TrackCommand, ReplacesFilesOnlyWithForce) {
  write("poses.csv", "kept");

  EXPECT_THAT(problem(), HasSubstr("--force"));
  EXPECT_EQ(readFile(options_.out), "kept");

  options_.force = true;
  EXPECT_EQ(track(options_), kDone);
  EXPECT_EQ(linesIn(readFile(options_.out)), 16);
}

/// The folder may come from a stranger.
TEST_F(TrackCommand, FollowsNoLinkWhereItWrites) {
  write("kept", "kept");
  fs::create_symlink(folder_ / "kept", options_.out.string() + ".part");

  EXPECT_EQ(track(options_), kDone);

  EXPECT_EQ(readFile(folder_ / "kept"), "kept");
  EXPECT_EQ(linesIn(readFile(options_.out)), 16);
}

TEST_F(TrackCommand, RefusesToOverwriteItsInputsAndOutputs) {
  const std::string calibration = readFile(options_.calibration);
  options_.force = true;
  options_.out = options_.calibration;
  EXPECT_THAT(problem(), HasSubstr("is named as --calibration and as --out"));
  EXPECT_EQ(readFile(options_.calibration), calibration);

  options_.out = folder_ / "poses.csv";
  options_.overlay = folder_ / "film/../poses.csv";
  EXPECT_THAT(problem(), HasSubstr("is named as --out and as --overlay"));
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(TrackCommand, KeepsThePosesIfTheOverlayCannotBeWritten) {
  options_.overlay = folder_ / "sheet.png";
  {
    const FileSizeLimit full(10'000);  // more than the poses need, and less than the sheet
    EXPECT_EQ(track(options_), kClosedEarly);
  }

  EXPECT_EQ(linesIn(readFile(options_.out)), 16);
}

TEST_F(TrackCommand, NamesBothSizesIfTheCalibrationHasAnother) {
  options_.calibration = folder_ / "other.json";

  const std::string message = problem();

  EXPECT_THAT(message, HasSubstr("640 x 480"));
  EXPECT_THAT(message, HasSubstr("1280 x 960"));
  EXPECT_THAT(message, HasSubstr("other.json"));
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(TrackCommand, ReportsThatPlayersRotateAMovie) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const fs::path turned = folder_ / "turned.mov";
  const std::string plain = "'" + turned.string() + ".mov'";
  const std::string target = " -c copy -y '" + turned.string() + "'";
  // Only a copied stream keeps the rotation. ffmpeg 5 knows the second way only, ffmpeg 7 the
  // first.
  const std::string command = "ffmpeg -v error -i '" + movie().string() + "' -c:v png " + plain +
                              " && { ffmpeg -v quiet -display_rotation 90 -i " + plain + target +
                              " || ffmpeg -v error -i " + plain + " -metadata:s:v rotate=90" +
                              target + "; }";
  ASSERT_EQ(std::system(command.c_str()), 0);
  options_.source = turned.string();
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("players rotate these pictures (rotation "), HasSubstr("90)")));

  options_.calibration = folder_ / "other.json";
  options_.force = true;
  EXPECT_THAT(problem(), HasSubstr("640 x 480 px (as stored; players rotate them, by rot"));
}

TEST_F(TrackCommand, ReportsThatPlayersRotatePictures) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  fs::create_directory(folder_ / "phone");
  const fs::path plain = folder_ / "plain.jpg";
  const std::string command =
      "ffmpeg -v error -i '" + options_.source + "/f0000.png' -q:v 2 '" + plain.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  options_.source = plain.string();
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::Not(HasSubstr("rotate")));

  // An EXIF segment with one tag, Orientation (0x0112) = 6, after the first two bytes.
  constexpr std::string_view kExif{
      "\xFF\xE1\0\x22"
      "Exif\0\0"
      "MM\0*\0\0\0\x08"
      "\0\x01"
      "\x01\x12\0\x03\0\0\0\x01\0\x06\0\0"
      "\0\0\0\0",
      36};
  const std::string bytes = readFile(plain);
  write("phone/f0.jpg", bytes.substr(0, 2) + std::string(kExif) + bytes.substr(2));
  options_.source = (folder_ / "phone").string();
  options_.force = true;
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              HasSubstr("players rotate these pictures (EXIF orientation 6)"));
}

TEST_F(TrackCommand, ReportsMissingFiles) {
  options_.calibration = folder_ / "none.json";
  EXPECT_THAT(problem(), HasSubstr("none.json"));

  options_.calibration = folder_ / "camera.json";
  options_.source = (folder_ / "nowhere").string();
  EXPECT_THAT(problem(), HasSubstr("nowhere"));

  fs::create_directory(folder_ / "empty");
  options_.source = (folder_ / "empty").string();
  EXPECT_THAT(problem(), HasSubstr("empty"));
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(TrackCommand, NamesThePicturesThatItCannotRead) {
  fs::create_directory(folder_ / "scans");
  for (const char* name : {"scans/a1.tif", "scans/a2.TIF", "scans/notes.txt"}) write(name, "x");
  options_.source = (folder_ / "scans").string();
  EXPECT_THAT(problem(),
              AllOf(HasSubstr("found no pictures"), HasSubstr("but 2 of .tif; convert")));
}

TEST_F(TrackCommand, ReportsFramesWithMoreCapsThanRobots) {
  options_.robots = 1;
  testing::internal::CaptureStdout();
  EXPECT_EQ(track(options_), kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              HasSubstr("5 of 5 frames showed more caps than --robots says; 10 poses were left "));
}

TEST_F(TrackCommand, RefusesATextFileWithTheNameOfAMovie) {
  write("notes.avi", "these are notes\n");
  options_.source = (folder_ / "notes.avi").string();

  EXPECT_THAT(problem(), HasSubstr("notes.avi"));
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(TrackCommand, DrawsAContactSheet) {
  options_.overlay = folder_ / "sheet.png";

  EXPECT_EQ(track(options_), kDone);

  EXPECT_EQ(readFile(options_.overlay).substr(1, 3), "PNG");
  EXPECT_THAT(problem(), HasSubstr("--force"));
}

TEST_F(TrackCommand, RefusesASheetInTheFolderOfThePictures) {
  options_.overlay = folder_ / "film/sheet.png";

  EXPECT_THAT(problem(), HasSubstr("would be read as one of the pictures"));

  EXPECT_FALSE(fs::exists(options_.overlay));
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(TrackCommand, DrawsAFolderOfPictures) {
  options_.overlay = folder_ / "drawn";

  EXPECT_EQ(track(options_), kDone);

  EXPECT_TRUE(fs::exists(folder_ / "drawn/f000004.jpg"));
}

TEST_F(TrackCommand, DrawsAMovie) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  options_.overlay = folder_ / "drawn.mkv";

  EXPECT_EQ(track(options_), kDone);
  ASSERT_GT(fs::file_size(options_.overlay), 1000U);

  const std::unique_ptr<FilmReader> drawn = FilmReader::open(options_.overlay.string());
  int frames = 0;
  for (CameraFrame frame; drawn->next(frame); ++frames) {
    EXPECT_EQ(frame.grey.width, PaintedFilm::kWidth);
  }
  EXPECT_EQ(frames, 5);
}

TEST_F(TrackCommand, KeepsThePosesOfATruncatedMovie) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const fs::path whole = movie();
  fs::copy_file(whole, folder_ / "cut.avi");
  fs::resize_file(folder_ / "cut.avi", fs::file_size(whole) * 6 / 10);
  options_.source = (folder_ / "cut.avi").string();

  EXPECT_EQ(track(options_), kClosedEarly);

  const int rows = linesIn(readFile(options_.out)) - 1;
  EXPECT_GE(rows, 3);
  EXPECT_LT(rows, 15);
}

TEST_F(TrackCommand, MarksAMovieWithADamagedFrame) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const fs::path film = movie();
  std::fstream bytes(film, std::ios::binary | std::ios::in | std::ios::out);
  bytes.seekp(static_cast<std::streamoff>(fs::file_size(film) / 2));
  bytes << std::string(200, 'x');
  bytes.close();
  options_.source = film.string();

  EXPECT_EQ(track(options_), kClosedEarly);
}

}  // namespace
}  // namespace lab::runner
