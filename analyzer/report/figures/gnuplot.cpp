#include "analyzer/report/figures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "analyzer/report_error.hpp"
#include "common/files/file_text.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

constexpr const char* kScript = "figures.gp";
constexpr const char* kMessages = "gnuplot.txt";
constexpr std::string_view kTitle = "<title>";
constexpr std::string_view kTitleEnd = "</title>";

/// Starts gnuplot in `folder` and in a clean environment, with its messages in a file.
pid_t start(const fs::path& folder, const fs::path& script, const fs::path& messages) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  for (const int descriptor : {1, 2}) {
    posix_spawn_file_actions_addopen(&actions, descriptor, messages.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
  }
  std::string program = "gnuplot";
  std::string defaults = "--default-settings";
  std::string file = script.string();
  std::array<char*, 4> arguments{program.data(), defaults.data(), file.data(), nullptr};
  std::string locale = "LC_ALL=C";
  std::string zone = "TZ=UTC";
  std::array<char*, 3> environment{locale.data(), zone.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(),
                                 environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT || error == EACCES) {
    throw ReportError(
        "gnuplot, which draws the figures, is not installed; get it with "
        "'sudo apt-get install gnuplot-nox' and analyze the run again");
  }
  if (error != 0) throw ReportError(fmt::format("cannot start gnuplot: {}", std::strerror(error)));
  return child;
}

bool succeeded(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return false;
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void replaceAll(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

void runGnuplot(const fs::path& folder, const std::string& script) {
  const fs::path file = fs::absolute(folder / kScript);
  const fs::path messages = fs::absolute(folder / kMessages);
  std::ofstream(file, std::ios::binary) << script;
  const bool done = succeeded(start(folder, file, messages));
  const std::string output = readWholeFile(messages).value_or("");
  fs::remove(file);
  fs::remove(messages);
  if (!done) {
    throw ReportError(fmt::format("gnuplot could not draw the figures: {}", output.substr(0, 500)));
  }
}

std::string gnuplotText(std::string_view text) {
  std::string quoted = "'";
  for (const char letter : text) {
    switch (letter) {
      case '\'':
        quoted += "’";
        break;
      case '<':
        quoted += "‹";
        break;
      case '>':
        quoted += "›";
        break;
      case '&':
        quoted += "+";
        break;
      default:
        quoted += static_cast<unsigned char>(letter) < 0x20 ? ' ' : letter;
    }
  }
  return quoted + "'";
}

std::string tidySvg(const std::string& svg, const std::string& title) {
  std::string tidy;
  std::size_t at = 0;
  while (true) {
    const std::size_t begin = svg.find(kTitle, at);
    const std::size_t end = svg.find(kTitleEnd, begin);
    if (end == std::string::npos) break;
    tidy += svg.substr(at, begin - at);
    if (at == 0) tidy += fmt::format("{}{}{}", kTitle, escapeHtml(title), kTitleEnd);
    at = end + kTitleEnd.size();
  }
  tidy += svg.substr(at);
  replaceAll(tidy, "font-family=\"Arial\"", "font-family=\"Helvetica, Arial, sans-serif\"");
  return tidy;
}

std::string undatedPdf(std::string pdf) {
  constexpr std::string_view kDate = "/CreationDate (";
  const std::size_t begin = pdf.find(kDate);
  const std::size_t end = pdf.find(')', begin);
  if (begin == std::string::npos || end == std::string::npos) return pdf;
  // Replaced by blanks, because the offsets of later objects are in the table of the file.
  std::fill(pdf.begin() + static_cast<std::ptrdiff_t>(begin),
            pdf.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
  return pdf;
}

std::string inlineSvg(const std::string& svg, const std::string& prefix) {
  const std::size_t begin = svg.find("<svg");
  std::string element = begin == std::string::npos ? "" : svg.substr(begin);
  replaceAll(element, "id='", fmt::format("id='{}", prefix));
  replaceAll(element, "id=\"", fmt::format("id=\"{}", prefix));
  replaceAll(element, "href='#", fmt::format("href='#{}", prefix));
  replaceAll(element, "url(#", fmt::format("url(#{}", prefix));
  element.replace(0, 4, "<svg role=\"img\"");
  return element;
}

}  // namespace lab::report
