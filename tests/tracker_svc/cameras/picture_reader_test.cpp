// The formats of pictures, and their orientation, which ffprobe reads. Their folder may come from a
// stranger.
#include "tracker_svc/cameras/picture_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>
#include <sys/stat.h>

#include <filesystem>
#include <memory>
#include <string>

#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::cameras::picture_reader_test {
namespace {

namespace fs = std::filesystem;

class PictureMark : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: orientations are not tested";
  }

  /// Writes a JPEG that says it is to be turned (EXIF, orientation 6).
  void writeTurned(const std::string& name) const {
    const fs::path file = folder_ / name;
    ASSERT_NE(stbi_write_jpg(file.c_str(), 32, 24, 1, pictureOf(1).pixels.data(), 80), 0);
    const std::string exif(
        "\xff\xe1\0\x22"
        "Exif\0\0"
        "MM\0*\0\0\0\x08\0\x01"
        "\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
        36);
    support::writeFile(file, support::readFile(file).insert(2, exif));
  }

  TemporaryFolder folder_;
};

TEST_F(PictureMark, IsThatOfTheFirstReadablePicture) {
  ASSERT_EQ(mkfifo((folder_ / "0.jpg").c_str(), 0600), 0);
  writeTurned("1.jpg");
  const std::unique_ptr<FilmReader> dut = openPictures(folder_.path().string(), 0);

  EXPECT_EQ(dut->mark(), "EXIF orientation 6");

  // Another program may have replaced it since.
  fs::remove(folder_ / "1.jpg");
  ASSERT_EQ(mkfifo((folder_ / "1.jpg").c_str(), 0600), 0);
  EXPECT_EQ(dut->mark(), "");
}

// docs/cameras.md lists the formats of pictures, whatever else stb has decoders for.
TEST(PictureFormat, ThatIsNotListedIsRefused) {
  using namespace std::string_literals;
  const TemporaryFolder folder;
  support::writeFile(folder / "a.png",
                     "GIF89a\1\0\1\0\x80\0\0\0\0\0\xff\xff\xff,\0\0\0\0\1\0\1\0\0\2\2\x44\1\0;"s);
  support::writeFile(folder / "b.tga", "\0\0\3\0\0\0\0\0\0\0\0\0\1\0\1\0\x08\0\x7f"s);

  EXPECT_THAT([&] { static_cast<void>(openPictures(folder / "a.png", 0)); },
              testing::ThrowsMessage<CameraError>(
                  testing::HasSubstr("a.png: is not a picture of a known format")));
  EXPECT_EQ(openPictures(folder / "b.tga", 0)->format().width, 1);
}

TEST_F(PictureMark, IsOfOnePictureEvenIfItsNameIsAPattern) {
  writeTurned("f%d.jpg");

  EXPECT_EQ(openPictures(folder_ / "f%d.jpg", 0)->mark(), "EXIF orientation 6");
}

}  // namespace
}  // namespace lab::cameras::picture_reader_test
