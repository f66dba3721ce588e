#include <unistd.h>

#include <atomic>
#include <functional>
#include <future>

#include "python/bindings.h"
#include "tools/run.h"

namespace panwright::python {

namespace {

std::atomic<pid_t> g_opengl_process = 0;  // 0: none

int run_command(const std::vector<std::string>& arguments) {
  std::vector<const char*> words{"panwright"};
  for (const std::string& each : arguments) words.push_back(each.c_str());
  const py::gil_scoped_release released;
  return tools::run(static_cast<int>(words.size()), words.data());
}

}  // namespace

void settle(const DiagnosticLog& log) {
  if (log.entries().empty()) return;
  py::module_::import("panwright._diagnostics")
      .attr("settle")(to_json(log), to_text(log), exit_code(log));
}

void without_gil(const Job& job, const std::function<void()>& work) {
  std::future<void> done;
  const auto wait = [&] {
    const py::gil_scoped_release released;
    constexpr auto kPause = std::chrono::milliseconds(50);
    return done.wait_for(kPause) == std::future_status::ready;
  };
  done = std::async(std::launch::async, work);
  bool interrupted = false;
  while (!wait())
    if (!interrupted && PyErr_CheckSignals() != 0) {
      interrupted = true;
      job.cancel();
    }
  if (interrupted) throw py::error_already_set();
  done.get();
}

void using_opengl() { g_opengl_process = getpid(); }

void refuse_forked() {
  const pid_t process = g_opengl_process;
  if (process == 0 || process == getpid()) return;
  throw py::value_error(
      "OpenGL is in use in the process that this one was forked from: start processes with "
      "multiprocessing's method 'spawn'");
}

py::array_t<double> array_of(const Mat4& matrix) {
  py::array_t<double> out({4, 4});
  auto rows = out.mutable_unchecked<2>();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) rows(row, column) = matrix[column][row];
  return out;
}

std::size_t rows_of(const Numbers& array, py::ssize_t columns, const char* name) {
  if (array.ndim() < 1 || array.ndim() > 2 || array.shape(array.ndim() - 1) != columns)
    throw py::value_error(std::string(name) + " has another shape, expected (N, " +
                          std::to_string(columns) + ") or (" + std::to_string(columns) + ",)");
  return array.ndim() == 1 ? 1 : static_cast<std::size_t>(array.shape(0));
}

}  // namespace panwright::python

PYBIND11_MODULE(_core, module) {
  using namespace panwright::python;
  module.attr("version") = PANWRIGHT_VERSION;
  bind_models(module);
  bind_images(module);
  bind_drawing(module);
  bind_cameras(module);
  bind_instruments(module);
  bind_materials(module);
  module.def("run_command", &run_command, py::arg("arguments"));
}
