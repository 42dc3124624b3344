#include "python/native/module.hpp"

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>

#include "common/bus/bus_error.hpp"
#include "common/bus/message_header.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/files/toml_text.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"

namespace {

/// A name of a file may have bytes that are no text, which Python keeps as surrogates.
std::string printable(const pybind11::str& text) {
  const pybind11::bytes bytes = text.attr("encode")("utf-8", "surrogatepass");
  return lab::printable(std::string(bytes));
}

/// tomllib keeps every beginning of a key: of a key of 20 000 names they take 1.6 GB.
void checkToml(const std::string& text) {
  constexpr std::uintmax_t kMost = lab::file_kinds::kExperiment.most_bytes;
  if (text.size() > kMost) {
    throw pybind11::value_error("found " + std::to_string(text.size()) +
                                " bytes, expected at most " + std::to_string(kMost));
  }
  try {
    static_cast<void>(lab::keys::parseToml(text, ""));
  } catch (const lab::keys::TomlError& error) {
    throw pybind11::value_error("line " + std::to_string(error.at().line) + ": " +
                                lab::printable(error.what()));
  }
}

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ core of Active Lab: logs, messages, light, bus. Use active_lab instead.";
  module.attr("version") = lab::kVersion;
  module.attr("contract_version") = lab::kContractVersion;
  module.attr("longest_sender") = lab::kLongestSender;
  pybind11::register_exception<lab::BusError>(module, "BusError", PyExc_OSError);
  pybind11::register_exception<lab::ExperimentError>(module, "ExperimentError", PyExc_ValueError);
  module.def("printable", &printable, pybind11::arg("text"),
             "A text of others as it may be written on a terminal, in one line.");
  module.def(
      "check_toml", &checkToml, pybind11::arg("text"),
      "Raises ValueError for a text that no file of the lab has: it is no TOML, a key has too "
      "many names, it is above the size of experiment files.");
  lab::python::addSchema(module);
  lab::python::addLogs(module);
  lab::python::addMessages(module);
  lab::python::addLight(module);
  lab::python::addBus(module);
}

}  // namespace
