#include "python/native/module.hpp"

#include <pybind11/pybind11.h>

#include <string>

#include "common/bus/bus_error.hpp"
#include "common/files/experiment_error.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"

namespace {

/// A name of a file may have bytes that are no text, which Python keeps as surrogates.
std::string printable(const pybind11::str& text) {
  const pybind11::bytes bytes = text.attr("encode")("utf-8", "surrogatepass");
  return lab::printable(std::string(bytes));
}

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ core of Active Lab: logs, messages, light, bus. Use active_lab instead.";
  module.attr("version") = lab::kVersion;
  module.attr("contract_version") = lab::kContractVersion;
  pybind11::register_exception<lab::BusError>(module, "BusError", PyExc_OSError);
  pybind11::register_exception<lab::ExperimentError>(module, "ExperimentError", PyExc_ValueError);
  module.def("printable", &printable, pybind11::arg("text"),
             "A text of others as it may be written on a terminal, in one line.");
  lab::python::addSchema(module);
  lab::python::addLogs(module);
  lab::python::addMessages(module);
  lab::python::addLight(module);
  lab::python::addBus(module);
}

}  // namespace
