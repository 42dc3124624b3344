#include "common/files/file_text.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "common/files/experiment_error.hpp"

namespace lab {

std::optional<std::string> readWholeFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return {};
  return text;
}

std::string readFileText(const std::string& name) {
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) {
    throw ExperimentError({name + ": is a folder, expected a file"});
  }
  errno = 0;
  std::optional<std::string> text = readWholeFile(name);
  if (!text) throw ExperimentError({name + ": cannot be read: " + std::strerror(errno)});
  return *std::move(text);
}

}  // namespace lab
