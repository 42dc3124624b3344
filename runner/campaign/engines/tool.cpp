#include "runner/campaign/engines/tool.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>

#include "common/process/child_process.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/local_engine.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::chrono::milliseconds kPollInterrupt{200};

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File temporaryFile() {
  File file(std::tmpfile(), std::fclose);
  if (!file) throw std::system_error(errno, std::generic_category(), "cannot make a file");
  return file;
}

std::string contentOf(std::FILE* file) {
  std::string text;
  std::rewind(file);
  std::array<char, 4096> buffer{};
  while (const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), file)) {
    text.append(buffer.data(), read);
  }
  return text;
}

}  // namespace

std::string ToolEnd::lastLine() const {
  std::string text = errors.empty() ? output : errors;
  while (text.ends_with('\n')) text.pop_back();
  return printable(text.substr(text.find_last_of('\n') + 1));
}

ToolEnd runTool(const std::vector<std::string>& arguments) {
  const File output = temporaryFile();
  const File errors = temporaryFile();
  try {
    ChildProcess child({.arguments = arguments,
                        .output = fileno(output.get()),
                        .errors = fileno(errors.get()),
                        .group = ChildSettings::Group::kSeparate});
    bool interrupted = false;
    while (!child.waitFor(kPollInterrupt)) {
      if (!wasInterrupted()) continue;
      interrupted = true;
      child.signalGroup(SIGKILL);
    }
    return {child.code(), contentOf(output.get()), contentOf(errors.get()), interrupted};
  } catch (const std::system_error& error) {
    throw UserError(fmt::format("{}: {}; is it installed?", arguments.front(), error.what()));
  }
}

}  // namespace lab::runner::campaign
