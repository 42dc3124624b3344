#include "common/files/certificate_folder.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "common/files/output_links.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostCertificateBytes = 1'000'000;

bool isForbidden(const fs::path& file) {
  return eaccess(file.c_str(), R_OK) != 0 && errno == EACCES;
}

bool isRegularCertificate(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && fs::file_size(file, error) <= kMostCertificateBytes &&
         !error;
}

/// A link in a folder of a stranger could otherwise send any file of the user to other hosts.
std::string linkProblem(const fs::path& folder, const fs::path& file) {
  if (!leadsOutOf(folder, file)) return {};
  std::error_code error;
  return file.string() + ": found a link to " + fs::canonical(file, error).string() +
         ", which is outside of the folder, expected a file in it; replace the link by a copy of "
         "that file";
}

}  // namespace

std::string securityNameProblem(const fs::path& folder) {
  // The name becomes part of an XML document, in which Cyclone also expands $NAME, and a document
  // can load libraries.
  const std::string name = fs::absolute(folder).string();
  if (name.find_first_of("<>&\"'$`\n\r\t") == std::string::npos) return {};
  return "found the folder of certificates \"" + name.substr(0, 80) +
         "\", expected a path without < > & \" ' $ `; rename it";
}

std::string securityFolderProblem(const fs::path& folder, Unreadable unreadable) {
  std::string problem = securityNameProblem(folder);
  for (const std::string_view name : kSecurityFiles) {
    if (!problem.empty()) break;
    const fs::path file = folder / name;
    if (isForbidden(file)) {
      if (unreadable == Unreadable::kIsAbsent) continue;
      problem = file.string() +
                ": no permission to read it, expected a certificate folder of yours; ask its owner "
                "for certificates (docs/security.md)";
    } else if (!isRegularCertificate(file)) {
      problem = file.string() +
                ": not found, or no regular file of at most 1 MB, expected a certificate folder as "
                "docs/security.md makes it";
    } else {
      problem = linkProblem(folder, file);
    }
  }
  return problem;
}

}  // namespace lab
