#include "tracker_svc/cameras/media_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <functional>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/camera/cameras.hpp"
#include "common/process/pipe.hpp"

namespace lab::cameras {
namespace {

constexpr int kPipeBytes = 1 << 20;  // the limit for unprivileged users
constexpr std::chrono::milliseconds kTakePeriod{20};
constexpr std::size_t kPieceBytes = 1 << 16;

}  // namespace

MediaProcess::MediaProcess(const std::vector<std::string>& command, const std::string& for_what,
                           const std::string& package)
    : reader_(for_what + " " + command[0]) {
  try {
    Pipe output = makePipe();
    Pipe errors = makePipe();
    fcntl(output.out.get(), F_SETPIPE_SZ, kPipeBytes);
    child_.emplace(
        ChildSettings{.arguments = command, .output = output.in.get(), .errors = errors.in.get()});
    output_ = std::move(output.out);
    errors_.open(std::move(errors.out));
  } catch (const std::system_error& error) {
    throw CameraError(error.code() == std::errc::no_such_file_or_directory
                          ? for_what + " the program " + command[0] +
                                ", which is not installed: sudo apt install " + package
                          : reader_ + ", which does not start: " + error.code().message());
  }
}

MediaProcess::~MediaProcess() {
  kill();
  output_ = FileDescriptor();
  finish();
}

std::size_t MediaProcess::read(std::span<std::uint8_t> bytes) {
  std::size_t got = 0;
  while (got < bytes.size()) {
    std::array<pollfd, 2> ready{pollfd{output_.get(), POLLIN, 0},
                                pollfd{errors_.descriptor(), POLLIN, 0}};
    if (poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR) break;
    if (ready[1].revents != 0) errors_.take();
    if (ready[0].revents == 0) continue;
    const ssize_t count = ::read(output_.get(), bytes.data() + got, bytes.size() - got);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    got += static_cast<std::size_t>(count);
  }
  return got;
}

std::string MediaProcess::readAll() {
  std::string all;
  readPieces([&](std::string_view piece) {
    all += piece;
    requireFew(all.size(), "its answer");
    return true;
  });
  return all;
}

void MediaProcess::readLines(const std::function<bool(std::string_view)>& take) {
  std::string begun;  // the line whose end has not come yet
  bool more = true;
  readPieces([&](std::string_view piece) {
    for (std::size_t end = piece.find('\n'); more && end != std::string_view::npos;
         end = piece.find('\n')) {
      begun += piece.substr(0, end);
      more = take(begun);
      begun.clear();
      piece.remove_prefix(end + 1);
    }
    begun += piece;
    requireFew(begun.size(), "a line of its answer");
    return more;
  });
  if (more && !begun.empty()) take(begun);
}

void MediaProcess::readPieces(const std::function<bool(std::string_view)>& take) {
  std::vector<std::uint8_t> piece(kPieceBytes);
  for (std::size_t count = piece.size(); count == piece.size();) {
    count = read(piece);
    if (!take({reinterpret_cast<const char*>(piece.data()), count})) return;
  }
}

void MediaProcess::requireFew(std::size_t bytes, const char* what) const {
  if (bytes <= kMostAnswerBytes) return;
  throw CameraError(reader_ + ": found more than 1 MB in " + what +
                    ", expected less: is the file damaged?");
}

int MediaProcess::finish() {
  // It could wait for room in the pipe of its errors.
  while (!child_->waitFor(kTakePeriod)) errors_.take();
  errors_.take();
  return child_->code();
}

void MediaProcess::kill() { child_->signalGroup(SIGKILL); }

std::string MediaProcess::lastErrorLine() const {
  std::string text = errors();
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t line = text.find_last_of("\r\n");
  return line == std::string::npos ? text : text.substr(line + 1);
}

}  // namespace lab::cameras
