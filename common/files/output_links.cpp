#include "common/files/output_links.hpp"

#include <algorithm>
#include <system_error>

namespace lab {
namespace fs = std::filesystem;

bool isLink(const fs::path& path) {
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(path, ignored));
}

bool leadsOutOf(const fs::path& folder, const fs::path& path) {
  std::error_code no_folder;
  std::error_code no_path;
  const fs::path around = fs::canonical(folder, no_folder);
  const fs::path place = fs::canonical(path, no_path);
  return no_folder || no_path ||
         std::mismatch(around.begin(), around.end(), place.begin(), place.end()).first !=
             around.end();
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
