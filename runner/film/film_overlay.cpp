#include "runner/film/film_overlay.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/files/output_links.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/film/movie_writer.hpp"
#include "tracker_svc/overlay.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using optics::RgbImage;

constexpr std::size_t kTiles = 12;  // tiles of a contact sheet
constexpr int kFrameTilesAcross = 3;
constexpr int kFrameTileWidth = 960;  // [px]
constexpr int kJpegQuality = 90;

/// Temporary name in the same folder, with the same extension.
fs::path temporaryName(const fs::path& file) {
  return file.parent_path() / ("." + file.stem().string() + ".part" + file.extension().string());
}

void writeFile(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  removeLink(path);
  std::ofstream file(path, std::ios::binary);
  for (const std::uint8_t byte : bytes) file.put(static_cast<char>(byte));
  file.close();
  if (!file)
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

/// A file that gets its final name only when it is complete.
class AtomicFile {
 public:
  explicit AtomicFile(fs::path path) : path_(std::move(path)), part_(temporaryName(path_)) {}
  ~AtomicFile() {
    std::error_code ignored;
    fs::remove(part_, ignored);
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] const fs::path& part() const { return part_; }
  void finish() { fs::rename(part_, path_); }

 private:
  fs::path path_;
  fs::path part_;
};

/// Draws the overlay of one frame.
class Painter {
 public:
  explicit Painter(const OverlaySettings& settings)
      : camera_(settings.camera), cap_(settings.cap) {}

  [[nodiscard]] RgbImage paint(const OverlayFrame& frame, int width) const {
    std::vector<tracker::Mark> marks;
    for (const tracker::FilmRow& row : frame.rows) {
      marks.push_back({row.pose, row.id > 0 ? fmt::format("#{}", row.id) : "?", true});
    }
    const std::string caption =
        fmt::format("frame {}  {:.3f} s  {} found", frame.number, frame.time, frame.rows.size());
    return tracker::overlay({.picture = frame.picture,
                             .marks = marks,
                             .rejected = frame.rejected,
                             .caption = caption,
                             .width = width},
                            camera_, cap_);
  }

 private:
  optics::CameraModel camera_;
  optics::CapGeometry cap_;
};

/// Frames spread evenly over a film of unknown length: every n-th frame. When twice the wanted
/// number of tiles is reached, every second one is dropped and n doubles.
class ContactSheet final : public FilmOverlay {
 public:
  explicit ContactSheet(const OverlaySettings& settings)
      : painter_(settings), file_(settings.path) {}

  [[nodiscard]] bool wantsNext() const override { return next_ % stride_ == 0; }

  void add(const OverlayFrame& frame) override {
    if (wantsNext()) {
      tiles_.push_back(painter_.paint(frame, kFrameTileWidth));
      if (tiles_.size() == 2 * kTiles) {
        for (std::size_t i = 1; i < kTiles; ++i) tiles_[i] = std::move(tiles_[2 * i]);
        tiles_.resize(kTiles);
        stride_ *= 2;
      }
    }
    ++next_;
  }

  void finish() override {
    if (tiles_.size() > kTiles) {
      for (std::size_t i = 0; i < kTiles; ++i) {
        const std::size_t from = i * (tiles_.size() - 1) / (kTiles - 1);
        if (from != i) tiles_[i] = std::move(tiles_[from]);
      }
      tiles_.resize(kTiles);
    }
    if (tiles_.empty()) return;
    writeFile(file_.part(), optics::pngBytes(optics::contactSheet(tiles_, kFrameTilesAcross)));
    file_.finish();
  }

 private:
  Painter painter_;
  AtomicFile file_;
  std::vector<RgbImage> tiles_;
  std::int64_t next_ = 0;
  std::int64_t stride_ = 1;
};

class Movie final : public FilmOverlay {
 public:
  explicit Movie(const OverlaySettings& settings)
      : painter_(settings), file_(settings.path), fps_(settings.fps) {}

  [[nodiscard]] bool wantsNext() const override { return true; }

  void add(const OverlayFrame& frame) override {
    const RgbImage image = painter_.paint(frame, 0);
    if (!writer_) writer_.emplace(file_.part(), image.width, image.height, fps_);
    writer_->write(image);
  }

  void finish() override {
    if (!writer_) return;
    writer_->finish();
    file_.finish();
  }

 private:
  Painter painter_;
  AtomicFile file_;
  double fps_;
  std::optional<MovieWriter> writer_;
};

class PictureFolder final : public FilmOverlay {
 public:
  explicit PictureFolder(const OverlaySettings& settings)
      : painter_(settings), folder_(settings.path) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) {
      throw UserError(fmt::format("{}: cannot be created: {}", folder_.string(), error.message()));
    }
  }

  [[nodiscard]] bool wantsNext() const override { return true; }

  void add(const OverlayFrame& frame) override {
    writeFile(folder_ / fmt::format("f{:06}.jpg", frame.number),
              optics::jpegBytes(painter_.paint(frame, 0), kJpegQuality));
  }

  void finish() override {}

 private:
  Painter painter_;
  fs::path folder_;
};

bool isMovie(const fs::path& path) {
  const fs::path extension = path.extension();
  return extension == ".mp4" || extension == ".mkv" || extension == ".avi";
}

}  // namespace

std::unique_ptr<FilmOverlay> FilmOverlay::open(const OverlaySettings& settings) {
  const fs::path& path = settings.path;
  const bool sheet = path.extension() == ".png";
  const bool folder = !sheet && !isMovie(path);
  if (folder) {
    if (fs::exists(path) && !fs::is_directory(path)) {
      throw UserError(
          fmt::format("{}: found a file, expected a folder (or a name ending in .png, .mp4, "
                      ".mkv or .avi); choose another name",
                      path.string()));
    }
    if (fs::exists(path) && !fs::is_empty(path) && !settings.force) {
      throw UserError(fmt::format(
          "{}: is there already; choose another name, or --force to replace it", path.string()));
    }
    return std::make_unique<PictureFolder>(settings);
  }
  checkOutput(path, settings.force);
  if (sheet) return std::make_unique<ContactSheet>(settings);
  if (!isInstalled("ffmpeg")) {
    throw UserError(
        "a movie needs the program ffmpeg, which is not installed: apt-get install ffmpeg; or ask "
        "for a contact sheet with --overlay NAME.png");
  }
  return std::make_unique<Movie>(settings);
}

}  // namespace lab::runner
