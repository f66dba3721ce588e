// Renderers and scenarios.
#include <optional>
#include <tuple>
#include <utility>

#include "python/bindings.h"
#include "python/model.h"
#include "python/worker.h"
#include "workspace/labelling.h"
#include "workspace/scenario.h"
#include "workspace/sky_settings.h"
#include "workspace/targets.h"

namespace panwright::python {

namespace {

using workspace::View;

// Sets the labels of a view; those of a renderer's are numbered from 0.
void label(View& view, const std::shared_ptr<const workspace::Labelling>& labelling,
           std::string name, std::uint64_t number, double time) {
  view.labels = std::make_shared<const workspace::ViewLabels>(
      workspace::ViewLabels{labelling, std::move(name), number, time, nullptr, nullptr});
}

View view_of_text(const std::string& text, std::size_t index, bool labels) {
  DiagnosticLog log;
  View view;
  (void)workspace::parse_view(text, index, {}, view, log);
  settle(log);
  if (view.settings.outputs || view.settings.targets)
    throw py::value_error(
        "a view of a renderer has neither output nor targets: Image.save() writes a file");
  view.settings.outputs = std::vector<std::string>();
  static const auto all = std::make_shared<const workspace::Labelling>();
  if (labels) label(view, all, *view.settings.name, index, 0);
  return view;
}

struct ScenarioOf {
  workspace::Scenario scenario;
  std::vector<double> times;
  std::shared_ptr<const workspace::Labelling> labelling;  // null: not asked for yet
};

// settings: members of a view, in place of the scenario's
std::shared_ptr<ScenarioOf> open_scenario(const std::string& path, const std::string& target,
                                          bool strict, const std::string& settings) {
  DiagnosticLog log;
  View own;
  (void)workspace::parse_view(settings, 0, {}, own, log);
  settle(log);
  auto out = std::make_shared<ScenarioOf>();
  if (auto opened = workspace::open_scenario(path, {target, strict}, log)) {
    out->scenario = *std::move(opened);
    workspace::Settings& all = out->scenario.settings;
    all = workspace::with_defaults(std::move(own.settings), all);
    if (auto times = workspace::frame_times(out->scenario, {}, log)) out->times = *std::move(times);
  }
  settle(log);
  return out;
}

std::vector<double> times_every(const ScenarioOf& of, double every) {
  DiagnosticLog log;
  workspace::FrameChoice choice;
  choice.every = every;
  const auto times = workspace::frame_times(of.scenario, choice, log);
  settle(log);
  return times ? *times : std::vector<double>{};
}

// A frame without labels, and its name.
std::pair<View, std::string> bare_view(const std::shared_ptr<ScenarioOf>& of, double time,
                                       std::uint64_t number, const Worker& worker) {
  DiagnosticLog log;
  const auto frame = workspace::frame_at(of->scenario, time, log);
  auto view = frame ? workspace::view_of(of->scenario, *frame, number, worker.world(), log)
                    : Result<View>(failed);
  settle(log);
  view->settings.targets = std::vector<std::string>();
  view->settings.outputs = std::vector<std::string>();
  if (view->motion)  // which refers to the scenario
    view->motion = [motion = std::move(view->motion), of](double after, DiagnosticLog& reports) {
      return motion(after, reports);
    };
  return {*std::move(view), frame->name};
}

// at: the times of the frame, and of those before and after it
View view_at(const std::shared_ptr<ScenarioOf>& of,
             const std::tuple<double, std::optional<double>, std::optional<double>>& at,
             std::uint64_t number, bool labels, bool flow, const Worker& worker) {
  const auto& [time, before, after] = at;
  auto [view, name] = bare_view(of, time, number, worker);
  if (of->labelling == nullptr)
    of->labelling = std::make_shared<const workspace::Labelling>(
        of->scenario.labels.value_or(workspace::Labelling()));
  flow = flow || of->labelling->flow;
  if (!labels && !flow && !of->scenario.labels) return view;
  workspace::ViewLabels of_view{of->labelling, std::move(name), number, time, nullptr, nullptr};
  const auto neighbour = [&](const std::optional<double>& when, std::uint64_t which) {
    return flow && when ? std::make_shared<const View>(bare_view(of, *when, which, worker).first)
                        : nullptr;
  };
  of_view.previous = neighbour(before, number - 1);
  of_view.next = neighbour(after, number + 1);
  view.labels = std::make_shared<const workspace::ViewLabels>(std::move(of_view));
  return std::move(view);
}

std::unique_ptr<Worker> make_worker(const std::vector<std::pair<std::string, Model>>& targets,
                                    const std::string& gl) {
  refuse_forked();
  const auto kind = preview::context_kind_from_name(gl);
  if (!kind) throw py::value_error("gl is '" + gl + "', expected auto, egl or osmesa");
  DiagnosticLog log;
  world::World world;
  workspace::RecordSource source;
  for (const auto& [name, model] : targets) {
    (void)world.add(name, model.model, log);
    source.files.push_back(model.path);
  }
  settle(log);
  return std::make_unique<Worker>(std::move(world), std::move(source), *kind);
}

std::shared_ptr<Batch> begin(Worker& worker, std::vector<View> views, std::uint64_t first,
                             std::size_t threads) {
  if (worker.closed()) throw py::value_error("the renderer is closed");
  refuse_forked();
  using_opengl();
  auto batch = std::make_shared<Batch>(std::move(views), first, threads);
  worker.begin(batch);
  return batch;
}

// Returns the next image, or None. Ctrl-C cancels the batch.
py::object next_image(const std::shared_ptr<Batch>& batch) {
  std::shared_ptr<Picture> picture;
  for (bool ready = false; !ready;) {
    {
      const py::gil_scoped_release released;
      ready = batch->next(picture);
    }
    if (!ready && PyErr_CheckSignals() != 0) {
      batch->job.cancel();
      throw py::error_already_set();
    }
  }
  if (picture) return py::cast(picture);
  settle(batch->log);
  return py::none();
}

py::dict info_of(const Worker& worker) {
  const workspace::EngineInfo info = worker.info();
  py::dict out;
  out["renderer"] = info.renderer;
  out["version"] = info.version;
  out["hardware"] = info.hardware;
  return out;
}

}  // namespace

void bind_drawing(py::module_& module) {
  py::class_<View>(module, "View");
  py::class_<Batch, std::shared_ptr<Batch>>(module, "Batch")
      .def("next", &next_image)
      .def("cancel", [](const Batch& batch) { batch.job.cancel(); });
  py::class_<Worker>(module, "Worker")
      .def(py::init(&make_worker), py::arg("targets"), py::arg("gl"))
      .def("begin", &begin, py::arg("views"), py::arg("first"), py::arg("threads"))
      .def("close", &Worker::close, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("closed", &Worker::closed)
      .def_property_readonly("info", &info_of)
      .def_property_readonly("targets", [](const Worker& worker) {
        std::vector<std::string> out;
        for (const world::Instance& each : worker.world().instances()) out.push_back(each.name());
        return out;
      });
  py::class_<ScenarioOf, std::shared_ptr<ScenarioOf>>(module, "Scenario")
      .def(py::init(&open_scenario), py::arg("path"), py::arg("target"), py::arg("strict"),
           py::arg("settings"))
      .def_readonly("times", &ScenarioOf::times)
      .def("times_every", &times_every, py::arg("seconds"))
      .def_property_readonly("targets",
                             [](const ScenarioOf& of) {
                               std::vector<std::pair<std::string, std::string>> out;
                               if (!of.scenario.settings.targets) return out;
                               for (const std::string& text : *of.scenario.settings.targets) {
                                 const workspace::TargetFile file = workspace::target_file(text);
                                 out.emplace_back(file.name, file.file.string());
                               }
                               return out;
                             })
      .def("view", &view_at, py::arg("times"), py::arg("number"), py::arg("labels"),
           py::arg("flow"), py::arg("worker"));
  module.def("view", &view_of_text, py::arg("text"), py::arg("index"), py::arg("labels"));
}

}  // namespace panwright::python
