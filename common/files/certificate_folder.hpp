/// The folder of certificates of DDS Security (docs/security.md). It may be named in a file of a
/// stranger or come with one, and its files go to the hosts of a run.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace lab {

/// The files of the folder, in the order that dds_gateway/dds/configuration.cpp assumes.
inline constexpr std::array<std::string_view, 6> kSecurityFiles{
    "identity_ca.pem",    "cert.pem",       "key.pem",
    "permissions_ca.pem", "governance.p7s", "permissions.p7s"};

/// Why a folder of this name cannot be used, in one line; empty if it can.
[[nodiscard]] std::string securityNameProblem(const std::filesystem::path& folder);

/// A file that this user may not read, as in a folder of another user.
enum class Unreadable {
  kIsRefused,
  kIsAbsent  ///< accepted, as on a machine without the certificates
};

/// The same, and why one of the files cannot be used: it is missing, no regular file, larger than
/// 1 MB, or a link that leads out of the folder; or this user may not read it.
[[nodiscard]] std::string securityFolderProblem(const std::filesystem::path& folder,
                                                Unreadable unreadable = Unreadable::kIsRefused);

}  // namespace lab
