#include "common/service/service_log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <ctime>
#include <memory>
#include <string_view>
#include <utility>

#include "common/text/printable.hpp"

namespace lab {
namespace {

/// The text of an entry, in place of spdlog's %v.
class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& entry, const std::tm& /*time*/,
              spdlog::memory_buf_t& out) override {
    const std::string text =
        printableLines(std::string_view(entry.payload.data(), entry.payload.size()));
    out.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableText>();
  }
};

}  // namespace

void startLog(const std::string& name) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  // As spdlog's own pattern, but for the text.
  formatter->add_flag<PrintableText>('*').set_pattern("[%Y-%m-%d %H:%M:%S.%e] [%n] [%^%l%$] %*");
  const auto logger = spdlog::stderr_color_mt(name);
  logger->set_formatter(std::move(formatter));
  spdlog::set_default_logger(logger);
}

}  // namespace lab
