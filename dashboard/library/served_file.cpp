#include "dashboard/library/served_file.hpp"

#include <algorithm>
#include <array>
#include <system_error>

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 8> kEndings{".html", ".svg", ".csv", ".json",
                                                   ".toml", ".pdf", ".jpg", ".mp4"};
constexpr std::string_view kFigures = "figures/";

}  // namespace

bool isPlainName(std::string_view name) {
  return !name.empty() && !name.starts_with('.') &&
         name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

std::optional<fs::path> servedFile(const fs::path& folder, std::string_view name) {
  const std::string_view last = name.starts_with(kFigures) ? name.substr(kFigures.size()) : name;
  const bool known = std::ranges::any_of(
      kEndings, [last](std::string_view ending) { return last.ends_with(ending); });
  if (!known || !isPlainName(last)) return std::nullopt;
  std::error_code error;
  const fs::path path = fs::canonical(folder / name, error);
  if (error || !fs::is_regular_file(path, error)) return std::nullopt;
  const fs::path home = fs::canonical(folder, error);
  const auto [rest, ignored] = std::ranges::mismatch(home, path);
  if (error || rest != home.end()) return std::nullopt;
  return path;
}

}  // namespace lab::dashboard
