// Materials on arrays, and sheets of foil.
#include <algorithm>
#include <cmath>
#include <optional>

#include "materials/brdf.h"
#include "mli/preset.h"
#include "mli/sheet.h"
#include "pxn/materials.h"
#include "python/bindings.h"

namespace panwright::python {

namespace {

struct MaterialOf {
  materials::Material material;
  std::shared_ptr<const materials::f64::CompiledBrdf> brdf;
};

MaterialOf open_material(const std::string& name, const std::string& file) {
  DiagnosticLog log;
  materials::Material found;
  if (file.empty()) {
    if (auto preset = pxn::preset(name, log)) found = std::move(preset->material);
  } else if (const auto all = pxn::read_materials(file, {}, log)) {
    const auto at = std::ranges::find_if(
        *all, [&](const pxn::DescribedMaterial& each) { return each.material.name == name; });
    if (at == all->end()) throw py::key_error("no material " + name + " in " + file);
    found = at->material;
  }
  settle(log);
  return {found, std::make_shared<const materials::f64::CompiledBrdf>(found)};
}

// The row of an array that has one row for all, or one each.
Vec3 unit_row(const Numbers& array, std::size_t rows, std::size_t i) {
  const double* at = array.data() + (rows == 1 ? 0 : 3 * i);
  const Vec3 v(at[0], at[1], at[2]);
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : Vec3(0);
}

py::array_t<double> brdf_of(const MaterialOf& material, const Numbers& to_light,
                            const Numbers& to_viewer, const std::optional<Numbers>& given) {
  const Numbers normal = given ? *given : Numbers(py::make_tuple(0, 0, 1));
  const std::size_t lights = rows_of(to_light, 3, "to_light");
  const std::size_t viewers = rows_of(to_viewer, 3, "to_viewer");
  const std::size_t normals = rows_of(normal, 3, "normal");
  const std::size_t count = std::max({lights, viewers, normals});
  for (const std::size_t each : {lights, viewers, normals})
    if (each != 1 && each != count)
      throw py::value_error("to_light, to_viewer and normal have different numbers of rows");
  py::array_t<double> out(to_light.ndim() == 1 && to_viewer.ndim() == 1 && normal.ndim() == 1
                              ? std::vector<py::ssize_t>{3}
                              : std::vector<py::ssize_t>{static_cast<py::ssize_t>(count), 3});
  double* to = out.mutable_data();
  const py::gil_scoped_release released;
  for (std::size_t i = 0; i < count; ++i, to += 3) {
    const Vec3 l = unit_row(to_light, lights, i), v = unit_row(to_viewer, viewers, i);
    const Vec3 n = unit_row(normal, normals, i);
    const bool sound = l != Vec3(0) && v != Vec3(0) && n != Vec3(0);
    const Vec3 f = sound ? material.brdf->brdf(l, v, n) : Vec3(std::nan(""));
    for (int k = 0; k < 3; ++k) to[k] = f[k];
  }
  return out;
}

mli::Sheet made_sheet(const std::string& preset, double width, double height, std::uint32_t cells,
                      std::uint32_t seed, std::size_t threads) {
  const auto operations = mli::preset_operations(preset, height);
  if (!operations) {
    std::string names;
    for (const mli::Preset& each : mli::presets())
      names += (names.empty() ? "" : ", ") + std::string(each.name);
    throw py::value_error("no preset of foil '" + preset + "', expected " + names);
  }
  const auto& all = mli::presets();
  const double cell =
      std::ranges::find_if(all, [&](const mli::Preset& each) { return each.name == preset; })->cell;
  mli::Recipe recipe{width, height, cells, seed, *operations};
  if (cells == 0)
    recipe.xgrid = static_cast<std::uint32_t>(std::clamp(std::ceil(width / cell), 1.0, 1e5));
  const Job job({threads, {}});
  DiagnosticLog log;
  mli::Sheet out;
  without_gil(job, [&] {
    try {
      if (auto sheet = mli::made(recipe, {}, log, {}, job)) out = *std::move(sheet);
    } catch (...) {
      report_exception(log);
    }
  });
  settle(log);
  return out;
}

}  // namespace

void bind_materials(py::module_& module) {
  py::class_<MaterialOf>(module, "Material", doc("Material"))
      .def(py::init(&open_material), py::arg("name"), py::arg("file"))
      .def_property_readonly(
          "name", [](const MaterialOf& m) { return m.material.name; }, doc("Material.name"))
      .def("brdf", &brdf_of, py::arg("to_light"), py::arg("to_viewer"),
           py::arg("normal") = py::none(), doc("Material.brdf"));
  py::class_<mli::Sheet>(module, "Sheet", doc("Sheet"))
      .def(py::init(&made_sheet), py::arg("preset"), py::arg("width"), py::arg("height"),
           py::arg("cells"), py::arg("seed"), py::arg("threads"))
      .def_property_readonly(
          "heights",
          [](const py::object& self) {
            const auto& sheet = self.cast<const mli::Sheet&>();
            return array_of(sheet.heights, {sheet.rows, sheet.columns}, self);
          },
          doc("Sheet.heights"))
      .def_property_readonly(
          "spacing",
          [](const mli::Sheet& sheet) { return py::make_tuple(sheet.spacing.x, sheet.spacing.y); },
          doc("Sheet.spacing"))
      .def_property_readonly(
          "height_rms", [](const mli::Sheet& sheet) { return sheet.statistics.height_rms; },
          doc("Sheet.height_rms"))
      .def_property_readonly(
          "slope_rms", [](const mli::Sheet& sheet) { return sheet.statistics.slope_rms; },
          doc("Sheet.slope_rms"));
  module.def(
      "material_names",
      [] {
        std::vector<std::string> out;
        for (const std::string_view name : pxn::preset_names()) out.emplace_back(name);
        return out;
      },
      doc("material_names"));
}

}  // namespace panwright::python
