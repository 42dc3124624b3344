// A full-screen window in a virtual X server, compared with the contents of the screen.
#include "projector_ctl/display/display_sdl.hpp"

#include <SDL2/SDL.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "light/field/image.hpp"
#include "light/field/raster.hpp"
#include "light/optics/simulated_projector.hpp"
#include "projector_ctl/display/screen.hpp"
#include "tests/support/virtual_x.hpp"

namespace lab::projector {
namespace {

using light::Blend;
using light::Field;
using light::Layer;
using light::LayerKind;
using testing::HasSubstr;

constexpr int kColumns = 1920;
constexpr int kRows = 1080;
constexpr double kWidth = 1.2;
constexpr double kHeight = 0.9;

Field edges() {
  return {{Layer{.intensity = 0.1},
           Layer{.kind = LayerKind::kHalfPlane, .x = 0.61, .y = 0.4, .angle = 0.7, .intensity = 1},
           Layer{.kind = LayerKind::kChecker,
                 .blend = Blend::kMultiply,
                 .x = 0.3,
                 .y = 0.3,
                 .angle = 0.2,
                 .size = 0.17,
                 .intensity = 1,
                 .intensity2 = 0.5},
           Layer{.kind = LayerKind::kDisk, .x = 0.9, .y = 0.3, .size = 0.1, .intensity = 0.7},
           Layer{.kind = LayerKind::kRing,
                 .x = 0.4,
                 .y = 0.6,
                 .size = 0.15,
                 .inner = 0.1,
                 .intensity = 0}},
          {},
          1};
}

Field gradients() {
  Field field{{Layer{.kind = LayerKind::kLinearGradient,
                     .x = 0.6,
                     .y = 0.45,
                     .angle = 0.3,
                     .size = 1.1,
                     .intensity = 0,
                     .intensity2 = 1},
               Layer{.kind = LayerKind::kRadialGradient,
                     .blend = Blend::kMultiply,
                     .x = 0.5,
                     .y = 0.5,
                     .size = 0.6,
                     .inner = 0.1,
                     .intensity = 1,
                     .intensity2 = 0.3},
               Layer{.kind = LayerKind::kWave,
                     .blend = Blend::kAdd,
                     .angle = 1,
                     .size = 0.2,
                     .intensity = 0.2,
                     .intensity2 = 0,
                     .phase = 2}},
              {Layer{.kind = LayerKind::kNoise, .size = 0.1, .intensity = 1, .seed = 3}},
              0.4};
  return field;
}

Field images() {
  auto image = std::make_shared<light::Image>();
  image->columns = 40;
  image->rows = 30;
  for (int i = 0; i < 1200; ++i) image->grey.push_back(static_cast<std::uint8_t>(i * 37 % 256));
  return {{Layer{.intensity = 0.4}, Layer{.kind = LayerKind::kGrid,
                                          .x = 0.5,
                                          .y = 0.5,
                                          .angle = 0.4,
                                          .size = 0.6,
                                          .inner = 0.4,
                                          .intensity = 1,
                                          .pixels = image}},
          {},
          1};
}

class WindowTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { server_ = std::make_unique<VirtualX>(kColumns, kRows); }
  static void TearDownTestSuite() { server_.reset(); }

  void SetUp() override {
    if (!server_->runs()) GTEST_SKIP() << "Xvfb is not installed (package xvfb)";
  }

  std::unique_ptr<Screen> open(const optics::ProjectorModel& model) {
    Screen::Setup setup;
    setup.open = [] { return openSdlDisplay("0"); };
    setup.place = [model](int, int) { return Screen::Placement{model, "id"}; };
    setup.safe_field = {{Layer{.intensity = 0.2}}, {}, 1};
    setup.now = [] {
      return std::chrono::duration_cast<std::chrono::microseconds>(
                 std::chrono::steady_clock::now().time_since_epoch())
          .count();
    };
    auto screen = std::make_unique<Screen>(std::move(setup));
    screen->open();
    return screen;
  }

  static optics::ProjectorModel nominal() { return {kWidth, kHeight, kColumns, kRows}; }

  /// Largest difference between the screen and these grey values.
  static int worst(const std::vector<std::uint8_t>& wanted) {
    const std::vector<unsigned> found = server_->screen();
    EXPECT_EQ(found.size(), wanted.size());
    int most = 0;
    for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i) {
      for (const unsigned shift : {0U, 8U, 16U}) {
        most = std::max(most, std::abs(static_cast<int>(found[i] >> shift & 0xFF) - wanted[i]));
      }
    }
    return most;
  }

  static std::vector<std::uint8_t> raster(const Field& field) {
    return light::toGrey(light::rasterise(field, kWidth, kHeight, kColumns, kRows));
  }

  static void push(SDL_Event event) { ASSERT_EQ(SDL_PushEvent(&event), 1); }

  static std::unique_ptr<VirtualX> server_;
};

std::unique_ptr<VirtualX> WindowTest::server_;

TEST_F(WindowTest, ShowsTheRasterOfTheLightField) {
  const auto screen = open(nominal());
  EXPECT_LE(worst(raster({{Layer{.intensity = 0.2}}, {}, 1})), 1);  // safe from the start
  for (const Field& field : {edges(), gradients(), images(), edges()}) {
    const ScreenResult result = screen->run({field});
    EXPECT_GT(result.swap_utime, 0);
    EXPECT_LE(worst(raster(field)), 1);
  }
  EXPECT_EQ(screen->state().pace, Pace::kUnpaced);  // Xvfb has no vertical blank
  EXPECT_EQ(screen->state().trouble, "");
}

TEST_F(WindowTest, ACalibratedScreenUsesThePositionOfEachPixel) {
  const optics::ProjectorModel model = optics::simulatedProjector(
      kWidth, kHeight, kColumns, kRows, {.keystone = 0.15, .barrel = 0.08});
  const auto screen = open(model);
  const light::CompiledField light(edges());
  static_cast<void>(screen->run({edges()}));
  std::vector<std::uint8_t> wanted;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const auto place = model.placeOf({static_cast<double>(x), static_cast<double>(y)});
      const double value = place ? light.evaluate(place->x, place->y) : 0;
      wanted.push_back(static_cast<std::uint8_t>(std::lround(255 * value)));
    }
  }
  EXPECT_LE(worst(wanted), 1);
}

TEST_F(WindowTest, EscapeTwiceClosesIt) {
  const auto screen = open(nominal());
  SDL_Event key{};
  key.type = SDL_KEYDOWN;
  key.key.keysym.sym = SDLK_ESCAPE;
  push(key);
  EXPECT_TRUE(screen->run({edges()}).state.open);
  push(key);
  const ScreenResult result = screen->run({edges()});
  EXPECT_FALSE(result.state.open);
  EXPECT_EQ(result.swap_utime, 0);
  EXPECT_THAT(result.state.trouble, HasSubstr("by hand"));
}

TEST_F(WindowTest, AWindowWhoseSizeChangesIsOpenedAgain) {
  const auto screen = open(nominal());
  SDL_Event event{};
  event.type = SDL_WINDOWEVENT;
  event.window.event = SDL_WINDOWEVENT_SIZE_CHANGED;
  event.window.data1 = 800;
  event.window.data2 = 600;
  push(event);
  const ScreenResult closed = screen->run({edges()});
  EXPECT_FALSE(closed.state.open);
  EXPECT_THAT(closed.state.trouble, HasSubstr("size"));
  EXPECT_TRUE(screen->run({edges()}).state.open);
  EXPECT_LE(worst(raster(edges())), 1);
}

TEST_F(WindowTest, ReportsAnUnpluggedDisplay) {
  const auto screen = open(nominal());
  SDL_Event event{};
  event.type = SDL_DISPLAYEVENT;
  event.display.event = SDL_DISPLAYEVENT_DISCONNECTED;
  push(event);
  const ScreenResult result = screen->run({edges()});
  EXPECT_FALSE(result.state.open);
  EXPECT_THAT(result.state.trouble, HasSubstr("gone"));
}

TEST_F(WindowTest, ListsTheDisplaysIfTheNameIsUnknown) {
  try {
    static_cast<void>(openSdlDisplay("HDMI-7"));
    FAIL();
  } catch (const DisplayError& error) {
    EXPECT_THAT(error.what(), HasSubstr("HDMI-7"));
    EXPECT_THAT(error.what(), HasSubstr("1920 x 1080"));
  }
}

TEST_F(WindowTest, ListsDisplays) {
  std::FILE* const program = popen(LAB_PROJECTOR_CTL " --list-displays 2>&1", "r");
  ASSERT_NE(program, nullptr);
  std::array<char, 4096> text{};
  const std::size_t count = std::fread(text.data(), 1, text.size() - 1, program);
  EXPECT_EQ(pclose(program), 0);
  EXPECT_GT(count, 0U);
  EXPECT_THAT(text.data(), HasSubstr("1920 x 1080"));
  EXPECT_THAT(text.data(), HasSubstr("at (0, 0)"));
}

}  // namespace
}  // namespace lab::projector
