// Camera files: projection of points, rays of pixels.
#include <filesystem>
#include <limits>

#include "base/file.h"
#include "python/bindings.h"
#include "sensor/camera_file.h"

namespace panwright::python {

namespace {

struct CameraOf {
  sensor::CameraFile file;
  sensor::DistortionMap map;
};

constexpr std::uint64_t kMostCameraBytes = 1 << 20;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

CameraOf open_camera(const std::filesystem::path& path) {
  DiagnosticLog log;
  sensor::CameraFile file;
  if (const auto text = read_file(path, kMostCameraBytes, log))
    if (auto read = sensor::read_camera(*text, path.string(), log)) file = *std::move(read);
  settle(log);
  return {file, sensor::DistortionMap(file.lens.distortion)};
}

py::array_t<double> camera_project(const CameraOf& camera, const Numbers& points) {
  const std::size_t count = rows_of(points, 3, "points");
  py::array_t<double> out(points.ndim() == 1
                              ? std::vector<py::ssize_t>{2}
                              : std::vector<py::ssize_t>{static_cast<py::ssize_t>(count), 2});
  const double* from = points.data();
  double* to = out.mutable_data();
  const py::gil_scoped_release released;
  for (std::size_t i = 0; i < count; ++i, from += 3, to += 2) {
    const Vec3 point(from[0], from[1], from[2]);
    std::optional<Vec2> place;
    if (camera.file.width_m > 0)
      place = Vec2(point);
    else
      place = camera.map.place(point);
    for (int k = 0; k < 2; ++k)
      to[k] =
          place ? camera.file.lens.focal[k] * (*place)[k] + camera.file.lens.principal[k] : kNone;
  }
  return out;
}

py::array_t<double> camera_rays(const CameraOf& camera, const Numbers& pixels) {
  if (camera.file.width_m > 0)
    throw py::value_error("the camera is orthographic: its rays are parallel to the boresight");
  const std::size_t count = rows_of(pixels, 2, "pixels");
  py::array_t<double> out(pixels.ndim() == 1
                              ? std::vector<py::ssize_t>{3}
                              : std::vector<py::ssize_t>{static_cast<py::ssize_t>(count), 3});
  const double* from = pixels.data();
  double* to = out.mutable_data();
  const py::gil_scoped_release released;
  for (std::size_t i = 0; i < count; ++i, from += 2, to += 3) {
    const Vec2 place =
        (Vec2(from[0], from[1]) - camera.file.lens.principal) / camera.file.lens.focal;
    const auto ray = camera.map.ray(place);
    for (int k = 0; k < 3; ++k) to[k] = ray ? ray->direction[k] : kNone;
  }
  return out;
}

}  // namespace

void bind_cameras(py::module_& module) {
  py::class_<CameraOf>(module, "Camera", doc("Camera"))
      .def(py::init(&open_camera), py::arg("path"))
      .def_property_readonly(
          "name", [](const CameraOf& c) { return c.file.name; }, doc("Camera.name"))
      .def_property_readonly(
          "width", [](const CameraOf& c) { return c.file.width; }, doc("Camera.width"))
      .def_property_readonly(
          "height", [](const CameraOf& c) { return c.file.height; }, doc("Camera.height"))
      .def_property_readonly(
          "matrix",
          [](const CameraOf& c) {
            Mat4 m(1);
            for (int k = 0; k < 2; ++k) {
              m[k][k] = c.file.lens.focal[k];
              m[2][k] = c.file.lens.principal[k];
            }
            return array_of(m)[py::make_tuple(py::slice(0, 3, 1), py::slice(0, 3, 1))];
          },
          doc("Camera.matrix"))
      .def_property_readonly(
          "distortion",
          [](const CameraOf& c) { return sensor::distortion_text(c.file.lens.distortion); },
          doc("Camera.distortion"))
      .def("project", &camera_project, py::arg("points"), doc("Camera.project"))
      .def("rays", &camera_rays, py::arg("pixels"), doc("Camera.rays"));
}

}  // namespace panwright::python
