#include "runner/film/film_overlay.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/files/atomic_file.hpp"
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
      : painter_(settings), path_(settings.path) {}

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
    replaceFile(path_, optics::pngBytes(optics::contactSheet(tiles_, kFrameTilesAcross)));
  }

 private:
  Painter painter_;
  fs::path path_;
  std::vector<RgbImage> tiles_;
  std::int64_t next_ = 0;
  std::int64_t stride_ = 1;
};

class Movie final : public FilmOverlay {
 public:
  explicit Movie(const OverlaySettings& settings)
      : painter_(settings), path_(settings.path), fps_(settings.fps) {}

  [[nodiscard]] bool wantsNext() const override { return true; }

  void add(const OverlayFrame& frame) override {
    const RgbImage image = painter_.paint(frame, 0);
    if (!writer_) writer_.emplace(path_, image.width, image.height, fps_);
    writer_->write(image);
  }

  void finish() override {
    if (writer_) writer_->finish();
  }

 private:
  Painter painter_;
  fs::path path_;
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
    replaceFile(folder_ / fmt::format("f{:06}.jpg", frame.number),
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
