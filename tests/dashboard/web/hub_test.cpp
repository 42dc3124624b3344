#include "dashboard/web/hub.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "dashboard/web/event_stream.hpp"

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> textsOf(const std::vector<Hub::Change>& changes) {
  std::vector<std::string> texts;
  for (const Hub::Change& change : changes) texts.push_back(change.topic + "=" + *change.text);
  return texts;
}

TEST(Hub, ReturnsAllTopicsFirstAndThenChangesInTheirOrder) {
  Hub hub;
  hub.publish("b", "1");
  hub.publish("a", "1");
  std::uint64_t seen = 0;
  EXPECT_THAT(textsOf(hub.changesSince(seen, 0ms)), ElementsAre("b=1", "a=1"));
  EXPECT_THAT(hub.changesSince(seen, 0ms), IsEmpty());
  hub.publish("b", "2");
  EXPECT_THAT(textsOf(hub.changesSince(seen, 0ms)), ElementsAre("b=2"));
}

TEST(Hub, ReturnsOnlyTheNewestTextOfATopic) {
  Hub hub;
  std::uint64_t seen = 0;
  for (int i = 0; i < 1000; ++i) hub.publish("frame", std::to_string(i));
  hub.publish("pulse", "x");
  EXPECT_THAT(textsOf(hub.changesSince(seen, 0ms)), ElementsAre("frame=999", "pulse=x"));
}

TEST(Hub, KeepsNoOldTextsForSlowReaders) {
  Hub hub;
  std::uint64_t seen = 0;
  hub.publish("frame", "old");
  ASSERT_EQ(hub.changesSince(seen, 0ms).size(), 1U);
  const std::weak_ptr<const std::string> old = hub.newest("frame");
  hub.publish("frame", "new");
  EXPECT_TRUE(old.expired());
}

TEST(Hub, RemovesTopics) {
  Hub hub;
  hub.publish("pool/abp", "1");
  hub.remove("pool/abp");
  hub.remove("pool/none");
  std::uint64_t seen = 0;
  EXPECT_THAT(hub.changesSince(seen, 0ms), IsEmpty());
  EXPECT_EQ(hub.newest("pool/abp"), nullptr);
}

TEST(Hub, SendsNullOnceForARemovedTopic) {
  Hub hub;
  hub.publish("pool/abp", "1");
  std::uint64_t seen = 0;
  ASSERT_EQ(hub.changesSince(seen, 0ms).size(), 1U);
  hub.remove("pool/abp");
  EXPECT_EQ(textsOf(hub.changesSince(seen, 0ms)), std::vector<std::string>{"pool/abp=null"});
  hub.remove("pool/abp");
  EXPECT_THAT(hub.changesSince(seen, 0ms), IsEmpty());
  hub.publish("pool/abp", "2");
  EXPECT_EQ(textsOf(hub.changesSince(seen, 0ms)), std::vector<std::string>{"pool/abp=2"});
  EXPECT_EQ(*hub.newest("pool/abp"), "2");
}

TEST(EventStream, ALineBreakInATopicDoesNotBeginAnotherEvent) {
  std::string text;
  appendEvent(text, "pool/a\n\nevent: stop\r", "1\n2");
  EXPECT_EQ(text, "event: pool/a??event: stop?\ndata: 1\ndata: 2\n\n");
}

TEST(Hub, LimitsTheNumberOfRemovedTopics) {
  Hub hub;
  hub.publish("pulse", "0");
  std::uint64_t seen = 0;
  static_cast<void>(hub.changesSince(seen, 0ms));
  for (int i = 0; i < 1000; ++i) {
    hub.publish("pool/" + std::to_string(i), "1");
    hub.remove("pool/" + std::to_string(i));
  }
  EXPECT_EQ(hub.changesSince(seen, 0ms).size(), 200U);
}

TEST(Hub, WakesReadersForAChangeButNotForAQuietOne) {
  Hub hub;
  hub.publish("pulse", "0");
  std::uint64_t seen = 0;
  static_cast<void>(hub.changesSince(seen, 0ms));
  std::vector<std::string> found;
  std::thread reader([&] { found = textsOf(hub.changesSince(seen, 60s)); });
  hub.publishQuietly(".light", "raster");
  hub.publish("pulse", "1");
  reader.join();
  // If the reader begins to wait after the quiet change, it receives both at once.
  EXPECT_THAT(found, testing::Contains("pulse=1"));
  EXPECT_EQ(*hub.newest(".light"), "raster");
}

TEST(Hub, WakesAllReadersWhenItCloses) {
  Hub hub;
  std::uint64_t seen = 0;
  std::thread reader([&] { EXPECT_THAT(hub.changesSince(seen, 60s), IsEmpty()); });
  hub.close();
  reader.join();
  EXPECT_TRUE(hub.closed());
  hub.publish("late", "x");
  EXPECT_THAT(hub.changesSince(seen, 60s), IsEmpty());
}

TEST(Hub, AllReadersEndWithTheNewestTexts) {
  constexpr int kPublishers = 3;
  constexpr int kReaders = 4;
  constexpr int kTexts = 3000;
  Hub hub;
  std::atomic<int> publishing = kPublishers;
  std::vector<std::thread> threads;
  for (int p = 0; p < kPublishers; ++p) {
    threads.emplace_back([&, p] {
      for (int i = 0; i < kTexts; ++i) hub.publish("t" + std::to_string(p), std::to_string(i));
      --publishing;
    });
  }
  for (int r = 0; r < kReaders; ++r) {
    threads.emplace_back([&] {
      std::uint64_t seen = 0;
      std::map<std::string, int> newest;
      for (bool last = false; !last;) {
        last = publishing == 0;
        std::uint64_t version = 0;
        for (const Hub::Change& change : hub.changesSince(seen, 1ms)) {
          const int number = std::stoi(*change.text);
          const auto before = newest.find(change.topic);
          if (before != newest.end()) {
            EXPECT_GT(number, before->second);
          }
          newest[change.topic] = number;
          EXPECT_GT(change.version, version);
          version = change.version;
        }
        EXPECT_GE(seen, version);
      }
      for (int p = 0; p < kPublishers; ++p) {
        EXPECT_EQ(newest["t" + std::to_string(p)], kTexts - 1);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace lab::dashboard
