// The log of a service is looked at on a terminal, and kept in logs/ of a run.
#include "common/service/service_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>

namespace lab::service_log_test {
namespace {

/// What this text becomes in the log of a service of this name.
std::string logged(const std::string& name, const std::string& text) {
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  testing::internal::CaptureStderr();
  startLog(name);
  spdlog::warn("found {}", text);
  std::string written = testing::internal::GetCapturedStderr();
  spdlog::set_default_logger(before);
  return written;
}

TEST(ServiceLog, ShowsControlCharactersAsText) {
  const std::string written =
      logged("service_one", "\x1b]0;title\x07 \r\x1b[2K\xc2\x9b\xe2\x80\xae \xff\tnext\nlast");

  EXPECT_THAT(written, testing::EndsWith("] [service_one] [warning] found \\x1b]0;title\\x07 "
                                         "\\x0d\\x1b[2K\\x9b\\u202e \xEF\xBF\xBD\tnext\nlast\n"));
}

TEST(ServiceLog, HasTheTimeOfEachEntry) {
  EXPECT_THAT(
      logged("service_two", "{} %v"),
      testing::ContainsRegex("^\\[[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9]{2}:[0-9]{2}:[0-9]{2}\\."
                             "[0-9]{3}\\] \\[service_two\\] \\[warning\\] found \\{\\} %v\n$"));
}

}  // namespace
}  // namespace lab::service_log_test
