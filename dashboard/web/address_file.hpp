/// The file with the page's address: read by the program that starts the dashboard, and by the
/// dashboard itself when it is restarted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lab::dashboard {

struct PageAddress {
  int port = 0;
  std::string token;
};

/// Parses "http://127.0.0.1:8480/#token=...". @return nothing if it is not such an address
[[nodiscard]] std::optional<PageAddress> parseAddress(std::string_view address);

/// @return nothing if there is no such file or it does not contain an address
[[nodiscard]] std::optional<PageAddress> readAddressFile(const std::filesystem::path& file);

/// Writes the file atomically. Only its owner can read it, because of the token.
/// @throws std::runtime_error if it cannot be written
void writeAddressFile(const std::filesystem::path& file, const std::string& address);

}  // namespace lab::dashboard
