#include "common/files/certificate_folder.hpp"

#include <algorithm>
#include <cstdint>
#include <system_error>

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostCertificateBytes = 1'000'000;

/// Where the links of a path lead; empty if that cannot be read.
fs::path realPlace(const fs::path& path) {
  std::error_code error;
  fs::path place = fs::canonical(path, error);
  return error ? fs::path() : place;
}

bool isRegularCertificate(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && fs::file_size(file, error) <= kMostCertificateBytes &&
         !error;
}

/// A link in a folder of a stranger could otherwise send any file of the user to other hosts.
std::string linkProblem(const fs::path& folder, const fs::path& file) {
  const fs::path around = realPlace(folder);
  const fs::path place = realPlace(file);
  const bool is_inside =
      !around.empty() &&
      std::mismatch(around.begin(), around.end(), place.begin(), place.end()).first == around.end();
  if (is_inside) return {};
  return file.string() + ": found a link to " + place.string() +
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

std::string securityFolderProblem(const fs::path& folder) {
  std::string problem = securityNameProblem(folder);
  for (const std::string_view name : kSecurityFiles) {
    if (!problem.empty()) break;
    const fs::path file = folder / name;
    problem = isRegularCertificate(file)
                  ? linkProblem(folder, file)
                  : file.string() +
                        ": not found, or no regular file of at most 1 MB, expected a certificate "
                        "folder as docs/security.md makes it";
  }
  return problem;
}

}  // namespace lab
