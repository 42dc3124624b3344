/// A virtual X server for tests, and the contents of its screen.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace lab::projector {

/// Runs Xvfb on a free display number and sets DISPLAY. The destructor ends it.
class VirtualX {
 public:
  VirtualX(int width, int height) {
    int ends[2];
    if (pipe(ends) != 0) return;
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);  // even if this process is killed
      const std::string size = std::to_string(width) + "x" + std::to_string(height) + "x24";
      const std::string number = std::to_string(ends[1]);
      dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);
      // -noreset: otherwise the server resets when its last client leaves, and may refuse the
      // window that the next test opens at that moment.
      execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", size.c_str(), "-noreset",
             "-nolisten", "tcp", static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ends[1]);
    std::string number;
    char digit = 0;
    pollfd ready{ends[0], POLLIN, 0};
    while (poll(&ready, 1, kTimeout) == 1 && read(ends[0], &digit, 1) == 1 && digit != '\n') {
      number += digit;
    }
    close(ends[0]);
    if (digit != '\n') return;
    name_ = ":" + number;
    setenv("DISPLAY", name_.c_str(), 1);
    setenv("SDL_VIDEODRIVER", "x11", 1);
  }
  VirtualX(const VirtualX&) = delete;
  VirtualX& operator=(const VirtualX&) = delete;
  ~VirtualX() {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

  /// False if Xvfb is not installed or did not start.
  [[nodiscard]] bool runs() const { return !name_.empty(); }

  /// The pixels of the whole screen, row by row, as 0xRRGGBB.
  [[nodiscard]] std::vector<unsigned> screen() const {
    ::Display* const display = XOpenDisplay(name_.c_str());
    if (display == nullptr) return {};
    const Window root = DefaultRootWindow(display);
    XWindowAttributes size{};
    XGetWindowAttributes(display, root, &size);
    XImage* const image = XGetImage(display, root, 0, 0, static_cast<unsigned>(size.width),
                                    static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
    std::vector<unsigned> pixels;
    for (int y = 0; image != nullptr && y < size.height; ++y) {
      const auto* const row = reinterpret_cast<const unsigned*>(
          image->data + std::ptrdiff_t{y} * image->bytes_per_line);
      for (int x = 0; x < size.width; ++x) pixels.push_back(row[x] & 0xFFFFFF);
    }
    if (image != nullptr) XDestroyImage(image);
    XCloseDisplay(display);
    return pixels;
  }

 private:
  static constexpr int kTimeout = 20'000;  // [ms]

  pid_t process_ = -1;
  std::string name_;
};

}  // namespace lab::projector
