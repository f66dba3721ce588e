// Parts of the Python module `panwright._core`. Private to python/.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "python/docs.h"

namespace panwright::python {

namespace py = pybind11;

void bind_models(py::module_& module);
void bind_images(py::module_& module);
void bind_drawing(py::module_& module);
void bind_cameras(py::module_& module);
void bind_instruments(py::module_& module);
void bind_materials(py::module_& module);

// Warns of a log's warnings, and raises panwright.Error with all its entries when it has errors.
// Expects: the GIL.
void settle(const DiagnosticLog& log);

// Calls long work without the GIL. Ctrl-C cancels it, and raises KeyboardInterrupt.
//
//   work  of (const Job&), on a thread of its own
// Expects: the GIL.
void without_gil(const Job& job, const std::function<void()>& work);

// Raises panwright.Error in a process that was forked after OpenGL was in use.
void refuse_forked();
// Notes that OpenGL is in use in this process.
void using_opengl();

// Array over memory that `owner` keeps alive. Not copied.
template <class T>
py::array array_of(const std::vector<T>& data, std::vector<py::ssize_t> shape, py::handle owner) {
  return py::array_t<T>(std::move(shape), data.data(), owner);
}

inline py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x, v.y, v.z); }

// Returns a 4×4 array, rows first.
py::array_t<double> array_of(const Mat4& matrix);

// Rows of an array (N, columns), or (columns,) for one.
//
//   name  of the argument, in messages
// Throws ValueError for another shape.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
std::size_t rows_of(const Numbers& array, py::ssize_t columns, const char* name);

}  // namespace panwright::python
