#include "dashboard/web/event_stream.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <thread>

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;

constexpr auto kMaxWait = 250ms;  // then the caller checks whether the client is still there
constexpr auto kSilence = 10s;    // before a comment is sent
constexpr auto kGather =
    10ms;  // between two writes, so that simultaneous changes are sent together

}  // namespace

void appendEvent(std::string& to, std::string_view topic, std::string_view text) {
  to.append("event: ");
  // Names of topics contain text from the bus. A line break in them would begin another event.
  for (const char letter : topic) {
    const bool is_control = static_cast<unsigned char>(letter) < ' ' || letter == 0x7f;
    to.push_back(is_control ? '?' : letter);
  }
  to.append("\n");
  while (true) {
    const std::size_t end = text.find('\n');
    to.append("data: ").append(text.substr(0, end)).append("\n");
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  to.append("\n");
}

std::string EventStream::next() {
  std::string text;
  if (!begun_) text = "retry: 1000\n\n";
  // changesSince() advances seen_.
  std::vector<Hub::Change> changes = hub_.changesSince(seen_, begun_ ? kMaxWait : 0ms);
  if (begun_ && !changes.empty() && Clock::now() < written_ + kGather) {
    std::this_thread::sleep_until(written_ + kGather);
    std::vector<Hub::Change> newer = hub_.changesSince(seen_, 0ms);
    // A topic that changed again is sent once, with its newest text.
    std::erase_if(changes, [&newer](const Hub::Change& old) {
      return std::ranges::find(newer, old.topic, &Hub::Change::topic) != newer.end();
    });
    std::ranges::move(newer, std::back_inserter(changes));
  }
  begun_ = true;
  for (const Hub::Change& change : changes) {
    // Topics with a leading dot are raw pixels, which the page requests; they are not sent as
    // events.
    if (!change.topic.starts_with('.')) appendEvent(text, change.topic, *change.text);
  }
  const auto now = Clock::now();
  if (text.empty() && now - written_ >= kSilence) text = ": alive\n\n";
  if (!text.empty()) written_ = now;
  return text;
}

}  // namespace lab::dashboard
