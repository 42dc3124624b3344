#include "runner/film/movie_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
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

}  // namespace

bool isInstalled(const char* program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

MovieWriter::MovieWriter(fs::path file, int width, int height, double fps)
    : file_(std::move(file)) {
  if (!isInstalled("ffmpeg")) {
    throw UserError(
        "a movie needs the program ffmpeg, which is not installed: apt-get install ffmpeg; or ask "
        "for a contact sheet with --overlay NAME.png");
  }
  std::array<int, 2> pipe{};
  messages_ = open("/tmp", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (messages_ < 0 || pipe2(pipe.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("cannot start ffmpeg: ") + std::strerror(errno));
  }
  input_ = pipe[1];
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages_, STDERR_FILENO);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  // In its own process group, so that Ctrl-C does not end ffmpeg before its input ends.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const std::vector<std::string> words = arguments(file_, width, height, fps);
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const int error = posix_spawnp(&pid_, "ffmpeg", &actions, &attributes, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(pipe[0]);
  if (error != 0) {
    pid_ = -1;
    throw std::runtime_error(std::string("cannot start ffmpeg: ") + std::strerror(error));
  }
}

MovieWriter::~MovieWriter() {
  if (pid_ > 0) kill(pid_, SIGKILL);
  static_cast<void>(wait());
  if (messages_ >= 0) close(messages_);
}

void MovieWriter::write(const optics::RgbImage& image) {
  const std::uint8_t* data = image.pixels.data();
  std::size_t left = image.pixels.size();
  while (left > 0) {
    const ssize_t written = ::write(input_, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    data += written;
    left -= static_cast<std::size_t>(written);
  }
}

void MovieWriter::finish() {
  // ffmpeg does not always fail on errors such as a full disk, but it prints them.
  const int status = wait();
  struct stat messages {};
  if (status != 0 || fstat(messages_, &messages) != 0 || messages.st_size > 0) fail();
}

int MovieWriter::wait() {
  if (input_ >= 0) close(std::exchange(input_, -1));
  int status = 0;
  if (pid_ > 0) {
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  return status;
}

void MovieWriter::fail() {
  static_cast<void>(wait());
  std::array<char, 400> message{};
  const ssize_t length = pread(messages_, message.data(), message.size() - 1, 0);
  std::string text(message.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  text = text.substr(0, text.find('\n'));
  throw std::runtime_error(fmt::format("{}: ffmpeg could not write it: {}", file_.string(),
                                       text.empty() ? "it gave no reason" : text));
}

}  // namespace lab::runner
