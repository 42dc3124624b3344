// docs/scripting.md contains the example programs, and both work with a live lab.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <lab/light_status_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

const fs::path kRoot = LAB_ROOT;

/// The intensities that one sender has shown, in order.
std::vector<double> shownBy(const std::string& commander, const fs::path& log) {
  std::vector<double> shown;
  readLog({log}, [&](const Packet& packet) {
    light_status_t status{};
    if (packet.channel != channels::kLightStatus || !decode(packet.data, status)) return;
    if (status.commander != commander || status.layers.empty()) return;
    const double intensity = status.layers.front().intensity;
    if (shown.empty() || shown.back() != intensity) shown.push_back(intensity);
  });
  return shown;
}

class Scripting : public testing::Test {
 protected:
  Scripting() { setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }

  /// Runs a live lab, and `program` with the LCM URL as argument, which overrides the light of the
  /// script.
  Finished overrideLight(const std::string& program) {
    Background lab("exec lab run " + experiment("light_switching").string() +
                   " --no-report --set duration_s=12 --out " + (folder_.path() / "runs").string());
    if (!waitUntil([&lab] { return lab.output().find("running") != std::string::npos; },
                   milliseconds(60'000))) {
      ADD_FAILURE() << lab.output();
      return {};
    }
    const std::string text = lab.output();
    const std::size_t begin = text.find("udpm://");
    const std::string url = text.substr(begin, text.find_first_of(" \n", begin) - begin);
    Finished finished = run(program + " '" + url + "'", seconds(60));
    EXPECT_EQ(lab.wait(seconds(60)).exit_code, 0) << lab.output();
    return finished;
  }

  [[nodiscard]] fs::path log() const { return onlyRun(folder_.path() / "runs") / "log.lcmlog"; }
  [[nodiscard]] const fs::path& folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
};

TEST(ScriptingPage, ContainsTheExamplePrograms) {
  const std::string page = readFile(kRoot / "docs" / "scripting.md");
  for (const char* file :
       {"docs/examples/light_switching.sh", "docs/examples/light_switching.py"}) {
    EXPECT_TRUE(page.find(readFile(kRoot / file)) != std::string::npos)
        << file << " must be contained in docs/scripting.md verbatim";
  }
}

TEST_F(Scripting, TheShellScriptShowsItsLights) {
  const std::string script = (kRoot / "docs/examples" / "light_switching.sh").string();
  const Finished shell = overrideLight("LAB=lab sh " + script + " 1 #");
  EXPECT_EQ(shell.exit_code, 0) << shell.output;
  EXPECT_THAT(shownBy("lab_light", log()), testing::ElementsAre(0.2, 0.5, 0.9));
}

TEST_F(Scripting, ThePythonProgramShowsItsLightsAndReceivesRobotStatus) {
  if (run("python3 -c 'import socket, struct'").exit_code != 0) {
    GTEST_SKIP() << "python3 is not installed: apt-get install python3-minimal";
  }
  const fs::path types = folder() / "python";
  fs::create_directories(types);
  const Finished generated =
      run("lcm-gen -p --ppath " + types.string() + " " + (kRoot / "lcmtypes").string() + "/*.lcm");
  ASSERT_EQ(generated.exit_code, 0) << generated.output;
  const Finished python =
      overrideLight("PYTHONPATH=" + types.string() + " PYTHONDONTWRITEBYTECODE=1 python3 " +
                    (kRoot / "docs/examples" / "light_switching.py").string() + " --hold 1.5");
  EXPECT_EQ(python.exit_code, 0) << python.output;
  EXPECT_THAT(shownBy("light_switching.py", log()), testing::ElementsAre(0.2, 0.5, 0.9));
  EXPECT_THAT(python.output, HasSubstr("dim: BP: shown after"));
  for (const char* program : {"bp", "abp", "rtp"}) {
    std::string all;
    for (int robot = 1; robot <= 6; ++robot) {
      all += (robot > 1 ? ", (" : "(") + std::to_string(robot) + ", '" + program + "')";
    }
    EXPECT_THAT(python.output, HasSubstr("programs now [" + all + "]"));
  }
}

}  // namespace
}  // namespace lab::system_test
