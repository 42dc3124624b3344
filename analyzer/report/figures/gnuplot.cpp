#include "analyzer/report/figures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

#include "analyzer/report_error.hpp"
#include "common/files/file_text.hpp"
#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace fs = std::filesystem;
namespace {

constexpr const char* kScript = "figures.gp";
constexpr const char* kMessages = "gnuplot.txt";
constexpr std::string_view kTitle = "<title>";
constexpr std::string_view kTitleEnd = "</title>";

/// Runs gnuplot in `folder` and in a clean environment, with its messages in a file.
/// @return whether it succeeded
bool draws(const fs::path& folder, const fs::path& script, const fs::path& messages) {
  const FileDescriptor file(
      open(messages.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (file.get() < 0) {
    throw ReportError(fmt::format("cannot write {}: {}", messages.string(), std::strerror(errno)));
  }
  try {
    ChildProcess gnuplot({.arguments = {"gnuplot", "--default-settings", script.string()},
                          .environment = std::vector<std::string>{"LC_ALL=C", "TZ=UTC"},
                          .folder = folder.string(),
                          .input = ChildSettings::kInherited,
                          .output = file.get(),
                          .errors = file.get(),
                          .group = ChildSettings::Group::kShared,
                          .death_signal = SIGKILL});
    gnuplot.wait();
    return gnuplot.code() == 0;
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::no_such_file_or_directory &&
        error.code() != std::errc::permission_denied) {
      throw ReportError(error.what());
    }
    throw ReportError(
        "gnuplot, which draws the figures, is not installed; get it with "
        "'sudo apt-get install gnuplot-nox' and analyze the run again");
  }
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
  const bool done = draws(folder, file, messages);
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
