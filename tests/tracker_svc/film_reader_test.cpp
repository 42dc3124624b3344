#include "tracker_svc/film_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "tests/support/film_samples.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracker_svc/cameras/grey.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

class Films : public testing::Test {
 protected:
  struct Frame {
    std::int64_t number;
    std::int64_t utime;
    optics::GreyImage image;
  };

  /// Reads all frames of a recording.
  std::vector<Frame> read(const std::string& source, double fps = 0) {
    film_ = FilmReader::open(source, fps);
    std::vector<Frame> frames;
    CameraFrame frame;
    while (film_->next(frame)) {
      Frame copy{frame.number, frame.utime, {frame.grey.width, frame.grey.height}};
      for (int y = 0; y < frame.grey.height; ++y) {
        std::copy_n(frame.grey.row(y), frame.grey.width, copy.image.row(y));
      }
      frames.push_back(std::move(copy));
    }
    return frames;
  }

  std::vector<std::int64_t> numbers(const std::string& source) {
    std::vector<std::int64_t> found;
    for (const Frame& frame : read(source)) found.push_back(frame.number);
    return found;
  }

  static std::string refusal(const std::string& source) {
    try {
      static_cast<void>(FilmReader::open(source));
    } catch (const CameraError& error) {
      return error.what();
    }
    return "opened";
  }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  TemporaryFolder folder_;
  std::unique_ptr<FilmReader> film_;
};

using Pictures = Films;

TEST_F(Pictures, AreReadInTheOrderOfTheirNumbers) {
  for (const int number : {10, 2, 1}) {
    writePng(folder_ / ("f" + std::to_string(number) + ".png"), pictureOf(number));
  }
  write("notes.txt", "no picture");

  const std::vector<Frame> frames = read(folder_ / "");

  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(film_->length(), 3);
  EXPECT_EQ(film_->format().width, 32);
  EXPECT_EQ(film_->format().height, 24);
  EXPECT_THAT(film_->problem(), IsEmpty());
  std::vector<std::int64_t> numbers;
  for (const Frame& frame : frames) {
    numbers.push_back(frame.number);
    EXPECT_TRUE(isPictureOf(frame.image.view(), static_cast<int>(frame.number)));
  }
  EXPECT_THAT(numbers, ElementsAre(1, 2, 10));
  EXPECT_EQ(film_->dropped(), 7);
}

TEST_F(Pictures, AreSelectedByPatterns) {
  for (const int number : {0, 1}) {
    writePng(folder_ / ("a000" + std::to_string(number) + ".png"), pictureOf(number));
    writePng(folder_ / ("b000" + std::to_string(number) + ".png"), pictureOf(number + 5));
  }

  EXPECT_THAT(numbers(folder_ / "b*.png"), ElementsAre(0, 1));
  EXPECT_TRUE(isPictureOf(read(folder_ / "b%04d.png").at(1).image.view(), 6));
  EXPECT_THAT(numbers(folder_ / "a0001.png"), ElementsAre(1));
}

TEST_F(Pictures, AreSelectedInFoldersWhoseNamesLookLikePatterns) {
  fs::create_directory(folder_ / "run[1]");
  writePng(folder_ / "run[1]" / "f0.png", pictureOf(0));
  writePng(folder_ / "run[1]" / "f1.png", pictureOf(1));

  EXPECT_THAT(numbers(folder_ / "run[1]/f*.png"), ElementsAre(0, 1));
  EXPECT_THAT(numbers(folder_ / "run*/f*.png"), ElementsAre(0, 1));
}

TEST_F(Pictures, WithoutNumbersAreNumberedByPosition) {
  writePng(folder_ / "left.png", pictureOf(0));
  writePng(folder_ / "right.png", pictureOf(1));

  EXPECT_THAT(numbers(folder_ / ""), ElementsAre(0, 1));
}

TEST_F(Pictures, TakeTheirTimesFromATable) {
  for (const int number : {3, 4, 5, 6}) {
    writePng(folder_ / ("f" + std::to_string(number) + ".png"), pictureOf(number));
  }
  write("frames.csv", "frame,t_s,step,remark\n3,7.5,0,\r\n4,7.55,1,dark\n5,7.65,3,\n6,7.7,4,\n");

  const std::vector<Frame> frames = read(folder_ / "");

  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].utime, 0);
  EXPECT_EQ(frames[1].utime, 50'000);
  EXPECT_EQ(frames[2].utime, 150'000);
  EXPECT_EQ(frames[3].utime, 200'000);
  EXPECT_EQ(film_->dropped(), 1) << "the step from 7.55 to 7.65 is twice the usual";
  EXPECT_NEAR(film_->format().fps, 20, 1e-9);
}

TEST_F(Pictures, TakeTheirTimesFromATableWrittenByASpreadsheet) {
  writePng(folder_ / "f0.png", pictureOf(0));
  writePng(folder_ / "f1.png", pictureOf(1));
  write("frames.csv",
        "\xEF\xBB\xBF"
        "frame, t_s\r\n0, 1.5\r\n1, 1.75\r\n");

  EXPECT_EQ(read(folder_ / "").at(1).utime, 250'000);
}

TEST_F(Pictures, WithoutATableHaveTheGivenRate) {
  writePng(folder_ / "f0.png", pictureOf(0));
  writePng(folder_ / "f2.png", pictureOf(2));

  EXPECT_EQ(read(folder_ / "", 50).at(1).utime, 40'000);
  EXPECT_EQ(film_->format().fps, 50);
  EXPECT_EQ(read(folder_ / "").at(1).utime, 66'667);
  EXPECT_EQ(film_->format().fps, 0);
}

TEST_F(Pictures, FromJpegFilesAreReportedAsCompressed) {
  writePng(folder_ / "f0.png", pictureOf(0));
  read(folder_ / "f0.png");
  EXPECT_FALSE(film_->format().compressed);
  const std::string jpeg = folder_ / "f0.JPG";
  ASSERT_NE(stbi_write_jpg(jpeg.c_str(), 32, 24, 1, pictureOf(0).pixels.data(), 80), 0);
  read(jpeg);
  EXPECT_TRUE(film_->format().compressed);
}

TEST_F(Pictures, InColourAreConvertedToGrey) {
  write("c1.ppm", "P6\n2 1\n255\n" + std::string("\xff\x00\x00\x10\x20\x31", 6));

  const std::vector<Frame> frames = read(folder_ / "c1.ppm");

  ASSERT_EQ(frames.size(), 1U);
  EXPECT_THAT(frames[0].image.pixels, ElementsAre(64, 32));
  EXPECT_EQ(cameras::greyOf(255, 255, 255), 255);
}

TEST_F(Pictures, ThatAreDamagedAreSkippedAndReported) {
  for (const int number : {0, 1, 2, 3}) {
    writePng(folder_ / ("f" + std::to_string(number) + ".png"), pictureOf(number));
  }
  write("f1.png", "no picture");
  writePng(folder_ / "f2.png", pictureOf(2, 16, 16));

  EXPECT_THAT(numbers(folder_ / ""), ElementsAre(0, 3));
  EXPECT_THAT(film_->problem(), AllOf(HasSubstr("f1.png: is not a picture"), HasSubstr("1 more")));
  EXPECT_EQ(film_->dropped(), 2);
}

TEST_F(Pictures, OfAnotherSizeAreReportedByName) {
  writePng(folder_ / "f0.png", pictureOf(0));
  writePng(folder_ / "f1.png", pictureOf(1, 16, 20));

  EXPECT_THAT(numbers(folder_ / ""), ElementsAre(0));
  EXPECT_THAT(film_->problem(),
              HasSubstr("f1.png: found 16 x 20 pixels, expected 32 x 24 as in the first readable"));
}

TEST_F(Pictures, ThatAreDamagedBeforeTheFirstGoodOneAreSkippedToo) {
  write("f0.png", "no picture");
  writePng(folder_ / "f1.png", pictureOf(1));
  writePng(folder_ / "f2.png", pictureOf(2));

  EXPECT_THAT(numbers(folder_ / ""), ElementsAre(1, 2));
  EXPECT_EQ(film_->format().width, 32);
  EXPECT_THAT(film_->problem(), HasSubstr("f0.png: is not a picture"));
}

TEST_F(Pictures, WithoutAnyUsableOneAreRejected) {
  write("f0.png", "no picture");
  EXPECT_THAT(refusal(folder_ / "f0.png"), HasSubstr("f0.png: is not a picture of a known format"));
  EXPECT_THAT(refusal(folder_ / "g*.png"), HasSubstr("found no pictures"));
  EXPECT_THAT(refusal(folder_ / "none.png"), EndsWith("none.png: no such file or folder"));
  fs::create_directory(folder_ / "empty");
  EXPECT_THAT(refusal(folder_ / "empty"), HasSubstr("empty: found no pictures"));
}

TEST_F(Pictures, WithAnInvalidTableAreRejected) {
  writePng(folder_ / "f0.png", pictureOf(0));
  writePng(folder_ / "f1.png", pictureOf(1));
  const auto refusalOf = [this](const std::string& table) {
    write("frames.csv", table);
    return refusal(folder_ / "");
  };

  EXPECT_THAT(refusalOf("frame,time\n0,0\n"), HasSubstr("frames.csv:1: has no column t_s"));
  EXPECT_THAT(refusalOf("frame,t_s\n0,0\n1,x\n"), HasSubstr("frames.csv:3: t_s: found \"x\""));
  EXPECT_THAT(refusalOf("frame,t_s\n0,0\n1,0\n"), HasSubstr("frames.csv:3: frame and t_s must"));
  EXPECT_THAT(refusalOf("frame,t_s\n0,0\n"), HasSubstr("has no row for frame 1 (f1.png)"));
  EXPECT_THAT(refusalOf("t_s,frame\n0,0\n0.5,1\n"), HasSubstr("opened"));
}

TEST_F(Pictures, AndTheirTableAreReadFromRegularFilesOnly) {
  ASSERT_EQ(mkfifo((folder_ / "pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder_ / "pipe.png"), HasSubstr("pipe.png: found a pipe"));
  writePng(folder_ / "f0.png", pictureOf(0));
  ASSERT_EQ(mkfifo((folder_ / "frames.csv").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder_ / "f*.png"), HasSubstr("frames.csv: found a pipe"));
}

TEST_F(Pictures, OfHugeSizeAreRejectedBeforeTheyAreDecoded) {
  write("f.pgm", "P5\n30000 30000\n255\n");
  EXPECT_THAT(refusal(folder_ / "f.pgm"), HasSubstr("found 30000 x 30000 pixels"));
}

class Movies : public Films {
 protected:
  void SetUp() override {
    if (!hasFfmpeg()) GTEST_SKIP() << "ffmpeg is not installed: movies are not tested";
  }

  /// Counts the frames and compares each with the original.
  int framesAlike(const std::string& file, int slack) {
    int position = 0;
    for (const Frame& frame : read(file)) {
      EXPECT_EQ(frame.number, position);
      EXPECT_EQ(frame.utime, position * 100'000);
      EXPECT_TRUE(isPictureOf(frame.image.view(), position, slack)) << "frame " << position;
      ++position;
    }
    return position;
  }

  void halve(const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); }
};

TEST_F(Movies, WithLosslessCodecKeepEveryGreyValue) {
  writeMovie(folder_ / "a.mkv", 5, "-c:v ffv1 -pix_fmt gray");
  writeMovie(folder_ / "b.avi", 5, "-c:v ffv1 -pix_fmt gray");
  writeMovie(folder_ / "c.mkv", 5, "-c:v ffv1 -pix_fmt bgr0");

  for (const char* file : {"a.mkv", "b.avi", "c.mkv"}) {
    SCOPED_TRACE(file);
    EXPECT_EQ(framesAlike(folder_ / file, 0), 5);
    EXPECT_EQ(film_->length(), 5);
    EXPECT_NEAR(film_->format().fps, 10, 1e-6);
    EXPECT_THAT(film_->problem(), IsEmpty());
  }
  EXPECT_EQ(film_->format().pixels, "bgr0 (ffv1)");
  EXPECT_FALSE(film_->format().compressed);
}

TEST_F(Movies, InFullAndLimitedRangeHaveTheSameGrey) {
  writeMovie(folder_ / "limited.mkv", 4, "-c:v libx264 -qp 0 -pix_fmt yuv420p");
  writeMovie(folder_ / "full.mp4", 4, "-c:v libx264 -qp 0 -pix_fmt yuvj420p");

  EXPECT_EQ(framesAlike(folder_ / "limited.mkv", 2), 4);
  EXPECT_EQ(framesAlike(folder_ / "full.mp4", 1), 4);
}

TEST_F(Movies, WithReorderedFramesAreReadInOrder) {
  writeMovie(folder_ / "b.mp4", 12, "-c:v libx264 -qp 0 -bf 3 -pix_fmt yuvj420p");
  writeMovie(folder_ / "b.avi", 12, "-c:v libx264 -qp 0 -bf 3 -pix_fmt yuvj420p");

  EXPECT_EQ(framesAlike(folder_ / "b.mp4", 1), 12);
  EXPECT_EQ(framesAlike(folder_ / "b.avi", 1), 12);
}

TEST_F(Movies, OfJpegFramesAreRead) {
  writeMovie(folder_ / "m.avi", 4, "-c:v mjpeg -q:v 1 -pix_fmt yuvj444p");

  EXPECT_EQ(framesAlike(folder_ / "m.avi", 24), 4);
  EXPECT_TRUE(film_->format().compressed);
  EXPECT_THAT(film_->problem(), IsEmpty());
}

TEST_F(Movies, OfVariableRateKeepTheirTimes) {
  writeMovie(folder_ / "v.mkv", 6,
             "-vf \"select='not(eq(n,2))'\" -fps_mode vfr -c:v ffv1 -pix_fmt gray");

  const std::vector<Frame> frames = read(folder_ / "v.mkv");

  std::vector<std::int64_t> times;
  for (const Frame& frame : frames) times.push_back(frame.utime);
  EXPECT_THAT(times, ElementsAre(0, 100'000, 300'000, 400'000, 500'000));
  EXPECT_TRUE(isPictureOf(frames.at(2).image.view(), 3));
}

TEST_F(Movies, ThatEndEarlyReportIt) {
  for (const char* file : {"t.mkv", "t.avi"}) {
    SCOPED_TRACE(file);
    writeMovie(folder_ / file, 40, "-c:v ffv1 -pix_fmt gray", 160, 120);
    halve(folder_ / file);

    const std::size_t count = read(folder_ / file).size();

    EXPECT_GT(count, 10U);
    EXPECT_LT(count, 30U);
    EXPECT_THAT(film_->problem(), AllOf(HasSubstr(file), HasSubstr(std::to_string(count)),
                                        HasSubstr("could be read")));
  }
}

TEST_F(Movies, WithoutTheirIndexAreRejected) {
  writeMovie(folder_ / "t.mp4", 10, "-c:v libx264 -qp 0 -pix_fmt yuvj420p");
  halve(folder_ / "t.mp4");

  EXPECT_THAT(
      refusal(folder_ / "t.mp4"),
      AllOf(HasSubstr("t.mp4: is not a movie that ffmpeg can read"), HasSubstr("record MKV")));
}

TEST_F(Movies, ThatAreListsOfOthersAreRejected) {
  write("endless.mkv", "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nhttp://127.0.0.1:9/a.ts\n");
  write("list.mkv", "ffconcat version 1.0\nfile pipe\n");
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);

  // ffmpeg 7 refuses some of them by itself, because of the ending of the name.
  const auto refused = testing::AnyOf(HasSubstr("it is a playlist"),
                                      HasSubstr("is not a movie that ffmpeg can read"));
  EXPECT_THAT(refusal(folder_ / "endless.mkv"), refused);
  EXPECT_THAT(refusal(folder_ / "list.mkv"), refused);
}

TEST_F(Movies, ThatAreTextFilesAreRejected) {
  write("text.avi", "frame,id,x\n0,1,2\n");
  write("empty.avi", "");
  write("text.ans", "hello\n");

  EXPECT_THAT(refusal(folder_ / "text.avi"), HasSubstr("text.avi: is not a movie that ffmpeg"));
  EXPECT_THAT(refusal(folder_ / "empty.avi"), HasSubstr("empty.avi: is not a movie that ffmpeg"));
  EXPECT_THAT(refusal(folder_ / "text.ans"), HasSubstr("it is a text file"));
}

TEST_F(Films, ThatDoNotExistAreReported) {
  EXPECT_THAT(refusal(folder_ / "none.mkv"), EndsWith("none.mkv: no such file"));
  ASSERT_EQ(mkfifo((folder_ / "pipe.mkv").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder_ / "pipe.mkv"), HasSubstr("pipe.mkv: found a pipe"));
}

TEST_F(Films, WithoutFfmpegTheErrorNamesThePackage) {
  write("a.mkv", "whatever");
  const std::string path = getenv("PATH");
  setenv("PATH", "/nowhere", 1);

  const std::string found = refusal(folder_ / "a.mkv");

  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(found, EndsWith("a.mkv: movies are read by the program ffprobe, which is not "
                              "installed: sudo apt install ffmpeg"));
}

}  // namespace
}  // namespace lab
