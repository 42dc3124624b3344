#include "common/process/running_labs.hpp"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/files/file_text.hpp"
#include "common/files/own_folder.hpp"
#include "common/text/json_text.hpp"

namespace lab {
namespace fs = std::filesystem;
namespace {

constexpr FileKind kRegistration{"the registration of a lab", 64'000};

std::optional<RunningLab> read(const fs::path& file) {
  const std::optional<std::string> text = readWholeFile(file, kRegistration);
  if (!text) return std::nullopt;
  const nlohmann::json json = parseJsonText(*text);
  try {
    return RunningLab{json.at("name"), json.at("url"), json.at("pid"), json.at("directory"),
                      json.at("replay")};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // not a registration
  }
}

/// Whether this is a file of a dead runner: "4711.json", "4711.web", "4711.web.txt".
bool isLeftOver(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::string owner = name.substr(0, name.find('.'));
  int pid = 0;
  const auto [end, error] = std::from_chars(owner.data(), owner.data() + owner.size(), pid);
  const bool named_by_pid = error == std::errc{} && end == owner.data() + owner.size();
  return named_by_pid && !processLives(pid);
}

}  // namespace

fs::path registryDirectory() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return fs::path(runtime) / "active-lab";
  return fs::temp_directory_path() / ("active-lab-" + std::to_string(geteuid()));
}

bool processLives(int pid) { return pid > 0 && (kill(pid, 0) == 0 || errno == EPERM); }

std::vector<RunningLab> runningLabs() {
  std::vector<RunningLab> labs;
  const fs::path folder = registryDirectory();
  if (!isOwnFolder(folder)) return labs;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (isLeftOver(entry.path())) {
      fs::remove(entry.path(), error);
      continue;
    }
    if (entry.path().extension() != ".json") continue;
    const auto lab = read(entry.path());
    if (lab && processLives(lab->pid)) {
      labs.push_back(*lab);
    } else if (lab) {
      fs::remove(entry.path(), error);
    }
  }
  return labs;
}

std::string pageOf(const RunningLab& lab) {
  const fs::path folder = registryDirectory();
  if (!isOwnFolder(folder)) return "";
  const std::string text =
      readWholeFile(folder / (std::to_string(lab.pid) + kPageFile), kRegistration).value_or("");
  return text.starts_with("http://") ? text.substr(0, text.find('\n')) : "";
}

}  // namespace lab
