// Docstrings, those of panwright/_core.pyi.
#pragma once

#include <string_view>

namespace panwright::python {

// Returns the docstring of "Class", "Class.member" or "function"; empty: none.
const char* doc(std::string_view name);

}  // namespace panwright::python
