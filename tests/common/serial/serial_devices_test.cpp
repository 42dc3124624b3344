// Properties of devices and pseudo terminals: other processes, permissions, speeds, descriptors.
#include "common/serial/serial_devices.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>

#include "common/serial/serial_line.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

/// Another process, which runs until this object is destroyed.
class OtherProcess {
 public:
  explicit OtherProcess(const std::function<void()>& work) {
    std::array<int, 2> ready{};
    EXPECT_EQ(pipe(ready.data()), 0);
    pid_ = fork();
    if (pid_ == 0) {
      work();
      static_cast<void>(!write(ready[1], "r", 1));
      pause();
      _exit(0);
    }
    close(ready[1]);
    char letter = 0;
    EXPECT_EQ(read(ready[0], &letter, 1), 1) << "the other process ended early";
    close(ready[0]);
  }
  ~OtherProcess() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;

  [[nodiscard]] std::string pid() const { return std::to_string(pid_); }

 private:
  pid_t pid_;
};

class SerialDevicesTest : public testing::Test {
 protected:
  std::string complaint(const std::string& path, int baud = 38400) {
    try {
      static_cast<void>(dut.open(path, baud));
    } catch (const SerialError& error) {
      return error.what();
    }
    return "opened";
  }

  /// The error message for a user without privileges.
  std::string complaintOfNobody(const std::string& path) {
    std::array<int, 2> result{};
    EXPECT_EQ(pipe(result.data()), 0);
    const pid_t pid = fork();
    if (pid == 0) {
      if (geteuid() == 0 && seteuid(65534) != 0) _exit(1);
      const std::string text = complaint(path);
      static_cast<void>(!write(result[1], text.data(), text.size()));
      _exit(0);
    }
    close(result[1]);
    std::array<char, 500> text{};
    const ssize_t size = read(result[0], text.data(), text.size());
    close(result[0]);
    waitpid(pid, nullptr, 0);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "nothing";
  }

  static std::size_t openDescriptors() {
    const fs::directory_iterator all("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  TemporaryFolder folder;
  AsioLoop loop;
  SerialDevices dut{loop, folder / "ports"};
};

TEST_F(SerialDevicesTest, CreatesTheFolderWhenALineIsOffered) {
  EXPECT_FALSE(fs::exists(folder / "ports"));
  const auto port = dut.offer("robot_1");
  EXPECT_TRUE(fs::is_symlink(folder / "ports" / "robot_1"));
}

TEST_F(SerialDevicesTest, NamesTheProcessThatHasOpenedALine) {
  const auto robot = dut.offer("robot_1");
  const std::string path = dut.offered().at(0);
  OtherProcess other([&path] { openSerialLine(path, 38400).release(); });
  EXPECT_THAT(complaint(path), HasSubstr("in use by test_common (pid " + other.pid() + ")"));
  EXPECT_THAT(lineHolder(path), HasSubstr(other.pid()));
}

TEST_F(SerialDevicesTest, RespectsExclusiveModeWithoutLock) {
  const auto robot = dut.offer("robot_1");
  const std::string path = dut.offered().at(0);
  OtherProcess other([&path] { ioctl(open(path.c_str(), O_RDWR | O_NOCTTY), TIOCEXCL); });
  EXPECT_THAT(complaint(path), HasSubstr("in use by test_common (pid " + other.pid() + ")"));
}

TEST_F(SerialDevicesTest, DoesNotChangeTheSettingsOfALineInUse) {
  const auto robot = dut.offer("robot_1");
  const std::string path = dut.offered().at(0);
  const FileDescriptor other = openSerialLine(path, 500000);
  EXPECT_NE(complaint(path, 38400), "opened");
  termios settings{};
  ASSERT_EQ(tcgetattr(other.get(), &settings), 0);
  EXPECT_EQ(cfgetospeed(&settings), static_cast<speed_t>(B500000));
}

TEST_F(SerialDevicesTest, ALineIsFreeAfterItsHolderWasKilled) {
  const auto robot = dut.offer("robot_1");
  const std::string path = dut.offered().at(0);
  {
    OtherProcess other([&path] { openSerialLine(path, 38400).release(); });
  }
  EXPECT_EQ(complaint(path), "opened");
  // Also for processes that exclusive mode would refuse.
  fs::permissions(folder / ".", fs::perms::all);
  fs::permissions(path, fs::perms::all);
  EXPECT_EQ(complaintOfNobody(path), "opened");
}

TEST_F(SerialDevicesTest, TellsHowToGetPermission) {
  const std::string path = folder / "device";
  std::ofstream(path) << "";
  fs::permissions(path, fs::perms::none);
  fs::permissions(folder / ".", fs::perms::all);
  const std::string text = complaintOfNobody(path);
  EXPECT_THAT(text, HasSubstr(path + ": no permission"));
  EXPECT_THAT(text, HasSubstr("sudo usermod -aG "));
}

TEST_F(SerialDevicesTest, RefusesOtherFiles) {
  const std::string file = folder / "file";
  std::ofstream(file) << "text";
  EXPECT_EQ(complaint(file), file + ": not a serial device");
  EXPECT_THAT(complaint(folder / "."), HasSubstr("not a serial device"));
  EXPECT_EQ(complaint("/dev/null"), "/dev/null: not a serial device");
}

TEST_F(SerialDevicesTest, OpensNoPipe) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  EXPECT_EQ(complaint(pipe), pipe + ": not a serial device");
  pollfd end{reader, POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, 0), 0) << "a writer that was there would leave a hang-up";
  close(reader);
}

TEST_F(SerialDevicesTest, FindsNamesOfOtherThingsWithoutOpeningThem) {
  const auto robot = dut.offer("robot_1");
  const std::string line = dut.offered().at(0);
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::ofstream(folder / "file") << "text";

  EXPECT_EQ(firstThatIsNoTerminal("/dev/none " + line + " /dev/nul?"), "");
  for (const std::string& name : {std::string("/dev/null"), (folder / "pipe").string(),
                                  (folder / "file").string(), (folder / ".").string()}) {
    EXPECT_EQ(firstThatIsNoTerminal(line + " " + name + " /dev/zero"), name);
  }
}

TEST_F(SerialDevicesTest, RefusesAnUnknownSpeed) {
  const auto robot = dut.offer("robot_1");
  const std::string path = dut.offered().at(0);
  EXPECT_THAT(complaint(path, 12345), HasSubstr("no speed of 12345 baud"));
  for (const int baud : {9600, 38400, 500000}) EXPECT_EQ(complaint(path, baud), "opened");
}

TEST_F(SerialDevicesTest, ALineIsRawAndKeepsItsModemLines) {
  const auto robot = dut.offer("robot_1");
  const FileDescriptor line = openSerialLine(dut.offered().at(0), 38400);
  termios settings{};
  ASSERT_EQ(tcgetattr(line.get(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG), 0U);
  EXPECT_EQ(settings.c_iflag & static_cast<tcflag_t>(IXON | ICRNL | ISTRIP), 0U);
  EXPECT_EQ(settings.c_cflag & static_cast<tcflag_t>(HUPCL | CRTSCTS), 0U);
  EXPECT_NE(settings.c_cflag & static_cast<tcflag_t>(CLOCAL), 0U);
  EXPECT_EQ(settings.c_cc[VMIN], 1);
}

TEST_F(SerialDevicesTest, IgnoresAndReplacesLinksOfAKilledProcess) {
  std::string terminal;
  {
    OtherProcess other([this] {
      AsioLoop its_loop;
      SerialDevices its(its_loop, folder / "ports");
      static_cast<void>(its.offer("robot_1").release());
      static_cast<void>(its.offer("robot_2").release());
    });
    EXPECT_THAT(dut.offered(), ElementsAre(EndsWith("robot_1"), EndsWith("robot_2")));
    try {
      static_cast<void>(dut.offer("robot_1"));
      FAIL() << "two processes offer one name";
    } catch (const SerialError& error) {
      EXPECT_THAT(error.what(), HasSubstr("another process offers it"));
    }
  }
  ASSERT_TRUE(fs::is_symlink(folder / "ports" / "robot_1"));
  // An old link may lead to a new terminal of another program, here that of robot_2.
  const auto second = dut.offer("robot_2");
  fs::remove(folder / "ports" / "robot_1");
  fs::create_symlink(fs::read_symlink(folder / "ports" / "robot_2"), folder / "ports" / "robot_1");
  EXPECT_THAT(dut.offered(), ElementsAre(EndsWith("robot_2")));
  const auto first = dut.offer("robot_1");
  EXPECT_THAT(dut.offered(), ElementsAre(EndsWith("robot_1"), EndsWith("robot_2")));
}

TEST_F(SerialDevicesTest, UsesNoFolderOfAnotherUser) {
  constexpr uid_t kNobody = 65534;
  const fs::path ports = folder / "ports";
  const auto robot = dut.offer("robot_1");
  // Only root may give a folder away. Others test the link, which may lead to any folder.
  if (chown(ports.c_str(), kNobody, static_cast<gid_t>(-1)) != 0) {
    fs::rename(ports, folder / "theirs");
    fs::create_directory_symlink(folder / "theirs", ports);
  }
  EXPECT_THAT(dut.offered(), IsEmpty());
  try {
    static_cast<void>(dut.offer("robot_2"));
    FAIL() << "offers a line in a folder of another user";
  } catch (const SerialError& error) {
    EXPECT_THAT(error.what(), HasSubstr("take another --ports folder"));
  }
  EXPECT_FALSE(fs::is_symlink(ports / "robot_2"));
}

TEST_F(SerialDevicesTest, FollowsNoLinkAtTheNameOfALock) {
  fs::create_directories(folder / "ports");
  fs::create_symlink(folder / "made", folder / "ports" / ".robot_1.lock");
  EXPECT_THROW(static_cast<void>(dut.offer("robot_1")), SerialError);
  EXPECT_FALSE(fs::exists(folder / "made"));
}

TEST_F(SerialDevicesTest, FindsLinksOfOtherProcesses) {
  fs::create_directories(folder / "ports");
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_EQ(unlockpt(master), 0);
  fs::create_symlink(ptsname(master), folder / "ports" / "emulated");
  fs::create_symlink(folder / "nothing", folder / "ports" / "broken");
  EXPECT_THAT(dut.offered(), ElementsAre(EndsWith("emulated")));
  close(master);
  EXPECT_THAT(dut.offered(), IsEmpty());
}

TEST_F(SerialDevicesTest, ARobotWithoutHostGetsNoCallbacks) {
  const auto robot = dut.offer("robot_1");
  int calls = 0;
  robot->onReadable([&] {
    ++calls;
    std::array<std::uint8_t, 8> bytes{};
    static_cast<void>(robot->read(bytes));
  });
  { const auto host = dut.open(dut.offered().at(0), 38400); }
  loop.at(loop.now() + 200'000, [this] { loop.stop(); });
  loop.run();
  EXPECT_LE(calls, 2);
}

TEST_F(SerialDevicesTest, LeaksNoDescriptors) {
  const auto cycle = [this](const std::string& name) {
    auto robot = dut.offer(name);
    robot->onReadable([] {});
    auto host = dut.open(dut.offered().at(0), 38400);
    host->onReadable([] {});
    EXPECT_NE(complaint(dut.offered().at(0)), "opened");
    if (name == "robot_1") robot.reset();  // either end first
    host.reset();
  };
  cycle("robot_0");
  const std::size_t before = openDescriptors();
  for (int i = 0; i < 100; ++i) cycle("robot_" + std::to_string(i % 3));
  EXPECT_EQ(openDescriptors(), before);
  EXPECT_THAT(fs::directory_iterator(folder / "ports"), fs::directory_iterator());
}

}  // namespace
}  // namespace lab
