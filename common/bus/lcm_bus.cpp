#include "common/bus/lcm_bus.hpp"

#include <poll.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/udpm_receiver.hpp"
#include "common/bus/udpm_url.hpp"

namespace lab {
namespace {

constexpr int kDefaultPort = 7667;
constexpr int kMostInOneDrain = 10'000;
// Timers, such as that of the heartbeat, wait no longer when messages arrive faster than they are
// handled.
constexpr std::chrono::milliseconds kLongestDrain{100};

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
  std::optional<std::string> channel;  ///< nothing: every channel
  PacketHandler handler;

  void call(const Packet& packet) const {
    try {
      handler(packet);
    } catch (...) {
      if (!bus->error_) bus->error_ = std::current_exception();
    }
  }

  static void handle(const lcm_recv_buf_t* buffer, const char* channel, void* user_data) {
    if (channel == channels::kLcmSelfTest) return;
    static_cast<const Subscription*>(user_data)->call(
        {channel,
         {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size},
         buffer->recv_utime});
  }
};

LcmBus::LcmBus(const std::string& url)
    : url_(url.empty() ? defaultLcmUrl() : url), lcm_(nullptr, &lcm_destroy) {
  // Of the others, file writes to any file, and mpudpm and tcpq receive from every machine.
  const std::string_view provider = providerOf(url_);
  if (provider != "udpm" && provider != "memq") {
    throw BusError("the LCM bus " + url_ + " cannot be opened: found the provider \"" +
                   std::string(provider) + "\", expected udpm://GROUP:PORT?ttl=0");
  }
  lcm_.reset(lcm_create(url_.c_str()));
  const std::optional<UdpmUrl> udpm = parseUdpmUrl(url_);
  if (!lcm_) throw BusError(noMulticast());
  if (udpm) {
    receiveFrom(*udpm);
  } else if (lcm_get_fileno(lcm_.get()) < 0) {
    throw BusError(noMulticast());
  }
}

LcmBus::~LcmBus() = default;

std::string LcmBus::noMulticast() const {
  return "the LCM bus " + url_ +
         " cannot be opened: this machine has no usable multicast route (or the URL is wrong). On "
         "a machine without a network: sudo ip link set lo up && sudo ip route add 224.0.0.0/4 dev "
         "lo";
}

/// Sends LCM's probe to itself, which does not arrive if multicast does not loop back.
void LcmBus::receiveFrom(const UdpmUrl& udpm) {
  constexpr std::string_view kProbe = "lcm self test";
  constexpr int kProbes = 100;
  constexpr int kProbeWait_ms = 100;  // liblcm waits for 10 s altogether, too
  try {
    receiver_ = std::make_unique<UdpmReceiver>(udpm);
  } catch (const std::system_error& error) {
    throw BusError(noMulticast() + " (" + error.what() + ")");
  }
  for (int i = 0; i < kProbes; ++i) {
    publish(channels::kLcmSelfTest,
            {reinterpret_cast<const std::uint8_t*>(kProbe.data()), kProbe.size()});
    if (receiver_->waitForProbe(kProbeWait_ms)) return;
  }
  throw BusError(noMulticast());
}

void LcmBus::publish(std::string_view channel, Bytes data) {
  checkChannelName(channel);
  const std::string name(channel);
  const auto size = static_cast<unsigned int>(data.size());
  if (lcm_publish(lcm_.get(), name.c_str(), data.data(), size) != 0) {
    throw BusError("LCM cannot send " + std::to_string(data.size()) + " bytes on " + name);
  }
}

void LcmBus::subscribe(std::string_view channel, PacketHandler handler) {
  add(std::string(channel), literally(channel), std::move(handler));
  if (receiver_) receiver_->subscribe(channel);
}

void LcmBus::subscribeAll(PacketHandler handler) {
  add(std::nullopt, ".*", std::move(handler));
  if (receiver_) receiver_->subscribeAll();
}

void LcmBus::add(std::optional<std::string> channel, const std::string& pattern,
                 PacketHandler handler) {
  subscriptions_.push_back(
      std::make_unique<Subscription>(Subscription{this, std::move(channel), std::move(handler)}));
  if (receiver_) return;
  lcm_subscription_t* subscription = lcm_subscribe(
      lcm_.get(), pattern.c_str(), &Subscription::handle, subscriptions_.back().get());
  if (subscription == nullptr) throw BusError("LCM cannot subscribe to " + pattern);
  constexpr int kUnlimited = 0;
  lcm_subscription_set_queue_capacity(subscription, kUnlimited);
}

int LcmBus::fileDescriptor() const {
  return receiver_ ? receiver_->fileDescriptor() : lcm_get_fileno(lcm_.get());
}

RefusedDatagrams LcmBus::refused() const {
  return receiver_ ? receiver_->refused() : RefusedDatagrams{};
}

std::int64_t LcmBus::backlog() const { return receiver_ ? receiver_->backlog() : 0; }

void LcmBus::drain() { drainFor(0); }

bool LcmBus::drainFor(int timeout_ms) {
  if (draining_) throw std::logic_error("drain() inside a handler: LCM would abort");
  draining_ = true;
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> first;
  int handled = 0;
  int result = 1;
  for (int wait = timeout_ms; result > 0 && handled < kMostInOneDrain; wait = 0) {
    errno = 0;
    result = receiver_ ? handleReceived(wait) : lcm_handle_timeout(lcm_.get(), wait);
    if (result > 0) ++handled;
    const Clock::time_point now = Clock::now();
    if (!first) first = now;
    if (now - *first > kLongestDrain) break;
  }
  draining_ = false;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  // EINTR: a signal ended the wait, so that the caller can check its stop flag.
  if (result < 0 && errno != EINTR) throw BusError("LCM receives no more messages");
  return handled > 0;
}

int LcmBus::handleReceived(int timeout_ms) {
  std::optional<UdpmMessage> message = receiver_->next();
  if (!message && timeout_ms > 0) {
    pollfd readable{receiver_->fileDescriptor(), POLLIN, 0};
    const int result = poll(&readable, 1, timeout_ms);
    if (result <= 0) return result;
    message = receiver_->next();
  }
  if (!message) {
    errno = receiver_->error();
    return errno == 0 ? 0 : -1;
  }
  const Packet packet{
      message->channel, {message->data.get(), message->size}, message->received_utime};
  // By index, because a handler may subscribe.
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    const Subscription& subscription = *subscriptions_[i];
    if (!subscription.channel || *subscription.channel == packet.channel) {
      subscription.call(packet);
    }
  }
  return 1;
}

}  // namespace lab
