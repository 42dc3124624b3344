// The light field, evaluated by the code that the projector and the simulated sensors use.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/layer_texts.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/files/image_file.hpp"
#include "light/field/field.hpp"
#include "light/field/image.hpp"
#include "python/native/module.hpp"

namespace lab::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Times = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

/// The images of a folder, which are named by their SHA-256.
light::ImageStore imagesOf(const std::optional<fs::path>& folder) {
  light::ImageStore store;
  ImageFiles files;
  if (!folder || !fs::is_directory(*folder)) return store;
  for (const auto& entry : fs::directory_iterator(*folder)) {
    const light::DecodedImage& image = files.at(entry.path());
    if (image.image) store[image.image->sha256] = image.image;
  }
  return store;
}

/// The light at one moment.
class LightField {
 public:
  LightField(const light_status_t& status, const light::ImageStore& images)
      : field_(toField(status, images)), compiled_(field_), status_(status) {}

  [[nodiscard]] py::array_t<double> at(const Numbers& x, const Numbers& y) const {
    if (x.size() != y.size()) throw py::value_error("x and y have different lengths");
    py::array_t<double> result(x.size());
    compiled_.evaluateAt(x.data(), y.data(), static_cast<std::size_t>(x.size()),
                         result.mutable_data());
    return result;
  }

  [[nodiscard]] double sensor(double x, double y, double radius) const {
    return compiled_.evaluateOverDisk(x, y, radius);
  }

  [[nodiscard]] const light_status_t& status() const { return status_; }
  [[nodiscard]] bool uniform() const { return compiled_.isUniform(); }

 private:
  light::Field field_;
  light::CompiledField compiled_;
  light_status_t status_;
};

/// The light of a whole run. Nothing of it is kept in memory: it may be larger than that.
class LightHistory {
 public:
  LightHistory(std::vector<fs::path> files, const std::optional<fs::path>& images)
      : files_(std::move(files)), images_(imagesOf(images)) {}

  /// The field that was on the arena at `utime`; nothing before the first one.
  [[nodiscard]] std::optional<LightField> field(std::int64_t utime) const {
    const py::gil_scoped_release released;
    std::optional<light_status_t> found;
    LogReader reader(files_);
    while (const auto status = nextStatus(reader)) {
      if (status->utime > utime) break;
      found = *status;
    }
    if (!found) return std::nullopt;
    return LightField(*found, images_);
  }

  /// The light at many places and times; nan before the first field.
  [[nodiscard]] py::array_t<double> at(const Times& utime, const Numbers& x,
                                       const Numbers& y) const {
    const auto count = static_cast<std::size_t>(utime.size());
    if (x.size() != utime.size() || y.size() != utime.size()) {
      throw py::value_error("times, x and y have different lengths");
    }
    py::array_t<double> result(utime.size());
    const std::int64_t* times = utime.data();
    const double* xs = x.data();
    const double* ys = y.data();
    double* out = result.mutable_data();
    const py::gil_scoped_release released;
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!std::is_sorted(times, times + count)) {
      std::ranges::stable_sort(order, {}, [&](std::size_t i) { return times[i]; });
    }
    LogReader reader(files_);
    std::optional<light_status_t> next = nextStatus(reader);
    light::CompiledField field;
    bool known = false;
    std::vector<double> some_x, some_y, some;
    for (std::size_t begin = 0; begin < count;) {
      std::optional<light_status_t> latest;
      while (next && next->utime <= times[order[begin]]) {
        latest = std::move(next);
        next = nextStatus(reader);
      }
      if (latest) {
        field = light::CompiledField(toField(*latest, images_));
        known = true;
      }
      std::size_t end = begin;
      while (end < count && (!next || times[order[end]] < next->utime)) ++end;
      some_x.clear();
      some_y.clear();
      for (std::size_t i = begin; i < end; ++i) {
        some_x.push_back(xs[order[i]]);
        some_y.push_back(ys[order[i]]);
      }
      some.assign(end - begin, std::numeric_limits<double>::quiet_NaN());
      if (known) field.evaluateAt(some_x.data(), some_y.data(), some.size(), some.data());
      for (std::size_t i = begin; i < end; ++i) out[order[i]] = some[i - begin];
      begin = end;
    }
    return result;
  }

 private:
  static std::optional<light_status_t> nextStatus(LogReader& reader) {
    while (const auto packet = reader.next()) {
      light_status_t status{};
      if (packet->channel != channels::kLightStatus || !decode(packet->data, status)) continue;
      if (impossibleValue(status)) continue;
      if (!light::validate(toLayers(status.layers)) &&
          !light::validate(toLayers(status.previous))) {
        return status;
      }
    }
    return std::nullopt;
  }

  std::vector<fs::path> files_;
  light::ImageStore images_;
};

/// LIGHT_COMMAND with layers as in experiment files, checked as they are.
/// @param run folder of the running experiment; nothing: it is not known
py::bytes lightCommand(const std::vector<std::string>& layers, const std::optional<fs::path>& run) {
  Experiment experiment = experimentForLayers();
  light::ImageStore images;
  if (run && fs::exists(*run / "experiment.toml")) {
    experiment = loadRecordedExperiment(*run / "experiment.toml");
    images = loadImages(experiment, *run).store;
  }
  light_command_t command{};
  setLayers(command, parseLayerTexts(layers, experiment, images, fs::current_path()));
  const std::vector<std::uint8_t> bytes = encode(command);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void addLight(py::module_& module) {
  py::class_<LightField>(module, "LightField", "The light on the arena at one moment.")
      .def(py::init([](const py::bytes& status, const std::optional<fs::path>& images) {
             const std::string bytes = status;
             light_status_t decoded{};
             if (!decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                         decoded)) {
               throw py::value_error("the bytes are no light_status_t");
             }
             return LightField(decoded, imagesOf(images));
           }),
           py::arg("status"), py::arg("images"))
      .def("at", &LightField::at, py::arg("x"), py::arg("y"))
      .def("sensor", &LightField::sensor, py::arg("x"), py::arg("y"), py::arg("radius"))
      .def_property_readonly("uniform", &LightField::uniform)
      .def_property_readonly("utime", [](const LightField& field) { return field.status().utime; })
      .def_property_readonly("label", [](const LightField& field) { return field.status().label; });
  py::class_<LightHistory>(module, "LightHistory", "The light of a log.")
      .def(py::init<std::vector<fs::path>, std::optional<fs::path>>(), py::arg("files"),
           py::arg("images"))
      .def("field", &LightHistory::field, py::arg("utime"))
      .def("at", &LightHistory::at, py::arg("utime"), py::arg("x"), py::arg("y"));
  py::register_exception<LayerTextError>(module, "LayerError", PyExc_ValueError);
  module.def("light_command", &lightCommand, py::arg("layers"), py::arg("run"),
             "An encoded light_command_t with these layers.");
}

}  // namespace lab::python
