// Images, their layers and labels.
#include <algorithm>
#include <filesystem>
#include <functional>

#include "image/png.h"
#include "python/bindings.h"
#include "python/picture.h"

namespace panwright::python {

namespace {

using image::FileLayer;

std::size_t layer_named(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(image::kLayerNames, name) -
                                  std::begin(image::kLayerNames));
}

// none: the image does not have it
py::object layer_of(py::object self, std::size_t layer) {
  const auto& picture = self.cast<const Picture&>();
  const image::Image& image = picture.product.image;
  const auto made = [&]<class T>(const std::vector<T>& data, int channels) -> py::object {
    if (data.empty()) return py::none();
    std::vector<py::ssize_t> shape{image.height, image.width};
    if (channels > 1) shape.push_back(channels);
    return array_of(data, std::move(shape), self);
  };
  switch (static_cast<FileLayer>(layer)) {
    case FileLayer::radiance:
      return made(image.radiance, 3);
    case FileLayer::coverage:
      return made(image.coverage, 1);
    case FileLayer::depth:
      return made(image.depth, 1);
    case FileLayer::range:
      return made(image.range, 1);
    case FileLayer::normal:
      return made(image.normal, 3);
    case FileLayer::target_id:
      return made(image.target_id, 1);
    case FileLayer::node_id:
      return made(image.node_id, 1);
    case FileLayer::material_id:
      return made(image.material_id, 1);
    case FileLayer::standard_error:
      return made(image.standard_error, 3);
    case FileLayer::dn:
      return made(image.dn, 1);
    case FileLayer::electrons:
      return made(image.electrons, 1);
    case FileLayer::stages:
      break;
  }
  return py::none();
}

std::vector<std::string> layer_names(const py::object& self) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < std::size(image::kLayerNames); ++k)
    if (!layer_of(self, k).is_none()) out.emplace_back(image::kLayerNames[k]);
  return out;
}

py::object item(const py::object& self, const std::string& name) {
  const std::size_t layer = layer_named(name);
  py::object out = layer < std::size(image::kLayerNames) ? layer_of(self, layer) : py::none();
  if (!out.is_none()) return out;
  std::string has;
  for (const std::string& each : layer_names(self)) has += (has.empty() ? "" : ", ") + each;
  throw py::key_error(name + ": the image has " + has);
}

py::array_t<std::uint8_t> srgb(const Picture& picture, std::optional<double> ev,
                               std::optional<bool> photo) {
  image::PngExposure exposure = picture.product.exposure;
  if (ev) exposure.stops += *ev - picture.what.ev;
  if (photo) exposure.photo = *photo;
  const std::vector<std::uint8_t> codes = image::png_codes(picture.product.image, exposure);
  py::array_t<std::uint8_t> out({static_cast<py::ssize_t>(picture.what.height),
                                 static_cast<py::ssize_t>(picture.what.width), py::ssize_t{3}});
  std::copy(codes.begin(), codes.end(), out.mutable_data());
  return out;
}

void save_image(Picture& picture, const std::filesystem::path& path) {
  DiagnosticLog log;
  check_output(workspace::CameraInstrument(), path.string(), log);
  if (!log.has_errors()) (void)workspace::write(picture.product, path.string(), log, nullptr);
  settle(log);
}

py::array_t<double> camera_matrix(const Picture& picture) {
  py::array_t<double> out({3, 3});
  auto rows = out.mutable_unchecked<2>();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rows(row, column) = row == column ? 1 : 0;
  for (int k = 0; k < 2; ++k) {
    rows(k, k) = picture.camera.focal[k];
    rows(k, 2) = picture.camera.principal[k];
  }
  return out;
}

py::array_t<std::uint8_t> whole_mask(const labels::Mask& mask, std::uint32_t height,
                                     std::uint32_t width) {
  py::array_t<std::uint8_t> out(
      {static_cast<py::ssize_t>(height), static_cast<py::ssize_t>(width)});
  std::uint8_t* const to = out.mutable_data();
  std::fill_n(to, std::size_t{height} * width, std::uint8_t{0});
  for (std::uint32_t row = 0; row < mask.height; ++row)
    std::copy_n(mask.coverage.data() + std::size_t{row} * mask.width, mask.width,
                to + std::size_t{mask.top + row} * width + mask.left);
  return out;
}

// none: not asked for, or there is no such frame
py::object flow_of(const py::object& self,
                   std::optional<labels::Flow> labels::FrameLabels::*which) {
  const auto& picture = self.cast<const Picture&>();
  const auto* flow = picture.labels ? &((*picture.labels).*which) : nullptr;
  if (flow == nullptr || !*flow) return py::none();
  return array_of((*flow)->motion, {(*flow)->height, (*flow)->width, 2}, self);
}

py::object box_of(const std::optional<labels::Box>& box) {
  if (!box) return py::none();
  return py::make_tuple(box->left, box->top, box->right, box->bottom);
}

// Thing of one image, with the size of that.
struct ThingIn {
  labels::Thing thing;
  std::uint32_t width = 0, height = 0;
};

std::vector<ThingIn> things(const Picture& picture) {
  if (!picture.labels)
    throw py::value_error("the image has no labels, expected one drawn with labels=True");
  std::vector<ThingIn> out;
  for (const labels::Thing& each : picture.labels->things)
    out.push_back({each, picture.what.width, picture.what.height});
  return out;
}

void bind_labels(py::module_& module) {
  using labels::Keypoint;
  py::class_<Keypoint>(module, "Keypoint", doc("Keypoint"))
      .def_readonly("name", &Keypoint::name, doc("Keypoint.name"))
      .def_property_readonly(
          "position", [](const Keypoint& k) { return tuple_of(k.position); },
          doc("Keypoint.position"))
      .def_property_readonly(
          "in_camera", [](const Keypoint& k) { return tuple_of(k.in_camera); },
          doc("Keypoint.in_camera"))
      .def_property_readonly(
          "pixel",
          [](const Keypoint& k) -> py::object {
            if (!k.pixel) return py::none();
            return py::make_tuple(k.pixel->x, k.pixel->y);
          },
          doc("Keypoint.pixel"))
      .def_readonly("truncated", &Keypoint::truncated, doc("Keypoint.truncated"))
      .def_readonly("occluded", &Keypoint::occluded, doc("Keypoint.occluded"))
      .def_readonly("lit", &Keypoint::lit, doc("Keypoint.lit"))
      .def("__repr__", [](const Keypoint& k) { return "<panwright.Keypoint " + k.name + ">"; });
  py::class_<ThingIn>(module, "Thing", doc("Thing"))
      .def_property_readonly(
          "id", [](const ThingIn& t) { return t.thing.id; }, doc("Thing.id"))
      .def_property_readonly(
          "target", [](const ThingIn& t) { return t.thing.target; }, doc("Thing.target"))
      .def_property_readonly(
          "label", [](const ThingIn& t) { return t.thing.label; }, doc("Thing.label"))
      .def_property_readonly(
          "camera_from_thing",
          [](const ThingIn& t) { return array_of(t.thing.camera_from_thing.matrix()); },
          doc("Thing.camera_from_thing"))
      .def_property_readonly(
          "visible",
          [](const ThingIn& t) { return whole_mask(t.thing.visible, t.height, t.width); },
          doc("Thing.visible"))
      .def_property_readonly(
          "amodal", [](const ThingIn& t) { return whole_mask(t.thing.amodal, t.height, t.width); },
          doc("Thing.amodal"))
      .def_property_readonly(
          "visible_box", [](const ThingIn& t) { return box_of(t.thing.visible_box); },
          doc("Thing.visible_box"))
      .def_property_readonly(
          "amodal_box", [](const ThingIn& t) { return box_of(t.thing.amodal_box); },
          doc("Thing.amodal_box"))
      .def_property_readonly(
          "visible_pixels", [](const ThingIn& t) { return t.thing.visible_pixels; },
          doc("Thing.visible_pixels"))
      .def_property_readonly(
          "amodal_pixels", [](const ThingIn& t) { return t.thing.amodal_pixels; },
          doc("Thing.amodal_pixels"))
      .def_property_readonly(
          "keypoints", [](const ThingIn& t) { return t.thing.keypoints; }, doc("Thing.keypoints"))
      .def("__repr__", [](const ThingIn& t) {
        return "<panwright.Thing " + t.thing.target +
               (t.thing.label.empty() ? "" : "/" + t.thing.label) + ">";
      });
}

}  // namespace

void bind_images(py::module_& module) {
  bind_labels(module);
  py::class_<Picture, std::shared_ptr<Picture>>(module, "Image", doc("Image"))
      .def_property_readonly(
          "width", [](const Picture& p) { return p.what.width; }, doc("Image.width"))
      .def_property_readonly(
          "height", [](const Picture& p) { return p.what.height; }, doc("Image.height"))
      .def_property_readonly(
          "unit", [](const Picture& p) { return p.what.unit; }, doc("Image.unit"))
      .def_property_readonly(
          "ev", [](const Picture& p) { return p.what.ev; }, doc("Image.ev"))
      .def_property_readonly(
          "targets", [](const Picture& p) { return p.what.targets; }, doc("Image.targets"))
      .def_property_readonly(
          "error",
          [](const Picture& p) -> py::object {
            if (!p.what.sampling) return py::none();
            return py::float_(p.what.sampling->rmse);
          },
          doc("Image.error"))
      .def_readonly("name", &Picture::name, doc("Image.name"))
      .def_readonly("number", &Picture::number, doc("Image.number"))
      .def_readonly("time", &Picture::time, doc("Image.time"))
      .def_property_readonly("camera_matrix", &camera_matrix, doc("Image.camera_matrix"))
      .def_property_readonly(
          "world_from_camera",
          [](const Picture& p) {
            return array_of(
                matrix_from_trs(p.camera.position, p.camera.world_from_camera, Vec3(1)));
          },
          doc("Image.world_from_camera"))
      .def_property_readonly("things", &things, doc("Image.things"))
      .def_property_readonly(
          "forward_flow",
          [](const py::object& self) { return flow_of(self, &labels::FrameLabels::forward); },
          doc("Image.forward_flow"))
      .def_property_readonly(
          "backward_flow",
          [](const py::object& self) { return flow_of(self, &labels::FrameLabels::backward); },
          doc("Image.backward_flow"))
      .def("_record", [](const Picture& p) { return p.what.record; })
      .def("srgb", &srgb, py::arg("ev") = py::none(), py::arg("photo") = py::none(),
           doc("Image.srgb"))
      .def("save", &save_image, py::arg("path"), doc("Image.save"))
      .def(
          "keys", [](const py::object& self) { return layer_names(self); }, doc("Image.keys"))
      .def("__getitem__", &item)
      .def("__contains__",
           [](const py::object& self, const std::string& name) {
             return std::ranges::count(layer_names(self), name) > 0;
           })
      .def("__iter__", [](const py::object& self) { return py::iter(py::cast(layer_names(self))); })
      .def("__len__", [](const py::object& self) { return layer_names(self).size(); })
      .def("__repr__", [](const Picture& p) {
        return "<panwright.Image " + std::to_string(p.what.width) + "x" +
               std::to_string(p.what.height) + ">";
      });
}

}  // namespace panwright::python
