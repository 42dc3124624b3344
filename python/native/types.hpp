/// Message types by name, for Python.
#pragma once

#include <string>

#include "common/schema/schema.hpp"

namespace lab::python {

/// @throws ValueError if there is none
[[nodiscard]] const schema::Type& typeOf(const std::string& name);

}  // namespace lab::python
