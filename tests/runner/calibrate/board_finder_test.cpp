#include "runner/calibrate/board_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include "common/math/random.hpp"
#include "light/optics/simulated_camera.hpp"
#include "light/photometry/camera_response.hpp"

namespace lab::runner::board_finder_test {
namespace {

using calibration::BoardSpec;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

/// The camera parameters in the frame of a board at a pose above the arena.
optics::CameraParameters seenFromBoard(const optics::CameraParameters& camera, double x, double y,
                                       double z, double tilt, double turn) {
  optics::CameraParameters p = camera;
  const Eigen::Matrix3d rotation = Eigen::Map<const RowMajor>(camera.rotation.data());
  const Eigen::Matrix3d pose = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  Eigen::Map<RowMajor>(p.rotation.data()) = rotation * pose;
  Eigen::Map<Eigen::Vector3d>(p.translation.data()) += rotation * Eigen::Vector3d(x, y, z);
  return p;
}

/// White paper with black discs on grey, blurred and noisy. The board's first disc is at (0, 0).
optics::GreyImage paintBoard(const optics::CameraParameters& from_board, const BoardSpec& board,
                             Random& random) {
  constexpr int kFine = 4;           // samples per pixel and axis
  constexpr double kBlur = 0.75;     // px
  constexpr int kReach = 3 * kFine;  // of the blur kernel
  const optics::CameraModel model(from_board);
  const double width = board.spacing * (board.columns - 1);
  const double height = board.spacing * (board.rows - 1);
  double left = kWidth, right = 0, top = kHeight, bottom = 0;
  for (const double x : {-board.spacing, width + board.spacing}) {
    for (const double y : {-board.spacing, height + board.spacing}) {
      const optics::Pixel at = model.project(x, y, 0);
      left = std::min(left, at.x);
      right = std::max(right, at.x);
      top = std::min(top, at.y);
      bottom = std::max(bottom, at.y);
    }
  }
  const int x0 = std::max(0, static_cast<int>(left) - 6);
  const int y0 = std::max(0, static_cast<int>(top) - 6);
  const int columns = kFine * (std::min(kWidth, static_cast<int>(right) + 6) - x0);
  const int rows = kFine * (std::min(kHeight, static_cast<int>(bottom) + 6) - y0);
  Eigen::MatrixXd fine(rows, columns);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const auto at =
          model.toPlane({x0 + (i + 0.5) / kFine - 0.5, y0 + (j + 0.5) / kFine - 0.5}, 0);
      const double u = at->x / board.spacing;
      const double v = at->y / board.spacing;
      const bool paper = u > -1 && v > -1 && u < board.columns && v < board.rows;
      const double nearest_u = std::clamp(std::round(u), 0.0, board.columns - 1.0);
      const double nearest_v = std::clamp(std::round(v), 0.0, board.rows - 1.0);
      const bool disc =
          std::hypot(u - nearest_u, v - nearest_v) * board.spacing < board.discRadius();
      fine(j, i) = disc ? 18 : paper ? 190 : 90;
    }
  }
  Eigen::VectorXd kernel(2 * kReach + 1);
  for (int k = -kReach; k <= kReach; ++k) {
    kernel[k + kReach] = std::exp(-0.5 * std::pow(k / (kBlur * kFine), 2));
  }
  kernel /= kernel.sum();
  const auto blurred = [&kernel](const Eigen::MatrixXd& from) {
    Eigen::MatrixXd out = from;
    for (Eigen::Index j = kReach; j < from.rows() - kReach; ++j) {
      out.row(j) = kernel.transpose() * from.middleRows(j - kReach, 2 * kReach + 1);
    }
    return out;
  };
  fine = blurred(fine);
  fine = blurred(fine.transpose().eval()).transpose().eval();
  optics::GreyImage picture(kWidth, kHeight, 90);
  for (int j = 0; j < rows / kFine; ++j) {
    for (int i = 0; i < columns / kFine; ++i) {
      const double value = fine.block<kFine, kFine>(kFine * j, kFine * i).mean();
      const double noisy = value + 2 * random.normal();
      picture.row(y0 + j)[x0 + i] = static_cast<std::uint8_t>(std::clamp(noisy + 0.5, 0.0, 255.0));
    }
  }
  return picture;
}

const BoardSpec kBoard{9, 6, 0.035};

TEST(BoardFinder, FindsEveryDiscOfATiltedBoard) {
  Random random(1);
  const optics::CameraParameters camera = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
  const optics::CameraParameters from_board = seenFromBoard(camera, 0.4, 0.4, 0.1, 0.4, 0.3);
  const auto view = findBoard(paintBoard(from_board, kBoard, random).view(), kBoard);
  ASSERT_TRUE(view);
  ASSERT_EQ(view->points.size(), 54U);
  // The grid may start at any corner of the board: rotated by 180 degrees, or mirrored.
  const optics::CameraModel model(from_board);
  double best = 1e9;
  for (const bool flip_x : {false, true}) {
    for (const bool flip_y : {false, true}) {
      double sum = 0;
      for (const calibration::BoardPoint& point : view->points) {
        const optics::Pixel at = model.project(flip_x ? 8 * kBoard.spacing - point.x : point.x,
                                               flip_y ? 5 * kBoard.spacing - point.y : point.y, 0);
        sum += std::hypot(at.x - point.pixel.x, at.y - point.pixel.y);
      }
      best = std::min(best, sum / 54);
    }
  }
  // The centre of the ellipse differs from that of the disc by some hundredths of a pixel.
  EXPECT_LT(best, 0.1);
}

TEST(BoardFinder, ReadsPicturesWithVideoGamma) {
  Random random(3);
  const optics::CameraParameters camera = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
  const optics::CameraParameters from_board = seenFromBoard(camera, 0.4, 0.4, 0.1, 0.4, 0.3);
  optics::GreyImage picture = paintBoard(from_board, kBoard, random);
  const auto linear = findBoard(picture.view(), kBoard);
  const optics::CameraResponse webcam(optics::kVideoGamma);
  for (std::uint8_t& grey : picture.pixels) {
    grey = static_cast<std::uint8_t>(std::lround(webcam.grey(grey)));
  }
  const auto encoded = findBoard(picture.view(), kBoard);
  ASSERT_TRUE(linear && encoded);
  ASSERT_EQ(encoded->points.size(), 54U);
  for (std::size_t i = 0; i < 54; ++i) {
    const optics::Pixel& one = linear->points[i].pixel;
    const optics::Pixel& other = encoded->points[i].pixel;
    EXPECT_LT(std::hypot(one.x - other.x, one.y - other.y), 0.02) << i;
  }
}

TEST(BoardFinder, RejectsAPartlyVisibleBoard) {
  Random random(2);
  const optics::CameraParameters camera = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
  const optics::CameraParameters from_board = seenFromBoard(camera, 0.4, 0.4, 0, 0, 0);
  optics::GreyImage picture = paintBoard(from_board, kBoard, random);
  ASSERT_TRUE(findBoard(picture.view(), kBoard));
  EXPECT_FALSE(findBoard(picture.view(), {9, 7, 0.035}));
  const optics::Pixel covered = optics::CameraModel(from_board).project(0.07, 0.07, 0);
  for (int y = -20; y < 20; ++y) {
    for (int x = -20; x < 20; ++x) {
      picture.row(static_cast<int>(covered.y) + y)[static_cast<int>(covered.x) + x] = 120;
    }
  }
  EXPECT_FALSE(findBoard(picture.view(), kBoard));
  EXPECT_FALSE(findBoard(optics::GreyImage(kWidth, kHeight, 90).view(), kBoard));
}

TEST(BoardFinder, FindsBoardsGoodEnoughForACalibration) {
  Random random(3);
  const optics::CameraParameters camera = optics::simulatedCamera(kWidth, kHeight, 1.2, 0.9);
  const optics::CameraModel truth(camera);
  calibration::CameraObservations observations;
  observations.width = kWidth;
  observations.height = kHeight;
  observations.corner_sigma = 0.1;
  constexpr optics::Place kCorners[] = {{0, 0}, {1.2, 0}, {1.2, 0.9}, {0, 0.9}};
  for (std::size_t i = 0; i < 4; ++i) {
    observations.corners[i] = truth.project(kCorners[i].x, kCorners[i].y, 0);
  }
  for (int i = 0; i < 10; ++i) {
    const double turn = 2 * std::numbers::pi * i / 10;
    const auto from_board =
        seenFromBoard(camera, 0.35 + 0.5 * random.uniform(), 0.3 + 0.3 * random.uniform(), 0.15,
                      i % 3 == 0 ? 0.1 : 0.5, turn);
    const auto view = findBoard(paintBoard(from_board, kBoard, random).view(), kBoard);
    if (view) observations.boards.push_back(*view);
  }
  ASSERT_GE(observations.boards.size(), 6U);
  const calibration::CameraFit fit = calibration::fitCamera(observations);
  ASSERT_EQ(fit.refusal, "");
  EXPECT_LT(fit.board_residual, 0.04);
  const optics::CameraModel found(fit.camera);
  for (const calibration::PlaceError& place : fit.map.places) {
    const auto seen = found.toPlane(truth.project(place.x, place.y, 0.05), 0.05);
    ASSERT_TRUE(seen);
    EXPECT_LT(std::hypot(seen->x - place.x, seen->y - place.y), 4 * place.frame);
  }
  EXPECT_LT(fit.map.rms, 0.4e-3);
  RecordProperty("board_residual", std::to_string(fit.board_residual));
  RecordProperty("claimed_um", std::to_string(1e6 * fit.map.rms));
}

TEST(Board, IsParsedFromText) {
  const BoardSpec board = calibration::boardFrom("10x7,2.5");
  EXPECT_EQ(board.columns, 10);
  EXPECT_EQ(board.rows, 7);
  EXPECT_DOUBLE_EQ(board.spacing, 0.025);
  for (const char* wrong : {"", "9x6", "9,6,3", "9x6,3 ", "3x6,3", "9x6,0", "9x6,nan", "99x6,3"}) {
    EXPECT_THROW(static_cast<void>(calibration::boardFrom(wrong)), std::invalid_argument) << wrong;
  }
}

TEST(Board, DrawingContainsAllDiscs) {
  const std::string svg = calibration::boardSvg(kBoard);
  std::size_t discs = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos;
       at = svg.find("<circle", at + 1)) {
    ++discs;
  }
  EXPECT_EQ(discs, 54U);
  EXPECT_THAT(svg, testing::HasSubstr("width=\"350mm\" height=\"245mm\""));
}

}  // namespace
}  // namespace lab::runner::board_finder_test
