#include "tracker_svc/detector/sync_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "light/field/image.hpp"
#include "light/optics/simulated_camera.hpp"
#include "sim_svc/camera_painter.hpp"

namespace lab::tracker {
namespace {

constexpr double kPatch = 0.015;    // [m]
constexpr double kTurnEvery = 0.5;  // [s]
constexpr double kFrame = 0.0331;   // [s] not a divisor of the period

/// The painted camera with a sync patch that changes every half second.
class SyncReaderTest : public testing::Test {
 protected:
  static sim::PainterSettings settings() {
    sim::PainterSettings settings;
    settings.camera = optics::simulatedCamera(1280, 720, 1.20, 0.90);
    return settings;
  }

  static int syncAt(double when) { return static_cast<int>(std::floor(when / kTurnEvery)) % 2; }

  std::vector<light::Layer> layers(double when) const {
    std::vector<light::Layer> all = field(when);
    light::Layer patch;
    patch.kind = light::LayerKind::kGrid;
    auto pixel = std::make_shared<light::Image>();
    pixel->columns = pixel->rows = 1;
    pixel->grey = {static_cast<std::uint8_t>(has_patch && syncAt(when) == 1 ? 255 : 0)};
    patch.pixels = pixel;
    patch.x = patch.y = kPatch / 2;
    patch.size = patch.inner = kPatch;
    patch.intensity = 1;
    all.push_back(patch);
    return all;
  }

  std::vector<light::Layer> field(double when) const {
    const bool changed = when >= change_at;
    light::Layer uniform;
    uniform.intensity = changed ? 0.9 : 0.2;
    return {uniform};
  }

  /// Runs to `end` [s]; counts how the pictures of known states are read.
  void run(double end) {
    for (; time < end; time += kFrame) {
      const int sync = syncAt(time);
      if (sync != told) {
        told = sync;
        reader.reportChange(std::floor(time / kTurnEvery) * kTurnEvery, sync,
                            time >= change_at ? 2 : 1, still);
      }
      const int light = syncAt(time) + (time >= change_at ? 2 : 0);
      if (light != shown) painter.setLight({layers(time), {}, 1});
      shown = light;
      painter.paint({}, number++, picture.pixels);
      const std::optional<SyncReading> reading = reader.look(picture.view(), time);
      if (!reading) continue;
      ++answers;
      right += reading->sync == sync ? 1 : 0;
      wrong += reading->sync == 1 - sync ? 1 : 0;
    }
  }

  bool has_patch = true;
  bool still = true;
  double change_at = 1e9;
  double time = 0;
  int told = -1;
  int shown = -1;
  std::int64_t number = 0;
  int answers = 0, right = 0, wrong = 0;
  sim::CameraPainter painter{settings()};
  optics::GreyImage picture{1280, 720};
  SyncReader reader{optics::CameraModel(settings().camera)};
};

TEST_F(SyncReaderTest, FindsThePatchAnywhereAndReadsEveryPicture) {
  run(3.0);
  EXPECT_GT(answers, 30);
  EXPECT_EQ(right, answers);
}

TEST_F(SyncReaderTest, ContinuesWhenTheLightAroundThePatchChanges) {
  change_at = 2.5;
  run(5.0);
  EXPECT_GT(answers, 90);
  EXPECT_EQ(right, answers);
}

TEST_F(SyncReaderTest, ReturnsNothingWithoutAPatch) {
  has_patch = false;
  run(3.0);
  EXPECT_EQ(answers, 0);
}

TEST_F(SyncReaderTest, LearnsNothingWhileOtherLightMoves) {
  still = false;
  run(3.0);
  EXPECT_EQ(answers, 0);
}

TEST_F(SyncReaderTest, DoesNotMistakeAChangeOfAllLightForThePatch) {
  has_patch = false;
  change_at = 1.0;
  run(3.0);
  EXPECT_EQ(answers, 0);
}

}  // namespace
}  // namespace lab::tracker
