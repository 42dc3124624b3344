/// The parts of the extension module active_lab._core, which binds the C++ core to Python.
#pragma once

#include <pybind11/pybind11.h>

namespace lab::python {

void addSchema(pybind11::module_& module);
void addLogs(pybind11::module_& module);
void addMessages(pybind11::module_& module);
void addLight(pybind11::module_& module);
void addBus(pybind11::module_& module);

}  // namespace lab::python
