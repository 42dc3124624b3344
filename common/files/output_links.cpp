#include "common/files/output_links.hpp"

#include <system_error>

namespace lab {
namespace fs = std::filesystem;

bool isLink(const fs::path& path) {
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(path, ignored));
}

std::string explainLink(const fs::path& path) {
  if (!isLink(path)) return "";
  return path.string() +
         ": found a symbolic link, expected a folder or file into which the lab writes; remove the "
         "link, or choose another folder with --out";
}

void removeLink(const fs::path& file) {
  std::error_code ignored;
  if (isLink(file)) fs::remove(file, ignored);
}

}  // namespace lab
