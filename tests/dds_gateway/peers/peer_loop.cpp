#include "tests/dds_gateway/peers/peer_loop.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace lab::dds {
namespace {

constexpr int kPollMs = 5;

PeerQos qosOf(std::istringstream& words) {
  PeerQos qos;
  for (std::string word; words >> word;) {
    const std::string value = word.substr(word.find('=') + 1);
    if (word == "besteffort") {
      qos.reliable = false;
    } else if (word == "latched") {
      qos.latched = true;
    } else if (word.starts_with("depth=")) {
      qos.depth = std::stoi(value);
    } else if (word.starts_with("representation=")) {
      qos.xcdr1 = value != "xcdr2";
      qos.xcdr2 = value != "xcdr1";
    } else if (word.starts_with("hash=")) {
      qos.user_data = "typehash=" + value + ";";
    } else {
      throw std::runtime_error("unknown QoS " + word);
    }
  }
  return qos;
}

/// All endpoints, and their last reported state.
class Endpoints {
 public:
  explicit Endpoints(const MakeEndpoint& make) : make_(make) {}

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string what;
    std::string topic;
    std::string rest;
    words >> what >> topic >> rest;
    if (what == "sync") {
      std::cout << "synced " << topic << "\n";
    } else if (what == "write") {
      all_.at(topic).endpoint->write(payloadOf(rest));
    } else {
      all_[topic].endpoint = make_(what == "writer", topic, rest, qosOf(words));
    }
  }

  void tell() {
    for (auto& [topic, one] : all_) {
      for (const Payload& payload : one.endpoint->take()) {
        std::cout << "got " << topic << " " << hexOf(payload) << "\n";
      }
      const PeerMatch now = one.endpoint->match();
      if (now.matched != one.told.matched) {
        std::cout << "matched " << topic << " " << now.matched << "\n";
      }
      if (now.refused_by != one.told.refused_by) {
        std::cout << "refused " << topic << " " << now.refused_by << "\n";
      }
      one.told = now;
    }
    std::cout << std::flush;
  }

 private:
  struct One {
    std::unique_ptr<PeerEndpoint> endpoint;
    PeerMatch told;
  };

  const MakeEndpoint& make_;
  std::map<std::string, One> all_;
};

}  // namespace

std::string hexOf(const Payload& payload) {
  static constexpr const char* kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : payload) {
    hex += kDigits[byte >> 4U];
    hex += kDigits[byte & 15U];
  }
  return hex;
}

Payload payloadOf(const std::string& hex) {
  if (hex.size() % 2 != 0) throw std::runtime_error("odd number of hex digits");
  Payload payload;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    payload.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return payload;
}

int peerLoop(const MakeEndpoint& make) {
  Endpoints endpoints(make);
  std::cout << "ready" << std::endl;
  std::string waiting;
  for (;;) {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    if (poll(&in, 1, kPollMs) > 0) {
      std::array<char, 65536> buffer{};
      const ssize_t count = read(STDIN_FILENO, buffer.data(), buffer.size());
      if (count <= 0) return 0;
      waiting.append(buffer.data(), static_cast<std::size_t>(count));
    }
    for (std::size_t end = 0; (end = waiting.find('\n')) != std::string::npos;) {
      const std::string line = waiting.substr(0, end);
      waiting.erase(0, end + 1);
      try {
        endpoints.obey(line);
      } catch (const std::exception& error) {
        std::cout << "error " << line.substr(0, 80) << ": " << error.what() << "\n";
      }
    }
    endpoints.tell();
  }
}

}  // namespace lab::dds
