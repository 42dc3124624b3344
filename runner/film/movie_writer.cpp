#include "runner/film/movie_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/process/pipe.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> arguments(const fs::path& file, int width, int height, double fps) {
  std::vector<std::string> all{"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y",
                               "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size",
                               fmt::format("{}x{}", width, height), "-framerate",
                               fmt::format("{:.6g}", fps), "-i", "pipe:0", "-vf",
                               // Players need H.264 with even width and height.
                               "pad=ceil(iw/2)*2:ceil(ih/2)*2"};
  const bool motion_jpeg = file.extension() == ".avi";
  for (const char* word :
       motion_jpeg ? std::array{"-c:v", "mjpeg", "-q:v", "4", "-pix_fmt", "yuvj420p"}
                   : std::array{"-c:v", "libx264", "-crf", "22", "-pix_fmt", "yuv420p"}) {
    all.emplace_back(word);
  }
  all.push_back("file:" + file.string());  // the prefix allows any character in the name
  return all;
}

/// With the extension of the movie, from which ffmpeg knows the format.
fs::path partOfMovie(const fs::path& file) {
  return file.parent_path() / ("." + file.stem().string() + ".part" + file.extension().string());
}

}  // namespace

bool isInstalled(const char* program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

MovieWriter::MovieWriter(const fs::path& file, int width, int height, double fps)
    : file_(file, partOfMovie(file)) {
  if (width > kMostPixels || height > kMostPixels) {
    throw UserError(fmt::format(
        "{}: found pictures of {} x {} px, expected at most {} px in width and height of a movie; "
        "use an arena or a film of other proportions",
        file.string(), width, height, kMostPixels));
  }
  if (!isInstalled("ffmpeg")) {
    throw UserError(
        "a movie needs the program ffmpeg, which is not installed: apt-get install ffmpeg; or ask "
        "for a contact sheet with --overlay NAME.png");
  }
  messages_ = FileDescriptor(open("/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (messages_.get() < 0) {
    throw std::runtime_error(std::string("cannot start ffmpeg: ") + std::strerror(errno));
  }
  Pipe pipe = makePipe();
  // In its own process group, so that Ctrl-C does not end ffmpeg before its input ends. If this
  // process is killed, ffmpeg completes the movie with the pictures that it has.
  child_.emplace(ChildSettings{.arguments = arguments(file_.part(), width, height, fps),
                               .input = pipe.out.get(),
                               .errors = messages_.get(),
                               .death_signal = 0});
  input_ = std::move(pipe.in);
}

MovieWriter::~MovieWriter() {
  if (child_) child_->signal(SIGKILL);
  wait();
}

void MovieWriter::write(const optics::RgbImage& image) {
  const std::uint8_t* data = image.pixels.data();
  std::size_t left = image.pixels.size();
  while (left > 0) {
    const ssize_t written = ::write(input_.get(), data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    data += written;
    left -= static_cast<std::size_t>(written);
  }
}

void MovieWriter::finish() {
  // ffmpeg does not always fail on errors such as a full disk, but it prints them.
  wait();
  struct stat messages {};
  if (child_->code() != 0 || fstat(messages_.get(), &messages) != 0 || messages.st_size > 0) fail();
  file_.finish();
}

void MovieWriter::wait() {
  input_ = FileDescriptor();
  if (child_) child_->wait();
}

void MovieWriter::fail() {
  wait();
  std::array<char, 400> message{};
  const ssize_t length = pread(messages_.get(), message.data(), message.size() - 1, 0);
  std::string text(message.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  text = text.substr(0, text.find('\n'));
  throw std::runtime_error(fmt::format("{}: ffmpeg could not write it: {}", file_.path().string(),
                                       text.empty() ? "it gave no reason" : text));
}

}  // namespace lab::runner
