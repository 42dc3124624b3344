// The live bus.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <utility>

#include "common/bus/lcm_bus.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/running_labs.hpp"
#include "python/native/module.hpp"

namespace lab::python {
namespace py = pybind11;
namespace {

class LiveBus {
 public:
  explicit LiveBus(const std::string& url)
      : bus_(url), wall_us_(wallClock()), steady_(std::chrono::steady_clock::now()) {
    bus_.subscribeAll([this](const Packet& packet) {
      std::string channel(packet.channel);
      if (!channels_.contains(channel)) return;
      const auto* data = reinterpret_cast<const char*>(packet.data.data());
      waiting_.push_back({std::move(channel), packet.received_utime, {data, packet.data.size()}});
    });
  }

  /// The wall clock at the beginning plus the steady time since then.
  [[nodiscard]] std::int64_t now() const {
    const auto passed = std::chrono::steady_clock::now() - steady_;
    return wall_us_ + std::chrono::duration_cast<std::chrono::microseconds>(passed).count();
  }

  void subscribe(const std::string& channel) { channels_.insert(channel); }

  void publish(const std::string& channel, const py::bytes& message) {
    const std::string bytes = message;
    bus_.publish(channel, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }

  /// (channel, received_utime, encoding), or None if nothing arrives until `until_utime`.
  py::object receive(std::int64_t until_utime) {
    constexpr std::int64_t kSignals_us = 50'000;  // Ctrl-C is noticed within this time
    while (waiting_.empty()) {
      const std::int64_t left = until_utime - now();
      {
        const py::gil_scoped_release released;
        const std::int64_t wait = std::clamp<std::int64_t>(left, 0, kSignals_us);
        bus_.drainFor(static_cast<int>((wait + 999) / 1000));
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (left <= 0) break;
    }
    if (waiting_.empty()) return py::none();
    const Received first = std::move(waiting_.front());
    waiting_.pop_front();
    return py::make_tuple(first.channel, first.utime, py::bytes(first.data));
  }

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  struct Received {
    std::string channel;
    std::int64_t utime;
    std::string data;
  };

  LcmBus bus_;
  std::int64_t wall_us_;
  std::chrono::steady_clock::time_point steady_;
  std::set<std::string> channels_;
  std::deque<Received> waiting_;
};

py::list labs() {
  py::list all;
  for (const RunningLab& lab : runningLabs()) {
    py::dict entry;
    entry["name"] = lab.name;
    entry["url"] = lab.url;
    entry["directory"] = lab.directory;
    entry["replay"] = lab.replay;
    all.append(entry);
  }
  return all;
}

}  // namespace

void addBus(py::module_& module) {
  module.def("running_labs", &labs, "The labs that run on this machine, of this user.");
  module.def("default_url", &defaultLcmUrl);
  py::class_<LiveBus>(module, "LiveBus", "LCM over UDP multicast.")
      .def(py::init<const std::string&>(), py::arg("url"))
      .def_property_readonly("now", &LiveBus::now)
      .def_property_readonly("waiting", &LiveBus::waiting)
      .def("subscribe", &LiveBus::subscribe, py::arg("channel"))
      .def("publish", &LiveBus::publish, py::arg("channel"), py::arg("message"))
      .def("receive", &LiveBus::receive, py::arg("until_utime"));
}

}  // namespace lab::python
