#include "tracker_svc/cameras/encoder_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "common/camera/cameras.hpp"
#include "common/process/pipe.hpp"

namespace lab::cameras {
namespace {

constexpr int kInputPipeBytes = 1 << 20;  // the limit for unprivileged users
constexpr std::chrono::milliseconds kErrorPeriod{20};

}  // namespace

EncoderProcess::EncoderProcess(const std::vector<std::string>& command) {
  try {
    Pipe input = makePipe();
    Pipe errors = makePipe();
    fcntl(input.in.get(), F_SETPIPE_SZ, kInputPipeBytes);
    fcntl(input.in.get(), F_SETFL, fcntl(input.in.get(), F_GETFL) | O_NONBLOCK);
    child_.emplace(ChildSettings{.arguments = command,
                                 .input = input.out.get(),
                                 .errors = errors.in.get(),
                                 .death_signal = 0});
    input_ = std::move(input.in);
    errors_.open(std::move(errors.out));
  } catch (const std::system_error& error) {
    throw CameraError(error.code() == std::errc::no_such_file_or_directory
                          ? "films are written by the program " + command[0] +
                                ", which is not installed: sudo apt install ffmpeg"
                          : command[0] + " does not start: " + error.code().message());
  }
}

EncoderProcess::~EncoderProcess() { finish(); }

bool EncoderProcess::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    std::array<pollfd, 2> ready{pollfd{input_.get(), POLLOUT, 0},
                                pollfd{errors_.descriptor(), POLLIN, 0}};
    if (poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR) return false;
    if (ready[1].revents != 0) errors_.take();
    if (ready[0].revents == 0) continue;
    const ssize_t count = ::write(input_.get(), bytes.data(), bytes.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

int EncoderProcess::finish() {
  input_ = FileDescriptor();
  // It could wait for room in the pipe of its errors.
  while (!child_->waitFor(kErrorPeriod)) errors_.take();
  errors_.take();
  return child_->code();
}

double EncoderProcess::cpu() const {
  // Fields 14 and 15 of proc(5), after the name of the program, which may contain spaces.
  std::ifstream file("/proc/" + std::to_string(child_->pid()) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t name = text.rfind(')');
  if (name == std::string::npos) return 0;
  std::istringstream rest(text.substr(name + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) rest >> skipped;
  double user = 0;
  double system = 0;
  rest >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string EncoderProcess::errorLine() const {
  const std::string text = errors_.text();
  return text.substr(0, text.find_first_of("\r\n"));
}

}  // namespace lab::cameras
