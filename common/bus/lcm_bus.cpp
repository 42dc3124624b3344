#include "common/bus/lcm_bus.hpp"

#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"

namespace lab {
namespace {

constexpr int kDefaultPort = 7667;
constexpr int kMostInOneDrain = 10'000;

/// Escapes a channel name, which LCM takes as a regular expression: ROBOT.1 would match ROBOTX1.
std::string literally(std::string_view channel) {
  std::string pattern;
  for (const char letter : channel) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '_') pattern += '\\';
    pattern += letter;
  }
  return pattern;
}

}  // namespace

std::string lcmUrl(int port, int ttl) {
  return "udpm://239.255.76.67:" + std::to_string(port) + "?ttl=" + std::to_string(ttl) +
         "&recv_buf_size=4194304";
}

std::string defaultLcmUrl() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url != nullptr && *url != '\0' ? url : lcmUrl(kDefaultPort);
}

struct LcmBus::Subscription {
  LcmBus* bus;
  PacketHandler handler;

  static void handle(const lcm_recv_buf_t* buffer, const char* channel, void* user_data) {
    if (channel == channels::kLcmSelfTest) return;
    const auto* subscription = static_cast<const Subscription*>(user_data);
    try {
      subscription->handler({channel,
                             {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size},
                             buffer->recv_utime});
    } catch (...) {
      std::exception_ptr& error = subscription->bus->error_;
      if (!error) error = std::current_exception();
    }
  }
};

LcmBus::LcmBus(const std::string& url) : lcm_(lcm_create(url.c_str()), &lcm_destroy) {
  // lcm_get_fileno() makes LCM send a probe to itself, which fails if multicast does not loop back.
  if (!lcm_ || lcm_get_fileno(lcm_.get()) < 0) {
    throw BusError(
        "the LCM bus " + url +
        " cannot be opened: this machine has no usable multicast route (or the URL is wrong). On a "
        "machine without a network: sudo ip link set lo up && sudo ip route add 224.0.0.0/4 dev "
        "lo");
  }
}

LcmBus::~LcmBus() = default;

void LcmBus::publish(std::string_view channel, Bytes data) {
  checkChannelName(channel);
  const std::string name(channel);
  const auto size = static_cast<unsigned int>(data.size());
  if (lcm_publish(lcm_.get(), name.c_str(), data.data(), size) != 0) {
    throw BusError("LCM cannot send " + std::to_string(data.size()) + " bytes on " + name);
  }
}

void LcmBus::subscribe(std::string_view channel, PacketHandler handler) {
  add(literally(channel), std::move(handler));
}

void LcmBus::subscribeAll(PacketHandler handler) { add(".*", std::move(handler)); }

void LcmBus::add(const std::string& pattern, PacketHandler handler) {
  subscriptions_.push_back(std::make_unique<Subscription>(Subscription{this, std::move(handler)}));
  lcm_subscription_t* subscription = lcm_subscribe(
      lcm_.get(), pattern.c_str(), &Subscription::handle, subscriptions_.back().get());
  if (subscription == nullptr) throw BusError("LCM cannot subscribe to " + pattern);
  constexpr int kUnlimited = 0;
  lcm_subscription_set_queue_capacity(subscription, kUnlimited);
}

int LcmBus::fileDescriptor() const { return lcm_get_fileno(lcm_.get()); }

void LcmBus::drain() { drainFor(0); }

bool LcmBus::drainFor(int timeout_ms) {
  if (draining_) throw std::logic_error("drain() inside a handler: LCM would abort");
  draining_ = true;
  int handled = 0;
  int result = 1;
  for (int wait = timeout_ms; result > 0 && handled < kMostInOneDrain; wait = 0) {
    errno = 0;
    result = lcm_handle_timeout(lcm_.get(), wait);
    if (result > 0) ++handled;
  }
  draining_ = false;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  // EINTR: a signal ended the wait, so that the caller can check its stop flag.
  if (result < 0 && errno != EINTR) throw BusError("LCM receives no more messages");
  return handled > 0;
}

}  // namespace lab
