#include "python/native/module.hpp"

#include <pybind11/pybind11.h>

#include "common/bus/bus_error.hpp"
#include "common/files/experiment_error.hpp"
#include "common/process/version.hpp"

namespace {

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ core of Active Lab: logs, messages, light, bus. Use active_lab instead.";
  module.attr("version") = lab::kVersion;
  module.attr("contract_version") = lab::kContractVersion;
  pybind11::register_exception<lab::BusError>(module, "BusError", PyExc_OSError);
  pybind11::register_exception<lab::ExperimentError>(module, "ExperimentError", PyExc_ValueError);
  lab::python::addSchema(module);
  lab::python::addLogs(module);
  lab::python::addMessages(module);
  lab::python::addLight(module);
  lab::python::addBus(module);
}

}  // namespace
