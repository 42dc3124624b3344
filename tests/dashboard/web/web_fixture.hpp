/// A web server of the page, with a lab that records the requests that reach it.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "dashboard/web/web_server.hpp"
#include "tests/support/raw_http_client.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"

namespace lab::dashboard {

class RecordingLab final : public LabRequestHandler {
 public:
  std::string request(const OperatorRequest& request) override {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
    return refusal_;
  }
  std::optional<std::string> query(std::string_view what, std::string_view which) override {
    if (what == "nothing") return std::nullopt;
    return "[\"" + std::string(what) + "\",\"" + std::string(which) + "\"]";
  }
  [[nodiscard]] std::vector<OperatorRequest> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }

  void refuse(const std::string& why) {
    const std::lock_guard lock(mutex_);
    refusal_ = why;
  }

 private:
  std::mutex mutex_;
  std::string refusal_;
  std::vector<OperatorRequest> requests_;
};

class WebTest : public testing::Test {
 protected:
  static constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

  WebTest() {
    options_.port = 0;
    options_.token = kToken;
    options_.runs = folder_ / "runs";
  }

  void start() { server_.emplace(options_, hub_, lab_); }

  /// A request as the page sends it in a browser. @param extra header lines, each with its line end
  [[nodiscard]] std::string request(const std::string& method, const std::string& target,
                                    const std::string& extra = "",
                                    const std::string& body = "") const {
    const std::string host = "127.0.0.1:" + std::to_string(server_->port());
    std::string text = method + " " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + extra;
    if (method == "POST") {
      text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) +
              "\r\n";
    }
    return text + "\r\n" + body;
  }
  [[nodiscard]] static std::string token() {
    return std::string("X-Lab-Token: ") + kToken + "\r\n";
  }

  [[nodiscard]] std::string send(const std::string& method, const std::string& target,
                                 const std::string& extra = "",
                                 const std::string& body = "") const {
    return exchange(server_->port(), request(method, target, extra, body));
  }
  /// Sends an operator request with the token. @return the response
  [[nodiscard]] std::string control(const std::string& body) const {
    return send("POST", "/api/request", token(), body);
  }
  void waitForViewers(int count) const {
    ASSERT_TRUE(waitUntil([&] { return server_->viewers() == count; }, std::chrono::seconds(30)))
        << server_->viewers() << " viewers instead of " << count;
  }

  TemporaryFolder folder_;
  WebOptions options_;
  Hub hub_;
  RecordingLab lab_;
  std::optional<WebServer> server_;
};

}  // namespace lab::dashboard
