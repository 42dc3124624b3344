#include "tracker_svc/cameras/picture_reader.hpp"

#include <glob.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <regex>
#include <string_view>
#include <utility>

#include "common/files/file_text.hpp"
#include "light/median.hpp"
#include "tracker_svc/cameras/frame_table.hpp"
#include "tracker_svc/cameras/grey.hpp"
#include "tracker_svc/cameras/media_process.hpp"
#include "tracker_svc/cameras/picture_size.hpp"
#include "tracker_svc/cameras/stb_pixels.hpp"

namespace lab::cameras {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDigits = 15;
constexpr const char* kTable = "frames.csv";
constexpr std::array<const char*, 8> kEndings = {".png", ".jpg", ".jpeg", ".bmp",
                                                 ".pgm", ".ppm", ".tga",  ".pnm"};

std::string endingOf(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return ending;
}

bool isPicture(const fs::path& path) {
  return std::find(kEndings.begin(), kEndings.end(), endingOf(path)) != kEndings.end();
}

bool isPattern(const std::string& source) {
  return source.find_first_of("*?[") != std::string::npos;
}

/// Lists other picture formats in the folder, with advice: " but 8 .tif; ..."; empty if there are
/// none.
std::string othersIn(const std::string& folder) {
  constexpr std::array kOthers{".tif", ".tiff", ".webp", ".gif", ".heic", ".jp2", ".exr"};
  std::map<std::string, int> counts;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (std::ranges::find(kOthers, endingOf(entry.path())) != kOthers.end()) {
      ++counts[endingOf(entry.path())];
    }
  }
  if (counts.empty()) return "";
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
  return ", but " + std::to_string(most->second) + " of " + most->first +
         "; convert them to PNG with ffmpeg (ffmpeg -i f%04d" + most->first + " f%04d.png)";
}

/// Converts a pattern in ffmpeg's style, "f%04d.png", to "f*.png".
std::string withoutPercent(const std::string& source) {
  static const std::regex kNumber("%0?[0-9]*d");
  return std::regex_replace(source, kNumber, "*");
}

/// Escapes pattern characters in the name of an existing folder.
std::string withFolderAsItIs(const std::string& pattern) {
  const fs::path folder = fs::path(pattern).parent_path();
  std::error_code error;
  if (folder.empty() || !fs::is_directory(folder, error)) return pattern;
  std::string out;
  for (const char letter : folder.string()) {
    if (std::string_view("*?[]\\").find(letter) != std::string_view::npos) out += '\\';
    out += letter;
  }
  return out + '/' + fs::path(pattern).filename().string();
}

/// Compares runs of digits as numbers.
bool naturallyBefore(const std::string& a, const std::string& b) {
  const auto digit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)); };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const auto run = [&digit](const std::string& text, std::size_t& from) {
        while (from < text.size() && text[from] == '0') ++from;
        const std::size_t first = from;
        while (from < text.size() && digit(text[from])) ++from;
        return text.substr(first, from - first);
      };
      const std::string one = run(a, i);
      const std::string two = run(b, j);
      if (one.size() != two.size()) return one.size() < two.size();
      if (one != two) return one < two;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

std::vector<fs::path> listed(const std::string& source) {
  std::vector<fs::path> found;
  const std::string pattern = withoutPercent(source);
  std::error_code error;
  if (fs::is_directory(source, error)) {
    for (const auto& entry : fs::directory_iterator(source, error)) {
      if (isPicture(entry.path())) found.push_back(entry.path());
    }
    if (error) throw CameraError(source + ": " + error.message());
  } else if (!fs::exists(source, error) && isPattern(pattern)) {
    glob_t matches{};
    if (glob(withFolderAsItIs(pattern).c_str(), 0, nullptr, &matches) == 0) {
      for (std::size_t i = 0; i < matches.gl_pathc; ++i) {
        if (isPicture(matches.gl_pathv[i])) found.emplace_back(matches.gl_pathv[i]);
      }
    }
    globfree(&matches);
  } else if (fs::exists(source, error)) {
    found.emplace_back(source);
  } else {
    throw CameraError(source + ": no such file or folder");
  }
  return found;
}

/// The last number in a name.
std::optional<std::int64_t> numberIn(const fs::path& path) {
  const std::string name = path.stem().string();
  const std::size_t last = name.find_last_of("0123456789");
  if (last == std::string::npos) return {};
  const std::size_t before = name.find_last_not_of("0123456789", last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  if (last + 1 - first > kMostDigits) return {};
  std::int64_t number = 0;
  std::from_chars(name.data() + first, name.data() + last + 1, number);
  return number;
}

/// Numbers the pictures by their names if these increase, else by position.
void number(std::vector<PictureFile>& pictures) {
  std::int64_t before = -1;
  bool counts = true;
  for (PictureFile& picture : pictures) {
    const std::optional<std::int64_t> found = numberIn(picture.path);
    counts = counts && found && *found > before;
    if (found) before = picture.number = *found;
  }
  if (counts) return;
  std::int64_t position = 0;
  for (PictureFile& picture : pictures) picture.number = position++;
}

/// @return the median period [us], 0 without times
std::int64_t addTimes(std::vector<PictureFile>& pictures) {
  const fs::path table = pictures.front().path.parent_path() / kTable;
  std::error_code error;
  if (!fs::exists(table, error)) return 0;
  const FrameTable times(table);
  const double first = times.at(pictures.front().number, pictures.front().path);
  std::vector<std::int64_t> steps;
  std::int64_t before = 0;
  for (PictureFile& picture : pictures) {
    const double time = times.at(picture.number, picture.path) - first;
    picture.utime = std::llround(time * 1e6);
    if (&picture != &pictures.front()) steps.push_back(*picture.utime - before);
    before = *picture.utime;
  }
  if (steps.empty()) return 0;
  return medianOf(steps);
}

/// A decoded picture, or the reason why there is none.
struct Decoded {
  optics::GreyImage image;
  bool jpeg = false;
  int channels = 0;
  std::string error;
};

Decoded decode(const fs::path& path) {
  Decoded result;
  int width = 0;
  int height = 0;
  const std::string name = path.string();
  const FileContent file = readRegularFile(path, file_kinds::kPicture);
  if (!file.text) {
    result.error = name + ": " + file.problem;
    return result;
  }
  const auto* bytes = reinterpret_cast<const stbi_uc*>(file.text->data());
  const int size = static_cast<int>(file.text->size());
  if (stbi_info_from_memory(bytes, size, &width, &height, &result.channels) == 0) {
    result.error = name + ": is not a picture of a known format (PNG, JPEG, BMP, PGM, TGA)";
    return result;
  }
  if (const std::string problem = pictureSizeProblem(width, height); !problem.empty()) {
    result.error = name + ": " + problem;
    return result;
  }
  const int wanted = result.channels >= 3 ? 3 : 1;
  const StbPixels pixels(
      stbi_load_from_memory(bytes, size, &width, &height, &result.channels, wanted));
  if (!pixels) {
    result.error = name + ": cannot be decoded: " + stbi_failure_reason();
    return result;
  }
  result.jpeg = endingOf(path).starts_with(".jp");
  result.image = optics::GreyImage(width, height);
  if (wanted == 3) {
    greyFromRgb(pixels.get(), result.image.pixels);
  } else {
    std::copy_n(pixels.get(), result.image.pixels.size(), result.image.pixels.begin());
  }
  return result;
}

/// The EXIF orientation of a JPEG; 1 is upright.
std::string markOf(const fs::path& picture) {
  if (!endingOf(picture).starts_with(".jp")) return "";
  if (!regularFileProblem(picture, file_kinds::kPicture).empty()) return "";
  try {
    // As one JPEG, whatever it holds and whatever pattern its name could be.
    MediaProcess probe(
        {"ffprobe", "-v", "error", "-of", "csv=p=0", "-show_entries", "frame_tags=Orientation",
         "-protocol_whitelist", "file", "-f", "jpeg_pipe", "-i", "file:" + picture.string()},
        picture.string() + ": its orientation is read by", "ffmpeg");
    const int orientation = std::atoi(probe.readAll().c_str());
    static_cast<void>(probe.finish());
    return orientation > 1 ? "EXIF orientation " + std::to_string(orientation) : "";
  } catch (const CameraError&) {
    return "";  // unknown without ffprobe, which pictures do not require
  }
}

class PictureReader final : public FilmReader {
 public:
  PictureReader(const std::string& source, double fps) : pictures_(findPictures(source)) {
    step_us_ = addTimes(pictures_);
    assumed_us_ = 1e6 / (fps > 0 ? fps : kAssumedFps);
    const Decoded first = firstWhole();
    format_.width = first.image.width;
    format_.height = first.image.height;
    format_.fps = step_us_ > 0 ? 1e6 / static_cast<double>(step_us_) : std::max(fps, 0.0);
    format_.pixels = first.channels >= 3 ? "RGB (pictures)" : "grey (pictures)";
    format_.compressed = first.jpeg;
  }

  [[nodiscard]] bool next(CameraFrame& frame) override {
    while (position_ < pictures_.size()) {
      const PictureFile& picture = pictures_[position_++];
      Decoded decoded = decode(picture.path);
      if (!isUsable(decoded, picture.path)) continue;
      image_ = std::move(decoded.image);
      frame.number = picture.number;
      frame.utime = utime(picture);
      frame.grey = image_.view();
      countGap(frame.number, frame.utime);
      return true;
    }
    return false;
  }

  [[nodiscard]] std::int64_t length() const override {
    return static_cast<std::int64_t>(pictures_.size());
  }
  [[nodiscard]] CameraFormat format() const override { return format_; }
  [[nodiscard]] std::string table() const override { return pictures_.front().utime ? kTable : ""; }
  [[nodiscard]] std::string mark() const override { return markOf(pictures_[first_whole_].path); }
  [[nodiscard]] std::int64_t dropped() const override { return dropped_; }
  [[nodiscard]] std::string problem() const override {
    if (bad_ <= 1) return problem_;
    return problem_ + " (and " + std::to_string(bad_ - 1) + " more pictures like it)";
  }

 private:
  /// The reference for size, type and orientation.
  /// @throws CameraError with the first picture's problem if none can be read
  [[nodiscard]] Decoded firstWhole() {
    std::string error;
    for (first_whole_ = 0; first_whole_ < pictures_.size(); ++first_whole_) {
      Decoded decoded = decode(pictures_[first_whole_].path);
      if (decoded.error.empty()) return decoded;
      if (error.empty()) error = decoded.error;
    }
    throw CameraError(error);
  }

  [[nodiscard]] std::int64_t utime(const PictureFile& picture) const {
    if (picture.utime) return *picture.utime;
    const auto steps = static_cast<double>(picture.number - pictures_.front().number);
    return std::llround(steps * assumed_us_);
  }

  /// Counts unusable pictures, and keeps the problem of the first.
  bool isUsable(const Decoded& decoded, const fs::path& path) {
    std::string error = decoded.error;
    if (error.empty() &&
        (decoded.image.width != format_.width || decoded.image.height != format_.height)) {
      error = path.string() + ": found " + std::to_string(decoded.image.width) + " x " +
              std::to_string(decoded.image.height) + " pixels, expected " +
              std::to_string(format_.width) + " x " + std::to_string(format_.height) +
              " as in the first readable picture";
    }
    if (error.empty()) return true;
    if (bad_++ == 0) problem_ = error;
    return false;
  }

  /// Frames are missing where numbers are missing, or where a period is a multiple of the usual
  /// one.
  void countGap(std::int64_t number, std::int64_t utime) {
    if (before_) {
      const std::int64_t by_number = number - before_->first - 1;
      const double steps = step_us_ > 0 ? static_cast<double>(utime - before_->second) /
                                              static_cast<double>(step_us_)
                                        : 1;
      dropped_ += std::max<std::int64_t>({by_number, std::llround(steps) - 1, 0});
    }
    before_.emplace(number, utime);
  }

  std::vector<PictureFile> pictures_;
  std::int64_t step_us_ = 0;
  double assumed_us_ = 0;
  CameraFormat format_;
  std::size_t first_whole_ = 0;  ///< the first picture that can be read
  std::size_t position_ = 0;
  optics::GreyImage image_;
  std::optional<std::pair<std::int64_t, std::int64_t>> before_;  ///< number, utime
  std::int64_t dropped_ = 0;
  std::string problem_;
  std::int64_t bad_ = 0;
};

}  // namespace

bool isPictureSource(const std::string& source) {
  std::error_code error;
  if (fs::is_directory(source, error)) return true;
  return isPicture(source) || (isPattern(source) && !fs::exists(source, error));
}

std::vector<PictureFile> findPictures(const std::string& source) {
  std::vector<fs::path> paths = listed(source);
  if (paths.empty()) {
    throw CameraError(source + ": found no pictures (PNG, JPEG, BMP, PGM, TGA) there" +
                      othersIn(source));
  }
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    return naturallyBefore(a.string(), b.string());
  });
  std::vector<PictureFile> pictures;
  for (fs::path& path : paths) pictures.push_back({std::move(path), 0, {}});
  number(pictures);
  return pictures;
}

std::unique_ptr<FilmReader> openPictures(const std::string& source, double fps) {
  return std::make_unique<PictureReader>(source, fps);
}

}  // namespace lab::cameras
