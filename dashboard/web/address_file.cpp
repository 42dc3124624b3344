#include "dashboard/web/address_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace lab::dashboard {
namespace {

constexpr std::string_view kToken = "/#token=";
constexpr std::size_t kTokenLength = 32;  // newToken()
constexpr int kMaxPort = 65535;

}  // namespace

std::optional<PageAddress> parseAddress(std::string_view address) {
  while (!address.empty() && (address.back() == '\n' || address.back() == '\r')) {
    address.remove_suffix(1);
  }
  const std::size_t mark = address.find(kToken);
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string_view token = address.substr(mark + kToken.size());
  const bool hexadecimal = token.find_first_not_of("0123456789abcdef") == std::string_view::npos;
  if (token.size() != kTokenLength || !hexadecimal) return std::nullopt;
  const std::string_view endpoint = address.substr(0, mark);
  const std::size_t colon = endpoint.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  PageAddress found{0, std::string(token)};
  const char* const begin = endpoint.data() + colon + 1;
  const char* const end = endpoint.data() + endpoint.size();
  const auto [stop, error] = std::from_chars(begin, end, found.port);
  const bool valid = error == std::errc() && stop == end && found.port > 0;
  if (!valid || found.port > kMaxPort) return std::nullopt;
  return found;
}

std::optional<PageAddress> readAddressFile(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return std::nullopt;
  return parseAddress(line);
}

void writeAddressFile(const std::filesystem::path& file, const std::string& address) {
  std::filesystem::path part = file;
  part += ".part";
  ::unlink(part.c_str());
  const int descriptor =
      ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const std::string text = address + "\n";
  const bool written = descriptor >= 0 && ::write(descriptor, text.data(), text.size()) ==
                                              static_cast<ssize_t>(text.size());
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!written || ::rename(part.c_str(), file.c_str()) != 0) {
    throw std::runtime_error("cannot write the page's address to " + file.string() + ": " +
                             std::strerror(written ? errno : error));
  }
}

}  // namespace lab::dashboard
