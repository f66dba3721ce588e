// Models and their contents.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "geometry/kinematics/joint.h"
#include "python/bindings.h"
#include "python/model.h"
#include "tools/model_json.h"
#include "workspace/open.h"

namespace panwright::python {

namespace {

Model open_model(const std::filesystem::path& path,
                 const std::map<std::string, std::string>& define, const std::string& budget,
                 const std::string& root, const std::string& units, const std::string& up,
                 bool cache, std::size_t threads) {
  workspace::OpenOptions options;
  options.root = root;
  options.budget = budget;
  options.parameters.assign(define.begin(), define.end());
  options.cad.units = units;
  options.cad.up = up;
  if (cache) options.cache = workspace::user_cache_folder();
  const Job job({threads, {}});
  DiagnosticLog log;
  Model out;
  without_gil(job, [&] {
    try {
      auto opened = workspace::open(path, options, log, job);
      if (opened) out.model = *std::move(opened);
    } catch (...) {
      report_exception(log);
    }
  });
  settle(log);
  out.path = path.string();
  return out;
}

void save(const Model& model, const std::filesystem::path& path) {
  DiagnosticLog log;
  if (auto file = AtomicFile::create(path, log))
    if (file->write(model.model->bytes(), log)) (void)file->commit(log);
  settle(log);
}

std::vector<std::string> nodes(const Model& model) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < model.model->nodes().size(); ++i)
    out.push_back(model.model->node_path(i));
  return out;
}

std::vector<std::string> materials(const Model& model) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < model.model->materials().size(); ++i)
    out.emplace_back(model.model->material_name(i));
  return out;
}

struct JointInfo {
  std::string name, kind;
  std::vector<double> value, lower, upper;
};

std::vector<JointInfo> joints(const Model& model) {
  const geometry::JointSet set = model.model->joint_set();
  const auto initial = model.model->initial_values();
  std::vector<JointInfo> out;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const geometry::Joint& joint = set[i];
    const auto count = static_cast<std::ptrdiff_t>(geometry::value_count(joint.kind));
    const auto numbers = [&](const geometry::JointValues& values) {
      return std::vector<double>(values.begin(), values.begin() + count);
    };
    JointInfo info{std::string(model.model->joint_name(i)),
                   std::string(geometry::kind_name(joint.kind)),
                   numbers(initial[i]),
                   {},
                   {}};
    if (joint.limited) {
      info.lower = numbers(joint.lower);
      info.upper = numbers(joint.upper);
    }
    out.push_back(std::move(info));
  }
  return out;
}

py::object bounds(const Model& model) {
  const auto box = model.model->world_bounds();
  if (!box) return py::none();
  py::array_t<double> out({2, 3});
  auto corners = out.mutable_unchecked<2>();
  for (int k = 0; k < 3; ++k) {
    corners(0, k) = box->low[k];
    corners(1, k) = box->high[k];
  }
  return out;
}

// Finest meshes of all instances in the model's axes, joints at their initial values.
py::tuple mesh(const Model& held) {
  const pan::Model& model = *held.model;
  std::size_t vertices = 0, triangles = 0;
  for (const auto& instance : model.instances()) {
    const pan::MeshView view = model.mesh(instance.mesh);
    vertices += view.positions.size();
    triangles += view.indices.size() / 3;
  }
  py::array_t<double> points({static_cast<py::ssize_t>(vertices), py::ssize_t{3}});
  py::array_t<std::uint32_t> faces({static_cast<py::ssize_t>(triangles), py::ssize_t{3}});
  double* point = points.mutable_data();
  std::uint32_t* face = faces.mutable_data();
  const std::vector<Mat4> world = model.world_from_nodes();
  std::uint32_t first = 0;
  for (const auto& instance : model.instances()) {
    const pan::MeshView view = model.mesh(instance.mesh);
    const auto& record = model.meshes()[instance.mesh];
    const Vec3 origin(record.origin[0], record.origin[1], record.origin[2]);
    for (const auto& each : view.positions) {
      const Vec4 placed = world[instance.node] * Vec4(origin + Vec3(each.x, each.y, each.z), 1);
      for (int k = 0; k < 3; ++k) *point++ = placed[k];
    }
    for (std::size_t k = 0; k < view.indices.size(); ++k) *face++ = first + view.indices[k];
    first += static_cast<std::uint32_t>(view.positions.size());
  }
  return py::make_tuple(points, faces);
}

std::string tables(const Model& model) {
  const std::vector<Mat4> world = model.model->world_from_nodes();
  nlohmann::ordered_json out = tools::tables_json(*model.model, world);
  out.update(tools::ground_truth_json(*model.model, world));
  out["budget"] = tools::budget_json(*model.model);
  return out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

void bind_models(py::module_& module) {
  py::class_<JointInfo>(module, "Joint", doc("Joint"))
      .def_readonly("name", &JointInfo::name, doc("Joint.name"))
      .def_readonly("kind", &JointInfo::kind, doc("Joint.kind"))
      .def_readonly("value", &JointInfo::value, doc("Joint.value"))
      .def_readonly("lower", &JointInfo::lower, doc("Joint.lower"))
      .def_readonly("upper", &JointInfo::upper, doc("Joint.upper"))
      .def("__repr__", [](const JointInfo& joint) {
        return "<panwright.Joint " + joint.name + ", " + joint.kind + ">";
      });
  py::class_<Model>(module, "Model", doc("Model"))
      .def_property_readonly(
          "name", [](const Model& model) { return model.model->name(); }, doc("Model.name"))
      .def_readonly("path", &Model::path, doc("Model.path"))
      .def_property_readonly(
          "build_id", [](const Model& model) { return model.model->build_id().hex(); },
          doc("Model.build_id"))
      .def_property_readonly("nodes", &nodes, doc("Model.nodes"))
      .def_property_readonly("materials", &materials, doc("Model.materials"))
      .def_property_readonly("joints", &joints, doc("Model.joints"))
      .def_property_readonly("bounds", &bounds, doc("Model.bounds"))
      .def("mesh", &mesh, doc("Model.mesh"))
      .def("save", &save, py::arg("path"), doc("Model.save"))
      .def("_tables", &tables)
      .def("__repr__",
           [](const Model& model) { return "<panwright.Model " + model.model->name() + ">"; });
  module.def("open_model", &open_model, py::arg("path"), py::arg("define"), py::arg("budget"),
             py::arg("root"), py::arg("units"), py::arg("up"), py::arg("cache"), py::arg("threads"),
             doc("open_model"));
}

}  // namespace panwright::python
