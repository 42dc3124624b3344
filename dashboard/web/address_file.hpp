/// The page's address in a file, for those who start the dashboard, and for its next start.
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

/// Of "http://127.0.0.1:8480/#token=..."; nothing: it is no such address.
[[nodiscard]] std::optional<PageAddress> parseAddress(std::string_view address);

/// Nothing: there is no such file, or it holds no address.
[[nodiscard]] std::optional<PageAddress> readAddressFile(const std::filesystem::path& file);

/// Readable by its owner alone, from its first moment; a reader finds all of it or nothing.
/// @throws std::runtime_error when it cannot be written.
void writeAddressFile(const std::filesystem::path& file, const std::string& address);

}  // namespace lab::dashboard
