/// Synthetic pictures and movies for tests.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/files/atomic_file.hpp"
#include "light/field/image.hpp"
#include "light/optics/grey_image.hpp"

namespace lab {

/// A picture that depends on `number` in every pixel.
inline optics::GreyImage pictureOf(int number, int width = 32, int height = 24) {
  optics::GreyImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.row(y)[x] = static_cast<std::uint8_t>(x * 7 + y * 3 + number * 11);
    }
  }
  return image;
}

/// Whether every pixel is within `slack` of pictureOf(number).
inline bool isPictureOf(const optics::GreyView& grey, int number, int slack = 0) {
  const optics::GreyImage wanted = pictureOf(number, grey.width, grey.height);
  const optics::GreyView view = wanted.view();
  for (int y = 0; y < grey.height; ++y) {
    for (int x = 0; x < grey.width; ++x) {
      if (std::abs(grey.row(y)[x] - view.row(y)[x]) > slack) return false;
    }
  }
  return true;
}

inline void writePng(const std::filesystem::path& path, const optics::GreyImage& image) {
  replaceFile(path, light::encodePng(image.width, image.height, image.pixels));
}

/// Whether ffmpeg and ffprobe are installed.
inline bool hasFfmpeg() {
  return std::system("ffmpeg -version >/dev/null 2>&1 && ffprobe -version >/dev/null 2>&1") == 0;
}

/// A movie of pictureOf(0), pictureOf(1), ... at 10 frames a second.
/// @param options output options of ffmpeg: codec and pixel format
inline void writeMovie(const std::filesystem::path& path, int frames, const std::string& options,
                       int width = 32, int height = 24) {
  const std::filesystem::path raw = path.string() + ".raw";
  std::ofstream stream(raw, std::ios::binary);
  for (int i = 0; i < frames; ++i) {
    const optics::GreyImage image = pictureOf(i, width, height);
    stream.write(reinterpret_cast<const char*>(image.pixels.data()),
                 static_cast<std::streamsize>(image.pixels.size()));
  }
  stream.close();
  const std::string command = "ffmpeg -nostdin -v error -y -f rawvideo -pix_fmt gray -s " +
                              std::to_string(width) + "x" + std::to_string(height) + " -r 10 -i '" +
                              raw.string() + "' " + options + " '" + path.string() + "'";
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command + ": failed");
  std::filesystem::remove(raw);
}

}  // namespace lab
