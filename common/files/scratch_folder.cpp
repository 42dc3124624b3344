#include "common/files/scratch_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

namespace lab {

std::filesystem::path makeUniqueFolder(const std::filesystem::path& parent, std::string_view name) {
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  if (error) {
    errno = error.value();
    return {};
  }
  std::string path = (parent / (std::string(name) + "-XXXXXX")).string();
  return mkdtemp(path.data()) == nullptr ? std::filesystem::path() : std::filesystem::path(path);
}

}  // namespace lab
