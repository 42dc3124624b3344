/// The prefilter must keep every circle, and hardly anything where there is only noise.
#include "tracker_svc/circle_search/contrast_prefilter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "light/optics/grey_image.hpp"

namespace lab::detector::first_glance_test {
namespace {

constexpr int kWidth = 330;  // the last word overlaps the previous one
constexpr int kHeight = 101;
constexpr int kStep = 3;
constexpr int kAround = 9;
constexpr double kBlack = 2;
constexpr double kReadNoise = 1.2;

std::vector<int> wordStarts() {
  std::vector<int> starts;
  for (int x = 0; x + kWord <= kWidth; x += kWord) starts.push_back(x);
  starts.push_back(kWidth - kWord);
  return starts;
}

/// Black discs on white, or white only.
optics::GreyImage paint(double white, const std::vector<optics::Pixel>& discs, double radius,
                        std::mt19937_64& random, double read_noise = kReadNoise) {
  std::normal_distribution<double> noise(0, read_noise);
  optics::GreyImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double light = white;
      for (const optics::Pixel& disc : discs) {
        const double inside = radius - std::hypot(x - disc.x, y - disc.y);
        light *= 1 - 0.92 * std::clamp(inside + 0.5, 0.0, 1.0);
      }
      const double value = kBlack + light + noise(random);
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return image;
}

TEST(ContrastPrefilter, KeepsTheWordsOfEveryCircle) {
  std::mt19937_64 random(2);
  const Levels levels = levelsOf(static_cast<int>(kBlack), 4);
  ContrastPrefilter glance(kWidth, kHeight, wordStarts(), 1, kStep, kAround);
  for (int round = 0; round < 400; ++round) {
    const double white = std::exp(std::uniform_real_distribution<double>(2.0, 5.4)(random));
    const double radius = std::uniform_real_distribution<double>(2.6, 7.0)(random);
    // Includes circles cut by the edge, with the centre up to half a radius outside.
    std::uniform_real_distribution<double> x(-0.5 * radius, kWidth - 1 + 0.5 * radius);
    std::uniform_real_distribution<double> y(-0.5 * radius, kHeight - 1 + 0.5 * radius);
    const optics::Pixel disc{x(random), y(random)};
    const optics::GreyImage image = paint(white, {disc}, radius, random);
    glance.look(image.view(), levels, 0, kHeight - 1);
    const auto row = std::clamp(static_cast<int>(std::lround(disc.y)), 0, kHeight - 1);
    const auto word = std::clamp(static_cast<int>(std::lround(disc.x)), 0, kWidth - 1) / kWord;
    EXPECT_TRUE(glance.words(row, 0) >> word & 1U)
        << "white " << white << " radius " << radius << " at " << disc.x << ", " << disc.y;
  }
}

TEST(ContrastPrefilter, KeepsThemInNoiseToo) {
  std::mt19937_64 random(4);
  const double read_noise = 10;
  const Levels levels = levelsOf(static_cast<int>(kBlack), 33);
  ContrastPrefilter glance(kWidth, kHeight, wordStarts(), 1, kStep, kAround);
  int left = 0;
  for (int round = 0; round < 200; ++round) {
    std::uniform_real_distribution<double> x(20, kWidth - 20);
    std::uniform_real_distribution<double> y(20, kHeight - 20);
    const optics::Pixel disc{x(random), y(random)};
    // Dark and white differ by just more than read noise can cause in a single pixel.
    const optics::GreyImage image = paint(levels.noise / 0.92, {disc}, 5, random, read_noise);
    glance.look(image.view(), levels, 0, kHeight - 1);
    const int row = static_cast<int>(std::lround(disc.y));
    const int word = static_cast<int>(std::lround(disc.x)) / kWord;
    const std::uint64_t words = glance.words(row - 3, 0) | glance.words(row + 3, 0);
    left += words >> word & 1U ? 1 : 0;
  }
  EXPECT_EQ(left, 200);
}

TEST(ContrastPrefilter, RejectsNoise) {
  std::mt19937_64 random(3);
  const Levels levels = levelsOf(static_cast<int>(kBlack), 4);
  ContrastPrefilter glance(kWidth, kHeight, wordStarts(), 0, kStep, kAround);
  int left = 0;
  int all = 0;
  for (const double white : {0.5, 1.0, 2.0, 3.0, 6.0, 20.0, 100.0, 230.0}) {
    for (int round = 0; round < 10; ++round) {
      const optics::GreyImage image = paint(white, {}, 1, random);
      glance.look(image.view(), levels, 0, kHeight - 1);
      for (int row = 0; row < kHeight; row += 8) {
        for (std::size_t word = 0; word < wordStarts().size(); ++word) {
          left += glance.words(row, 0) >> word & 1U ? 1 : 0;
          ++all;
        }
      }
    }
  }
  EXPECT_LT(left * 100, all);
}

TEST(ContrastPrefilter, UsesTheBrightSideInAdjacentCells) {
  // Half of the picture is dark; only cells near the bright half may contain a circle.
  const Levels levels = levelsOf(static_cast<int>(kBlack), 4);
  ContrastPrefilter glance(kWidth, kHeight, wordStarts(), 0, kStep, kAround);
  optics::GreyImage image(kWidth, kHeight, 20);
  for (int y = 0; y < kHeight; ++y) std::fill(image.row(y) + 5 * kWord, image.row(y) + kWidth, 200);
  glance.look(image.view(), levels, 0, kHeight - 1);
  EXPECT_EQ(glance.words(50, 0), 1U << 4);
}

}  // namespace
}  // namespace lab::detector::first_glance_test
