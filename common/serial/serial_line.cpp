#include "common/serial/serial_line.hpp"

#include <fcntl.h>
#include <grp.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "common/serial/serial.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<int, speed_t>, 12> kSpeeds{{{9600, B9600},
                                                           {19200, B19200},
                                                           {38400, B38400},
                                                           {57600, B57600},
                                                           {115200, B115200},
                                                           {230400, B230400},
                                                           {460800, B460800},
                                                           {500000, B500000},
                                                           {576000, B576000},
                                                           {921600, B921600},
                                                           {1000000, B1000000},
                                                           {2000000, B2000000}}};

speed_t speedOf(int baud) {
  for (const auto& [number, speed] : kSpeeds) {
    if (number == baud) return speed;
  }
  return B0;
}

std::string groupOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return "dialout";
  const group* entry = getgrgid(status.st_gid);
  return entry != nullptr ? entry->gr_name : "dialout";
}

/// Whether the path can be a terminal. Opening another device can already have an effect, so this
/// is known before: pseudo terminals by their number, others by the kernel's class of devices.
bool mayBeTerminal(const std::string& path) {
  constexpr unsigned kFirstPts = 136;  // Documentation/admin-guide/devices.txt of Linux
  constexpr unsigned kLastPts = 143;
  struct stat facts {};
  if (stat(path.c_str(), &facts) != 0) return true;  // open() reports why
  // Opening a file or a folder has no effect, and isatty() refuses it.
  if (!S_ISCHR(facts.st_mode)) return S_ISREG(facts.st_mode) || S_ISDIR(facts.st_mode);
  const unsigned type = major(facts.st_rdev);
  if (type >= kFirstPts && type <= kLastPts) return true;
  std::error_code error;
  const fs::path kind = fs::read_symlink("/sys/dev/char/" + std::to_string(type) + ":" +
                                             std::to_string(minor(facts.st_rdev)) + "/subsystem",
                                         error);
  return error || kind.filename() == "tty";
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw SerialError(path + ": " + what);
}

[[noreturn]] void failInUse(const std::string& path) {
  const std::string holder = lineHolder(path);
  fail(path, "in use by " + (holder.empty() ? "another process" : holder) +
                 "; end that, or take another line");
}

[[noreturn]] void failToOpen(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      fail(path, "not there; plug it in, or see what is: robot_bridge --list");
    case EACCES:
    case EPERM:
      fail(path, "no permission; join the group that has it and log in again: sudo usermod -aG " +
                     groupOf(path) + " $USER");
    case EBUSY:
      failInUse(path);
    case EISDIR:
    case ENOTDIR:
      fail(path, "not a serial device");
    case EIO:
      fail(path, "gone (unplugged or switched off)");
    default:
      fail(path, std::string("cannot be opened: ") + std::strerror(error));
  }
}

/// Requests low latency: USB adapters otherwise delay bytes by up to 16 ms. Lines without this
/// setting ignore the request.
void askForLowLatency(int descriptor) {
  serial_struct settings{};
  if (ioctl(descriptor, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  static_cast<void>(ioctl(descriptor, TIOCSSERIAL, &settings));
}

/// Pseudo terminals do not get TIOCEXCL, which would outlast the process; only the lock protects
/// them.
bool isPseudoTerminal(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return false;
  const unsigned number = major(status.st_rdev);
  return S_ISCHR(status.st_mode) && number >= 136 && number <= 143;  // Linux: devices.txt
}

std::string describeProcess(const std::string& pid) {
  if (pid == std::to_string(getpid())) return "this process";
  std::string name;
  std::getline(std::ifstream("/proc/" + pid + "/comm"), name);
  return name.empty() ? "" : name + " (pid " + pid + ")";
}

/// The process that holds a flock on this file, from /proc/locks.
std::string lockHolder(const struct stat& file) {
  std::ifstream locks("/proc/locks");
  std::array<char, 64> key{};
  std::snprintf(key.data(), key.size(), "%02x:%02x:%lu", major(file.st_dev), minor(file.st_dev),
                static_cast<unsigned long>(file.st_ino));
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advisory, access, pid, inode;
    words >> number >> kind >> advisory >> access >> pid >> inode;
    if (kind == "FLOCK" && inode == key.data()) return describeProcess(pid);
  }
  return {};
}

/// The entries of a folder of /proc; none where it is not readable (processes of other users) or
/// where the process ends meanwhile.
std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  return entries;
}

}  // namespace

int makeRaw(int descriptor, int baud) {
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) return ENOTTY;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~(HUPCL | CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 1;  // with 0, read() could not tell "no bytes" from "hung up"
  settings.c_cc[VTIME] = 0;
  if (baud != 0) {
    const speed_t speed = speedOf(baud);
    if (speed == B0) return EINVAL;
    cfsetispeed(&settings, speed);
    cfsetospeed(&settings, speed);
  }
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) return errno;
  termios in_force{};  // tcsetattr() succeeds if it changed any of the settings
  if (tcgetattr(descriptor, &in_force) != 0) return errno;
  return cfgetospeed(&in_force) == cfgetospeed(&settings) ? 0 : EINVAL;
}

FileDescriptor openSerialLine(const std::string& path, int baud) {
  if (!mayBeTerminal(path)) fail(path, "not a serial device");
  FileDescriptor line(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (line.get() < 0) failToOpen(path, errno);
  // The lock comes first, because a process without it must not change the line's settings.
  if (flock(line.get(), LOCK_EX | LOCK_NB) != 0) failInUse(path);
  if (isatty(line.get()) == 0) fail(path, "not a serial device");
  int exclusive = 0;
  if (ioctl(line.get(), TIOCGEXCL, &exclusive) == 0 && exclusive != 0) {
    flock(line.get(), LOCK_UN);  // otherwise the error would name this process as the holder
    failInUse(path);
  }
  if (!isPseudoTerminal(line.get())) static_cast<void>(ioctl(line.get(), TIOCEXCL));
  switch (const int error = makeRaw(line.get(), baud)) {
    case 0:
      break;
    case EINVAL:
      fail(path, "no speed of " + std::to_string(baud) + " baud; the robot's are 38400 and 500000");
    default:
      failToOpen(path, error);
  }
  tcflush(line.get(), TCIOFLUSH);
  askForLowLatency(line.get());
  return line;
}

std::string firstThatIsNoTerminal(const std::string& names) {
  std::istringstream words(names);
  for (std::string name; words >> name;) {
    if (name.find_first_of("*?[\\") != std::string::npos) continue;
    std::error_code error;
    const bool there = fs::exists(name, error) && !error;
    if (there && !(fs::is_character_file(name, error) && mayBeTerminal(name))) return name;
  }
  return {};
}

std::string lineHolder(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0) return {};
  std::string holder = lockHolder(file);
  if (!holder.empty()) return holder;
  for (const auto& process : entriesOf("/proc")) {
    const std::string pid = process.filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos ||
        pid == std::to_string(getpid())) {
      continue;
    }
    for (const auto& descriptor : entriesOf(process / "fd")) {
      struct stat open_file {};
      if (stat(descriptor.c_str(), &open_file) == 0 && open_file.st_rdev == file.st_rdev &&
          open_file.st_ino == file.st_ino && open_file.st_dev == file.st_dev) {
        return describeProcess(pid);
      }
    }
  }
  return {};
}

}  // namespace lab
