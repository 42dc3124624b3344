#include "common/files/own_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

namespace lab {

bool isOwnFolder(const std::filesystem::path& folder) {
  struct stat facts {};
  return lstat(folder.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode) && facts.st_uid == geteuid();
}

}  // namespace lab
