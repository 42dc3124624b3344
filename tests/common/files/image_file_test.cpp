#include "common/files/image_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

using testing::EndsWith;

TEST(ImageFile, ReadsBackWhatWasWritten) {
  const std::vector<std::uint8_t> grey = {0, 50, 100, 150, 200, 255};
  const std::vector<std::uint8_t> png = light::encodePng(3, 2, grey);
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "grey.png";
  replaceFile(path, png);

  const light::DecodedImage dut = loadImage(path);

  ASSERT_TRUE(dut.image) << dut.error;
  EXPECT_EQ(dut.image->columns, 3);
  EXPECT_EQ(dut.image->rows, 2);
  EXPECT_EQ(dut.image->grey, grey);
  EXPECT_EQ(dut.image->sha256, light::sha256(png));
}

TEST(ImageFile, ThatIsMissingIsReportedWithItsPath) {
  const light::DecodedImage dut = loadImage("no_such_picture.png");
  EXPECT_FALSE(dut.image);
  EXPECT_EQ(dut.error, "no_such_picture.png: cannot be read: No such file or directory");
}

TEST(ImageFile, ThatIsADeviceOrAPipeIsNotRead) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(loadImage(folder / "pipe.png").error,
              EndsWith("found a pipe, expected an image: copy the content into a regular file and "
                       "name that"));
  EXPECT_THAT(loadImage("/dev/zero").error, testing::StartsWith("/dev/zero: found a device"));
}

TEST(ImageFiles, DecodeEachFileOnceHoweverItsPathIsWritten) {
  const TemporaryFolder folder;
  replaceFile(folder / "grey.png", light::encodePng(3, 2, std::vector<std::uint8_t>(6)));
  std::filesystem::create_symlink("grey.png", folder / "link.png");
  ImageFiles dut(10);  // pixels
  const auto first = dut.at(folder / "grey.png").image;
  ASSERT_TRUE(first);
  EXPECT_EQ(dut.at(folder / "././grey.png").image, first);
  EXPECT_EQ(dut.at(folder / "link.png").image, first);
}

TEST(ImageFiles, RefuseMoreThanTheMostPixelsOfAllTogether) {
  const TemporaryFolder folder;
  ImageFiles dut(10);  // pixels
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    replaceFile(folder / name, light::encodePng(3, 2, std::vector<std::uint8_t>(6)));
  }
  EXPECT_TRUE(dut.at(folder / "a.png").image);
  EXPECT_TRUE(dut.at(folder / "b.png").image);
  const light::DecodedImage& third = dut.at(folder / "c.png");
  EXPECT_FALSE(third.image);
  EXPECT_THAT(third.error, testing::HasSubstr("c.png: all images together have more than 1e-05 "
                                              "million pixels; shrink them to 160 x 120"));
}

}  // namespace
}  // namespace lab
