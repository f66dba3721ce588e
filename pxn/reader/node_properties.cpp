// What nodes, shapes, frames and keypoints say about themselves.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "pxn/reader/loader.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;
using schemas::ElementId;

namespace {

// what public files round their quaternions to
constexpr double kLengthTolerance = 1e-3;
// what normalising leaves of 1: a quaternion written with all its digits comes back bit for bit
constexpr double kRounding = 1e-15;
// radians: below it, two directions do not fix a frame
constexpr double kParallel = 1e-6;

}  // namespace

// Name, placement, material and tolerance, as far as the element has them; kNoProperties when it
// says nothing. Nodes that level 0 knows as well always get details.
std::uint32_t Loader::read_properties(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  NodeProperties properties;
  bool any = document.elements[element].id != ElementId::repeat;
  const auto given = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto which = attribute_of(document, element, name);
    if (!which || !values.has(element, *which)) return std::nullopt;
    any = true;
    return which;
  };
  if (work.file.units.level >= 1) {
    if (const auto which = given("name"))
      properties.name = values.text(element, *which).value_or("");
    if (const auto which = given("label"))
      properties.marks.label = values.text(element, *which).value_or("");
    if (const auto which = given("material"))
      if (Definition* material =
              look_up(work.file, element, *which, work.file.materials, "material"))
        if (const auto index = material_of(*material))
          properties.material = static_cast<std::int32_t>(*index);
    if (const auto which = given("back")) properties.back = back_of(work.file, element, *which);
    if (const auto which = given("tolerance")) properties.tolerance = values.real(element, *which);
    if (const auto which = given("foil"))
      properties.foil = foil_named(values.text(element, *which).value_or(""));
    const auto translate = given("translate");
    const auto scale = given("scale");
    const bool rotated = given("rotate").has_value(), by_quat = given("quat").has_value();
    const bool turned = rotated || by_quat;
    if (translate || scale || turned) {
      scene::Transform transform;
      // one with a number that is wrong does nothing
      const auto vector = [&](std::size_t which, Vec3& out) {
        Vec3 read(0);
        if (values.numbers(element, which, std::span(&read.x, 3))) out = read;
      };
      if (translate) vector(*translate, transform.translation);
      if (scale) vector(*scale, transform.scale);
      if (turned) read_rotation(work, element, transform.rotation);
      properties.transform = transform;
    }
  }
  if (!any) return kNoProperties;
  work.part.properties.push_back(std::move(properties));
  return static_cast<std::uint32_t>(work.part.properties.size() - 1);
}

// From rotate= or quat=; false when neither can be read.
bool Loader::read_rotation(Work& work, std::uint32_t element, Quat& out) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const auto rotate = attribute_of(document, element, "rotate");
  Vec3 angles(0);
  if (rotate && values.numbers(element, *rotate, std::span(&angles.x, 3))) {
    out = quat_from_fixed_xyz(angles);
    return true;
  }
  const auto quat = attribute_of(document, element, "quat");
  double q[4] = {1, 0, 0, 0};
  if (!quat || !values.numbers(element, *quat, q)) return false;
  const auto unit = unit_quat(work, element, values.value_place(element, *quat), q);
  if (unit) out = *unit;
  return unit.has_value();
}

std::optional<Quat> Loader::unit_quat(Work& work, std::uint32_t element, SourceSpan where,
                                      std::span<const double> q) {
  const double length = glm::length(Vec4(q[0], q[1], q[2], q[3]));
  if (std::abs(length - 1) <= kRounding) return Quat(q[0], q[1], q[2], q[3]);
  if (std::abs(length - 1) <= kLengthTolerance)
    return Quat(q[0] / length, q[1] / length, q[2] / length, q[3] / length);
  reporter_.report(Code("E1206"), where, work.file.document, element, [&] {
    return Reporter::Text(fmt::format(
        "the quaternion has length {:.6g}, expected w x y z of length 1 to 1e-3", length));
  });
  return std::nullopt;
}

// Level 0's scaling, rotation, translation and quat.
void Loader::read_placing_children(Work& work, std::uint32_t element, scene::Transform& transform) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  Vec3 numbers(0);
  const auto read = [&](ElementId id) {
    const std::uint32_t child = child_of(document, element, id);
    return child != 0 && values.numbers(child, std::span(&numbers.x, 3));
  };
  if (read(ElementId::scaling)) transform.scale = numbers;
  if (read(ElementId::translation)) transform.translation = numbers;
  if (read(ElementId::rotation)) {
    transform.rotation = quat_from_fixed_xyz(numbers);
    const int turns = (numbers.x != 0) + (numbers.y != 0) + (numbers.z != 0);
    if (turns > 1) {
      const std::uint32_t child = child_of(document, element, ElementId::rotation);
      reporter_.report(Code("N1209"), document.tag_span(child), document, child, [&] {
        return Reporter::Text(fmt::format(
            "rotation about {} axes is read as x first, then y, then z, about fixed axes", turns));
      });
    }
  }
  double q[4] = {1, 0, 0, 0};
  const std::uint32_t child = child_of(document, element, ElementId::quat);
  if (child != 0 && values.numbers(child, q))
    if (const auto unit = unit_quat(work, child, document.tag_span(child), q))
      transform.rotation = *unit;
}

// ---- frames and keypoints

void Loader::read_frame_s(Work& work, std::uint32_t element) {
  const auto label = work.file.values->text(element, attribute::frame_s_label);
  auto frame = read_frame_axes(work.file.document, element, *work.file.values, reporter_);
  if (!label || !frame) return;
  frame->label = *label;
  work.part.frames.push_back(*frame);
  add_item(work, ItemKind::frame, element, static_cast<std::uint32_t>(work.part.frames.size() - 1));
}

void Loader::read_frame(Work& work, std::uint32_t element) {
  Values& values = *work.file.values;
  const xml::Document& document = work.file.document;
  const auto name = values.text(element, attribute::frame_name);
  PartFrame frame{{}, Vec3(0), Quat(1, 0, 0, 0)};
  values.numbers(element, attribute::frame_translate, std::span(&frame.origin.x, 3));
  Vec3 forward(0);
  Vec3 up(0);
  if (values.numbers(element, attribute::frame_forward, std::span(&forward.x, 3)) &&
      values.numbers(element, attribute::frame_up, std::span(&up.x, 3))) {
    const auto rotation = looking(forward, up);
    if (!rotation) {
      reporter_.report(Code("E1207"), document.tag_span(element), document, element, [&] {
        return Reporter::Text(
            "forward and up do not fix a frame: one of them is 0, or they are parallel");
      });
      return;
    }
    frame.rotation = *rotation;
  } else {
    read_rotation(work, element, frame.rotation);
  }
  if (!name) return;
  frame.label = *name;
  work.part.frames.push_back(std::move(frame));
  add_item(work, ItemKind::frame, element, static_cast<std::uint32_t>(work.part.frames.size() - 1));
}

std::optional<Quat> looking(Vec3 forward, Vec3 up) {
  for (Vec3* v : {&forward, &up}) {
    const double scale = std::max({std::abs(v->x), std::abs(v->y), std::abs(v->z)});
    if (scale == 0) return std::nullopt;
    *v = glm::normalize(*v / scale);
  }
  const Vec3 right = glm::cross(forward, up);
  if (glm::length(right) < kParallel) return std::nullopt;
  const Vec3 x = glm::normalize(right);
  return glm::normalize(glm::quat_cast(Mat3(x, glm::cross(forward, x), forward)));
}

void Loader::read_keypoint(Work& work, std::uint32_t element) {
  const auto name = work.file.values->text(element, attribute::keypoint_name);
  PartKeypoint point{{}, Vec3(0)};
  const bool there =
      work.file.values->numbers(element, attribute::keypoint_at, std::span(&point.position.x, 3));
  if (!name || !there) return;
  point.name = *name;
  work.part.keypoints.push_back(std::move(point));
  add_item(work, ItemKind::keypoint, element,
           static_cast<std::uint32_t>(work.part.keypoints.size() - 1));
}

// ---- shapes

void Loader::read_shape(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  if (document.elements[element].id == ElementId::mli &&
      work.file.values->text_or_default(element, attribute::mli_type) == "wrap")
    return read_blanket(work, element);
  std::optional<std::uint32_t> index;
  FoilShapes foil;
  if (document.elements[element].id == ElementId::mesh) {
    // in a repeat, one without expressions is the same each time
    const xml::Element& e = document.elements[element];
    const bool constant =
        repeats_ > 0 && document.bytes.substr(e.start_tag_end, e.end - e.start_tag_end).find('{') ==
                            std::string_view::npos;
    const std::pair key(static_cast<const File*>(&work.file), element);
    if (const auto known = known_meshes_.find(key); constant && known != known_meshes_.end()) {
      index = known->second;
    } else if (geometry::MeshShape mesh = read_mesh_shape(document, element, options_.crease_angle,
                                                          *work.file.values, reporter_)) {
      index = known_shape(std::move(mesh));
      if (constant) known_meshes_[key] = *index;
    }
  } else if (document.elements[element].id == ElementId::mli) {
    foil = foil_shapes(work, element);
    index = foil[0];
  } else if (auto shape = read_exact_shape(document, element, work.file.units, *work.file.values,
                                           reporter_)) {
    index = known_shape(std::move(*shape));
  }
  const std::uint32_t properties = read_properties(work, element);
  if (index) add_item(work, ItemKind::shape, element, *index, properties);
  add_trim(work, element, foil, properties);
}

// Nodes of their own beside a sheet: its tape and its edge.
void Loader::add_trim(Work& work, std::uint32_t element, const FoilShapes& shapes,
                      std::uint32_t properties) {
  const auto add = [&](mli::Cover cover, std::size_t which, std::string_view ending) {
    const auto shape = shapes[static_cast<std::size_t>(cover)];
    if (!work.file.values->has(element, which)) return;
    const auto material = material_at(work, element, which);
    if (!shape || !material) return;
    NodeProperties own =
        properties == kNoProperties ? NodeProperties{} : work.part.properties[properties];
    own.name = (own.name.empty() ? "mli" : own.name) + std::string(ending);
    own.material = static_cast<std::int32_t>(*material);
    own.back.reset();
    work.part.properties.push_back(std::move(own));
    add_item(work, ItemKind::shape, element, *shape,
             static_cast<std::uint32_t>(work.part.properties.size() - 1));
  };
  if (work.file.document.elements[element].id != ElementId::mli) return;
  add(mli::Cover::tape, attribute::mli_tape, "_tape");
  add(mli::Cover::edge, attribute::mli_edge, "_edge");
}

std::optional<std::uint32_t> Loader::material_at(Work& work, std::uint32_t element,
                                                 std::size_t which) {
  Definition* material = look_up(work.file, element, which, work.file.materials, "material");
  return material != nullptr ? material_of(*material) : std::nullopt;
}

void Loader::read_blanket(Work& work, std::uint32_t element) {
  auto wrap = read_wrap(work.file.document, element, *work.file.values, reporter_);
  const std::uint32_t properties = read_properties(work, element);
  const auto named = [&](std::size_t which) {
    const auto material =
        work.file.values->has(element, which) ? material_at(work, element, which) : std::nullopt;
    return material ? static_cast<std::int32_t>(*material) : -1;
  };
  const std::int32_t tape = named(attribute::mli_tape), edge = named(attribute::mli_edge);
  if (!wrap) return;
  wrap->tape = tape;
  wrap->edge = edge;
  if (tape < 0) wrap->blanket.tape = 0;
  wrap->blanket.edge = edge >= 0;
  wrap->run = work.run;
  work.part.wraps.push_back(*std::move(wrap));
  add_item(work, ItemKind::wrap, element, static_cast<std::uint32_t>(work.part.wraps.size() - 1),
           properties);
}

FoilShapes Loader::foil_shapes(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  auto foil = read_foil(document, element, *work.file.values, reporter_);
  if (!foil) return {};
  foil->levels = options_.foil_levels;
  // the same sheet again is not made again
  const auto [known, added] = known_foils_.try_emplace(foil->key());
  if (!added) return known->second;
  auto made = make_foil(document, element, *foil, options_.crease_angle,
                        kMaxFoilVertices - foil_vertices_, options_.cache, reporter_, job_);
  if (!made) return {};
  foil_vertices_ += made->vertices;
  const auto [line, column] = work.file.positions[element];
  for (std::size_t k = 0; k < mli::kCovers; ++k) {
    FoilMeshes::Part& part = made->parts[k];
    if (!part.finest) continue;
    const std::size_t before = scene_.shapes.size();
    known->second[k] = known_shape(geometry::MeshShape(std::move(part.finest)));
    // note: other numbers may make the same mesh
    if (scene_.shapes.size() > before)
      scene_.foils.push_back({static_cast<std::int32_t>(*known->second[k]),
                              foil->recipe,
                              foil->form,
                              made->statistics,
                              false,
                              {work.file.found.path, line, column},
                              std::move(part.levels)});
  }
  return known->second;
}

std::uint32_t Loader::known_shape(geometry::Shape shape) {
  const auto [known, added] = known_shapes_.emplace(
      geometry::hash_of(shape), static_cast<std::uint32_t>(scene_.shapes.size()));
  if (added) scene_.shapes.push_back(std::move(shape));
  return known->second;
}

}  // namespace panwright::pxn
