/// findDarkPixels() compared with a scalar implementation, and pictures padded at their edges.
#include "tracker_svc/circle_search/dark_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_search/padded_picture.hpp"

namespace lab::detector {
namespace {

constexpr int kMargin = 12;

struct Pixel {
  int white = 0;  // darker end of the best pair of neighbours; 0 if the pixel is no candidate
  bool round = false;
};

Pixel lookAt(const optics::GreyView& picture, int x, int y, const Neighbours& to,
             const Levels& levels) {
  const auto at = [&](int dx, int dy) { return static_cast<int>(picture.row(y + dy)[x + dx]); };
  const int here = std::max<int>(at(0, 0), levels.black);
  const int ends[4][2] = {
      {to.across, 0}, {0, to.across}, {to.diagonal, to.diagonal}, {-to.diagonal, to.diagonal}};
  int best = 0;
  int least = 255;
  int worst = 255;
  for (const auto& end : ends) {
    const int one = at(end[0], end[1]);
    const int other = at(-end[0], -end[1]);
    best = std::max(best, std::min(one, other));
    least = std::min(least, std::min(one, other));
    worst = std::min(worst, std::max(one, other));
  }
  const int beside =
      std::max({at(to.near, 0), at(-to.near, 0), std::min(at(0, to.near), at(0, -to.near))});
  if (here > levels.most || least < here + here / 8 + levels.barely) return {};
  if (best < 2 * here + levels.clear || beside > best - best / 4 + levels.black / 4) return {};
  const int contrast = best - here;
  const int above = std::max<int>(contrast / 8 + contrast / 16, levels.noise);
  if (contrast >= levels.faint && worst < here + above) return {};
  return {best, least >= here + contrast / 8};
}

TEST(DarkWords, EqualAScalarImplementation) {
  constexpr int kWords = 5;
  const int width = kWords * kWord + 2 * kMargin;
  const int height = 2 * kMargin + 1;
  std::mt19937 random(3);
  std::vector<int> starts;
  for (int i = 0; i < kWords; ++i) starts.push_back(kMargin + i * kWord);
  int dark = 0;
  for (int round = 0; round < 1500; ++round) {
    // Dark blobs on a bright background, with low to full contrast.
    const int floor = static_cast<int>(random() % 20);
    const int brightest = round % 3 == 0 ? 255 : 20 + static_cast<int>(random() % 200);
    optics::GreyImage image(width, height);
    for (std::uint8_t& pixel : image.pixels) {
      pixel = static_cast<std::uint8_t>(brightest - static_cast<int>(random() % 20));
    }
    for (int blob = 0; blob < 12; ++blob) {
      const int left = static_cast<int>(random() % static_cast<unsigned>(width - 7));
      const int top = static_cast<int>(random() % static_cast<unsigned>(height - 7));
      for (int i = 0; i < 49; ++i) {
        image.row(top + i / 7)[left + i % 7] =
            static_cast<std::uint8_t>(floor + static_cast<int>(random() % 10));
      }
    }
    const optics::GreyView picture = image.view();
    const Levels levels =
        levelsOf(static_cast<int>(random() % 25), 1 + static_cast<int>(random() % 8));
    std::vector<Neighbours> to(kWords);
    for (Neighbours& one : to) {
      one = {static_cast<std::int16_t>(random() % 10), static_cast<std::int16_t>(1 + random() % 8),
             static_cast<std::int16_t>(1 + random() % 3)};
    }
    const std::uint64_t wanted = random() % (1U << kWords);
    DarkPixelWord found[kWords];
    const int count = findDarkPixels(picture.row(kMargin), picture.stride, starts.data(), to.data(),
                                     wanted, 0, levels, found);
    int next = 0;
    for (int word = 0; word < kWords; ++word) {
      const auto number = static_cast<std::size_t>(word);
      DarkPixelWord expected;
      for (int i = 0; i < kWord; ++i) {
        if ((wanted >> word & 1U) == 0 || to[number].across == 0) continue;
        const Pixel pixel = lookAt(picture, starts[number] + i, kMargin, to[number], levels);
        expected.white[i] = static_cast<std::uint8_t>(pixel.white);
        if (pixel.white > 0) expected.dark |= 1U << i;
        if (pixel.round) expected.round |= 1U << i;
      }
      if (expected.dark == 0) continue;
      ASSERT_LT(next, count);
      EXPECT_EQ(found[next].number, word);
      EXPECT_EQ(found[next].dark, expected.dark);
      EXPECT_EQ(found[next].round, expected.round);
      EXPECT_TRUE(std::equal(expected.white, expected.white + kWord, found[next].white));
      ++next;
      ++dark;
    }
    ASSERT_EQ(next, count);
  }
  EXPECT_GT(dark, 100);
}

TEST(PaddedPicture, RepeatsTheOutermostPixels) {
  constexpr int kPadding = 7;
  std::mt19937 random(5);
  optics::GreyImage image(20, 9);
  for (std::uint8_t& pixel : image.pixels) pixel = static_cast<std::uint8_t>(random());
  const optics::GreyView picture = image.view();
  PaddedPicture padded;
  for (const Region& part :
       {Region{-5, -5, 100, 100}, {0, 0, 3, 3}, {30, 2, 33, 20}, {4, 5, 9, 11}, {12, 12, 11, 15}}) {
    const optics::GreyView all = padded.begin(picture, kPadding);
    ASSERT_EQ(all.width, 34);
    ASSERT_EQ(all.height, 23);
    padded.need(part);
    for (int y = std::max(part.top, 0); y <= std::min(part.bottom, all.height - 1); ++y) {
      for (int x = std::max(part.left, 0); x <= std::min(part.right, all.width - 1); ++x) {
        EXPECT_EQ(all.row(y)[x],
                  picture.row(std::clamp(y - kPadding, 0, 8))[std::clamp(x - kPadding, 0, 19)]);
      }
    }
  }
}

}  // namespace
}  // namespace lab::detector
