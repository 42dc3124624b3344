#include "runner/lab_registry.hpp"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "runner/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

bool lives(int pid) { return pid > 0 && (kill(pid, 0) == 0 || errno == EPERM); }

std::optional<RunningLab> read(const fs::path& file) {
  std::ifstream stream(file);
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return RunningLab{json.value("name", ""), json.value("url", ""), json.value("pid", 0),
                    json.value("directory", "")};
}

/// In /tmp anyone may have made the folder first: it must be ours and closed to others.
void claim(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw UserError("cannot make " + folder.string() + ": set XDG_RUNTIME_DIR to a folder of yours");
  }
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
      status.st_uid != geteuid()) {
    throw UserError(folder.string() +
                    " belongs to somebody else: set XDG_RUNTIME_DIR to a folder of yours");
  }
}

}  // namespace

fs::path registryDirectory() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime != '\0') return fs::path(runtime) / "active-lab";
  return fs::temp_directory_path() / ("active-lab-" + std::to_string(geteuid()));
}

std::vector<RunningLab> runningLabs() {
  std::vector<RunningLab> labs;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(registryDirectory(), error)) {
    const auto lab = read(entry.path());
    if (lab && lives(lab->pid)) {
      labs.push_back(*lab);
    } else if (lab) {
      fs::remove(entry.path(), error);
    }
  }
  return labs;
}

RunningLab findLab(const std::string& name) {
  const std::vector<RunningLab> labs = runningLabs();
  std::string names;
  for (const RunningLab& lab : labs) {
    if (lab.name == name || (name.empty() && labs.size() == 1)) return lab;
    names += (names.empty() ? "" : ", ") + lab.name;
  }
  if (labs.empty()) throw UserError("no lab runs on this machine: start one with lab run FILE");
  throw UserError(name.empty() ? "several labs run; say which with --lab NAME: " + names
                               : "no lab named " + name + " runs; these do: " + names);
}

Registration::Registration(const RunningLab& lab)
    : file_(registryDirectory() / (std::to_string(lab.pid) + ".json")) {
  claim(registryDirectory());
  std::ofstream stream(file_);
  stream << nlohmann::json{{"name", lab.name},
                           {"url", lab.url},
                           {"pid", lab.pid},
                           {"directory", lab.directory}}
                .dump(2)
         << std::endl;
  if (!stream) throw UserError("cannot write " + file_.string());
}

Registration::~Registration() {
  std::error_code error;
  fs::remove(file_, error);
}

}  // namespace lab::runner
