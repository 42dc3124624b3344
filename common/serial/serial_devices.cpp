#include "common/serial/serial_devices.hpp"

#include <fcntl.h>
#include <glob.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "common/files/own_folder.hpp"
#include "common/serial/serial_line.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kPtyPollPeriod_us = 20'000;

fs::path lockFile(const fs::path& link) {
  return link.parent_path() / ("." + link.filename().string() + ".lock");
}

/// A lock on a whole file, owned by the open file.
struct flock wholeFile(short kind) {
  struct flock lock {};
  lock.l_type = kind;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Whether a link has a lock file that no process has locked: its process has ended.
bool isLeftBehind(const fs::path& link) {
  const FileDescriptor file(::open(lockFile(link).c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (file.get() < 0) return false;
  struct flock lock = wholeFile(F_RDLCK);
  return fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type == F_UNLCK;
}

[[noreturn]] void failToOffer(const fs::path& link, const std::string& what) {
  throw SerialError(link.string() + ": the line cannot be offered: " + what);
}

FileDescriptor takeLock(const fs::path& link) {
  FileDescriptor file(
      ::open(lockFile(link).c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (file.get() < 0) failToOffer(link, std::strerror(errno));
  struct flock lock = wholeFile(F_WRLCK);
  if (fcntl(file.get(), F_OFD_SETLK, &lock) != 0) {
    failToOffer(link, "another process offers it; end that, or take another --ports folder");
  }
  return file;
}

/// A new pseudo terminal without a host, and its name.
std::pair<FileDescriptor, std::string> newTerminal(const fs::path& link) {
  FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 64> name{};
  if (master.get() < 0 || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0 ||
      ptsname_r(master.get(), name.data(), name.size()) != 0) {
    failToOffer(link, std::string("no pseudo terminal: ") + std::strerror(errno));
  }
  // The slave is opened once and made raw; otherwise the terminal would echo, and would store bytes
  // before a host has opened it.
  const FileDescriptor slave(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (slave.get() < 0 || makeRaw(slave.get(), 0) != 0) {
    failToOffer(link, std::string(name.data()) + ": " + std::strerror(errno));
  }
  return {std::move(master), name.data()};
}

}  // namespace

/// The host's end.
class SerialDevices::Device final : public SerialPort {
 public:
  Device(AsioLoop& loop, std::string path, int baud)
      : loop_(loop), path_(std::move(path)), line_(openSerialLine(path_, baud)) {}

  void onReadable(Loop::Callback callback) override {
    watch_ = loop_.watch(line_.get(), std::move(callback));
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const ssize_t count = ::read(line_.get(), bytes.data(), bytes.size());
    if (count == 0 && !bytes.empty())
      throw gone();  // with VMIN = 1, read() returns 0 only after a hang-up
    return countOrGone(count);
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    return countOrGone(::write(line_.get(), bytes.data(), bytes.size()));
  }

 private:
  [[nodiscard]] SerialError gone() const {
    return SerialError(path_ + ": gone (unplugged or switched off)");
  }
  [[nodiscard]] std::size_t countOrGone(ssize_t count) const {
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EAGAIN || errno == EINTR) return 0;
    throw gone();
  }

  AsioLoop& loop_;
  std::string path_;
  FileDescriptor line_;
  std::unique_ptr<AsioLoop::Watch> watch_;  ///< must end before the descriptor is closed
};

/// Polls whether a host has opened the pseudo terminals that have none. A terminal without host is
/// always readable (hung up), so it cannot be watched.
class SerialDevices::PtyMonitor : public std::enable_shared_from_this<PtyMonitor> {
 public:
  explicit PtyMonitor(AsioLoop& loop) : loop_(loop) {}

  void add(Offer* offer) {
    hostless_.push_back(offer);
    if (!polling_) pollLater();
  }
  void remove(Offer* offer) { std::erase(hostless_, offer); }

 private:
  void poll();
  void pollLater() {
    polling_ = true;
    loop_.at(loop_.now() + kPtyPollPeriod_us, [monitor = weak_from_this()] {
      if (const std::shared_ptr<PtyMonitor> here = monitor.lock()) here->poll();
    });
  }

  AsioLoop& loop_;
  std::vector<Offer*> hostless_;
  bool polling_ = false;
};

/// The robot's end.
class SerialDevices::Offer final : public SerialPort {
 public:
  Offer(AsioLoop& loop, std::shared_ptr<PtyMonitor> monitor, fs::path link)
      : loop_(loop), monitor_(std::move(monitor)), link_(std::move(link)), lock_(takeLock(link_)) {
    std::tie(line_, terminal_) = newTerminal(link_);
    const fs::path fresh = link_.parent_path() / ("." + link_.filename().string() + ".new");
    std::error_code error;
    fs::remove(fresh, error);
    fs::create_symlink(terminal_, fresh, error);
    if (!error) fs::rename(fresh, link_, error);
    if (error) failToOffer(link_, error.message());
  }

  ~Offer() override {
    monitor_->remove(this);
    std::error_code ignored;
    fs::remove(link_, ignored);
    fs::remove(lockFile(link_), ignored);
  }

  void onReadable(Loop::Callback callback) override {
    callback_ = std::move(callback);
    waitForHost();  // no host is connected yet
  }

  std::size_t read(std::span<std::uint8_t> bytes) override {
    const ssize_t count = ::read(line_.get(), bytes.data(), bytes.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && errno == EIO && watch_) waitForHost();
    return 0;
  }

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    // Without a host, or if it does not read, the bytes are lost.
    static_cast<void>(!::write(line_.get(), bytes.data(), bytes.size()));
    return bytes.size();
  }

  bool isConnected() const override {
    pollfd end{line_.get(), POLLIN, 0};
    return ::poll(&end, 1, 0) >= 0 && (end.revents & POLLHUP) == 0;
  }

  [[nodiscard]] int descriptor() const { return line_.get(); }
  void onHostConnected() { watch_ = loop_.watch(line_.get(), callback_); }

 private:
  void waitForHost() {
    watch_.reset();
    monitor_->remove(this);
    monitor_->add(this);
  }

  AsioLoop& loop_;
  std::shared_ptr<PtyMonitor> monitor_;
  fs::path link_;
  FileDescriptor lock_;
  FileDescriptor line_;
  std::string terminal_;
  Loop::Callback callback_;
  std::unique_ptr<AsioLoop::Watch> watch_;
};

void SerialDevices::PtyMonitor::poll() {
  polling_ = false;
  std::erase_if(hostless_, [](Offer* offer) {
    pollfd state{offer->descriptor(), POLLIN, 0};
    const bool polled = ::poll(&state, 1, 0) >= 0;
    // POLLIN with POLLHUP: a host was connected and has left bytes.
    const bool there = polled && ((state.revents & POLLHUP) == 0 || (state.revents & POLLIN) != 0);
    if (there) offer->onHostConnected();
    return there;
  });
  if (!hostless_.empty()) pollLater();
}

SerialDevices::SerialDevices(AsioLoop& loop, fs::path offers)
    : loop_(loop), offers_(std::move(offers)), monitor_(std::make_shared<PtyMonitor>(loop)) {}

SerialDevices::~SerialDevices() = default;

std::vector<std::string> SerialDevices::offered() const {
  std::vector<std::string> lines;
  if (!isOwnFolder(offers_)) return lines;  // another user could have put any line there
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(offers_, none)) {
    if (entry.path().filename().string().starts_with('.')) continue;
    std::error_code gone;
    const bool there = entry.is_character_file(gone) && !gone;
    if (there && !isLeftBehind(entry.path())) lines.push_back(entry.path());
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::vector<std::string> SerialDevices::matching(const std::string& pattern) const {
  std::vector<std::string> lines;
  std::set<fs::path> devices;  // one device may have several names
  std::istringstream patterns(pattern);
  for (std::string one; patterns >> one;) {
    glob_t found{};
    if (glob(one.c_str(), 0, nullptr, &found) == 0) {
      for (std::size_t i = 0; i < found.gl_pathc; ++i) {
        std::error_code error;
        const fs::path device = fs::canonical(found.gl_pathv[i], error);
        if (!error && devices.insert(device).second) lines.emplace_back(found.gl_pathv[i]);
      }
    }
    globfree(&found);
  }
  return lines;
}

std::unique_ptr<SerialPort> SerialDevices::open(const std::string& path, int baud) {
  return std::make_unique<Device>(loop_, path, baud);
}

std::unique_ptr<SerialPort> SerialDevices::offer(const std::string& name) {
  std::error_code error;
  fs::create_directories(offers_, error);
  if (error) failToOffer(offers_ / name, error.message());
  if (!isOwnFolder(offers_)) {
    failToOffer(offers_ / name,
                "found a folder of another user, or a link, expected a folder of "
                "yours; take another --ports folder");
  }
  return std::make_unique<Offer>(loop_, monitor_, offers_ / name);
}

}  // namespace lab
