#include "tests/support/lab_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace lab::system_test {
namespace fs = std::filesystem;

Background::Background(const std::string& command) {
  const std::string output = (folder_.path() / "output").string();
  const std::string line = "exec >'" + output + "' 2>&1; " + command;
  pid_ = fork();
  if (pid_ == 0) {
    setpgid(0, 0);
    const std::string path = std::string(LAB_PROGRAMS) + ":" + std::getenv("PATH");
    setenv("PATH", path.c_str(), 1);
    execl("/bin/bash", "bash", "-c", line.c_str(), nullptr);
    _exit(127);
  }
}

Background::~Background() {
  if (running()) {
    kill(-pid_, SIGTERM);
    if (!waitUntil([this] { return !running(); }, std::chrono::seconds(5))) kill(-pid_, SIGKILL);
  }
  if (!ended_) waitpid(pid_, &status_, 0);
}

void Background::signal(int number) const { kill(pid_, number); }

bool Background::running() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !ended_;
}

std::string Background::output() const {
  const fs::path file = folder_.path() / "output";
  return fs::exists(file) ? readFile(file) : "";
}

Finished Background::wait(std::chrono::seconds timeout) {
  if (!waitUntil([this] { return !running(); }, timeout)) {
    kill(-pid_, SIGKILL);
    waitpid(pid_, &status_, 0);
    ended_ = true;
    return {-SIGKILL, output() + "\n(did not end in time)"};
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_), output()};
}

Finished run(const std::string& command, std::chrono::seconds timeout) {
  return Background(command).wait(timeout);
}

std::string labOutput(const std::string& command, int exit_code) {
  const Finished lab = run("lab " + command);
  EXPECT_EQ(lab.exit_code, exit_code) << lab.output;
  return lab.output;
}

fs::path onlyRun(const fs::path& parent) {
  std::vector<fs::path> runs;
  for (const auto& entry : fs::directory_iterator(parent)) runs.push_back(entry.path());
  if (runs.size() != 1) {
    throw std::runtime_error(std::to_string(runs.size()) + " runs in " + parent.string());
  }
  return runs.front();
}

nlohmann::json readJson(const fs::path& file) { return nlohmann::json::parse(readFile(file)); }

std::vector<pid_t> processesWith(const std::string& text) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    // The process may end between the listing and the read, which then fails. `<<` marks the
    // stream, where an iterator over its buffer would throw.
    std::ostringstream line;
    line << std::ifstream(entry.path() / "cmdline", std::ios::binary).rdbuf();
    if (line.str().find(text) != std::string::npos && std::stoi(name) != getpid()) {
      found.push_back(std::stoi(name));
    }
  }
  return found;
}

std::vector<pid_t> childrenWith(pid_t parent, const std::string& text) {
  std::vector<pid_t> children = processesWith(text);
  std::erase_if(children, [parent](pid_t pid) {
    std::ifstream stream("/proc/" + std::to_string(pid) + "/stat");
    std::string line;
    std::getline(stream, line);
    const auto after_name = line.rfind(')');
    if (after_name == std::string::npos) return true;
    // The text after the name is ") S 123 ...": state and parent.
    return std::stoi(line.substr(after_name + 4)) != parent;
  });
  return children;
}

static std::string shellWait(const std::string& condition) {
  return "for i in $(seq 600); do " + condition + " && break; sleep 0.1; done; ";
}

std::string whenLogHasData(const fs::path& runs) {
  return shellWait("[ $(cat " + runs.string() + "/*/log.lcmlog 2>/dev/null | wc -c) -gt 200000 ]");
}

std::string whenMounted(const fs::path& folder) {
  return shellWait("mountpoint -q " + folder.string());
}

fs::path experiment(const std::string& name) {
  return fs::path(LAB_EXPERIMENTS) / (name + ".toml");
}

}  // namespace lab::system_test
