#include "dashboard/web/camera_picture.hpp"

#include <optional>
#include <utility>

#include "common/http/http_exchange.hpp"

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 100ms;
constexpr auto kTimeout = 1s;
constexpr std::size_t kMaxBytes = 16 << 20;

}  // namespace

CameraPicture::Text CameraPicture::newest() {
  // A caller that has to wait while another one fetches uses that picture.
  const std::lock_guard lock(mutex_);
  if (fetched_ != Clock::time_point{} && Clock::now() - fetched_ < kPeriod) return picture_;
  std::optional<std::string> bytes = httpGet(port_, "/frame.jpg", kTimeout, kMaxBytes);
  const bool is_jpeg = bytes && bytes->starts_with("\xff\xd8");
  picture_ = is_jpeg ? std::make_shared<const std::string>(std::move(*bytes)) : nullptr;
  fetched_ = Clock::now();
  return picture_;
}

}  // namespace lab::dashboard
