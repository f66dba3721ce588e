#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

#include "base/text.h"
#include "importers/urdf/internal/robot.h"

namespace panwright::importers::urdf {

namespace {

using pugi::xml_attribute;
using pugi::xml_node;

constexpr std::string_view kTypes[] = {"fixed",     "revolute", "continuous",
                                       "prismatic", "floating", "planar"};

class RobotReader {
 public:
  RobotReader(const XmlText& text, meshes::ReaderContext& context)
      : text_(text), c_(context), values_(text, context) {}

  Robot read() {
    const xml_node top = text_.top();
    if (std::string_view(top.name()) != "robot") {
      wrong(text_.at(top),
            fmt::format("unexpected element {}, expected <robot>", in_quotes(top.name())));
      return std::move(out_);
    }
    out_.name = top.attribute("name").value();
    for (const xml_node material : top.children("material")) define(material);
    for (const xml_node link : top.children("link")) read_link(link);
    for (const xml_node child : top.children()) {
      const std::string_view name = child.name();
      if (name == "joint")
        read_joint(child);
      else if (name != "link" && name != "material" && !name.empty())
        skip(child);
    }
    return std::move(out_);
  }

 private:
  void wrong(SourceSpan where, const std::string& message) { values_.wrong(where, message); }
  void tolerated(SourceSpan where, const std::string& message) {
    values_.tolerated(where, message);
  }

  void skip(const xml_node& element) {
    const std::string_view name = element.name();
    if (name.starts_with("xacro:") || name == "xacro")
      return c_.trouble(Code("E6220"), "xacro", text_.at(element), [&] {
        return fmt::format("{} is a macro and is left out; expand them first: xacro IN > OUT.urdf",
                           in_quotes(name));
      });
    c_.skipped(std::string(name));
  }

  // ---- values

  // Numbers of an attribute; nothing where it is not there, or where it is wrong: E6220.
  template <std::size_t N>
  std::optional<std::array<double, N>> numbers(const xml_node& element, const char* name) {
    const auto found = values_.numbers(element, element.attribute(name), N, N);
    if (!found) return std::nullopt;
    std::array<double, N> out;
    std::ranges::copy(*found, out.begin());
    return out;
  }

  double number_or(const xml_node& element, const char* name, double otherwise) {
    const auto found = numbers<1>(element, name);
    return found ? (*found)[0] : otherwise;
  }

  // A length above 0.
  std::optional<double> length(const xml_node& element, const char* name) {
    const xml_attribute attribute = element.attribute(name);
    if (!attribute) {
      wrong(text_.at(element),
            fmt::format("<{}> has no {}; the part is left out", element.name(), name));
      return std::nullopt;
    }
    const auto found = numbers<1>(element, name);
    if (!found) return std::nullopt;
    if ((*found)[0] > 0) return (*found)[0];
    wrong(text_.at(attribute), fmt::format("{} of <{}> is {:g}, expected above 0; the part is left "
                                           "out",
                                           name, element.name(), (*found)[0]));
    return std::nullopt;
  }

  Origin origin_of(const xml_node& element) {
    Origin out;
    const xml_node origin = element.child("origin");
    if (const auto xyz = numbers<3>(origin, "xyz")) out.xyz = {(*xyz)[0], (*xyz)[1], (*xyz)[2]};
    if (const auto rpy = numbers<3>(origin, "rpy"))
      out.rotation = quat_from_fixed_xyz({(*rpy)[0], (*rpy)[1], (*rpy)[2]});
    return out;
  }

  std::string name_of(const xml_node& element) {
    const xml_attribute name = element.attribute("name");
    if (!name.empty() && *name.value() != '\0') return name.value();
    wrong(text_.at(element), fmt::format("<{}> has no name", element.name()));
    return {};
  }

  // ---- materials

  std::int32_t define(const xml_node& element) {
    Paint paint;
    paint.name = element.attribute("name").value();
    paint.where = text_.at(element);
    if (const auto rgba = numbers<4>(element.child("color"), "rgba")) paint.rgba = rgba;
    const xml_attribute file = element.child("texture").attribute("filename");
    paint.texture = file.value();
    paint.texture_at = text_.at(file);
    const auto index = static_cast<std::int32_t>(out_.paints.size());
    const bool known = paint.name.empty() || !paint.has_content() ||
                       !paint_named_.try_emplace(paint.name, index).second;
    if (known && !paint.name.empty() && paint.has_content() && element.parent() == text_.top())
      tolerated(paint.where,
                fmt::format("duplicate material {}; the first one is used", in_quotes(paint.name)));
    out_.paints.push_back(std::move(paint));
    return index;
  }

  std::int32_t paint_of(const xml_node& visual) {
    const xml_node element = visual.child("material");
    if (!element) return kNone;
    if (element.child("color") || element.child("texture")) return define(element);
    const std::string name = element.attribute("name").value();
    const auto known = paint_named_.find(name);
    if (known != paint_named_.end()) return known->second;
    later_.push_back({name, text_.at(element), out_.links.size(), 0});
    return kNone;
  }

  // ---- links

  std::optional<std::variant<geometry::Shape, MeshFile>> geometry_of(const xml_node& visual) {
    const xml_node geometry = visual.child("geometry");
    const xml_node shape = geometry.first_child();
    if (!shape) {
      wrong(text_.at(geometry ? geometry : visual),
            "a visual has no geometry, expected <box>, <cylinder>, <sphere> or <mesh>; it is left "
            "out");
      return std::nullopt;
    }
    const std::string_view kind = shape.name();
    if (kind == "box") return box_of(shape);
    if (kind == "cylinder") {
      const auto radius = length(shape, "radius");
      const auto height = length(shape, "length");
      if (!radius || !height) return std::nullopt;
      return geometry::Shape(geometry::Cylinder{.radius = *radius, .height = *height});
    }
    if (kind == "sphere") {
      const auto radius = length(shape, "radius");
      if (!radius) return std::nullopt;
      return geometry::Shape(geometry::Sphere{.radius = *radius, .counts = {}});
    }
    if (kind == "mesh") return mesh_of(shape);
    wrong(text_.at(shape), fmt::format("<{}> is not a geometry, expected <box>, <cylinder>, "
                                       "<sphere> or <mesh>; the visual is left out",
                                       kind));
    return std::nullopt;
  }

  std::optional<std::variant<geometry::Shape, MeshFile>> box_of(const xml_node& shape) {
    const auto size = numbers<3>(shape, "size");
    if (!shape.attribute("size")) wrong(text_.at(shape), "<box> has no size; it is left out");
    if (!size) return std::nullopt;
    const Vec3 sides((*size)[0], (*size)[1], (*size)[2]);
    if (sides.x > 0 && sides.y > 0 && sides.z > 0)
      return geometry::Shape(geometry::Box{.size = sides});
    wrong(text_.at(shape.attribute("size")),
          fmt::format("size of <box> is {}, expected numbers above 0; it is left out",
                      in_quotes(shape.attribute("size").value())));
    return std::nullopt;
  }

  std::optional<std::variant<geometry::Shape, MeshFile>> mesh_of(const xml_node& shape) {
    MeshFile mesh;
    const xml_attribute file = shape.attribute("filename");
    mesh.name = file.value();
    mesh.where = text_.at(file);
    if (mesh.name.empty()) {
      wrong(text_.at(shape), "<mesh> has no filename; it is left out");
      return std::nullopt;
    }
    if (const auto scale = numbers<3>(shape, "scale")) {
      mesh.scale = {(*scale)[0], (*scale)[1], (*scale)[2]};
      if (mesh.scale.x == 0 || mesh.scale.y == 0 || mesh.scale.z == 0) {
        wrong(text_.at(shape.attribute("scale")), "a scale of 0 flattens the mesh");
        return std::nullopt;
      }
    }
    return mesh;
  }

  void read_inertial(const xml_node& element, Link& link) {
    if (!element) return;
    link.inertial = origin_of(element);
    if (const auto mass = numbers<1>(element.child("mass"), "value")) {
      if ((*mass)[0] >= 0)
        link.mass = (*mass)[0];
      else
        wrong(text_.at(element.child("mass")),
              fmt::format("a mass of {:g} kg, expected 0 or above; it is left out", (*mass)[0]));
    }
    const xml_node inertia = element.child("inertia");
    if (!inertia) return;
    const auto at = [&](const char* name) { return number_or(inertia, name, 0); };
    const double xy = at("ixy"), xz = at("ixz"), yz = at("iyz");
    link.inertia = Mat3(at("ixx"), xy, xz, xy, at("iyy"), yz, xz, yz, at("izz"));
  }

  void read_link(const xml_node& element) {
    Link link;
    link.name = name_of(element);
    link.where = text_.at(element);
    if (link.name.empty()) return;
    if (!link_named_.try_emplace(link.name, static_cast<std::int32_t>(out_.links.size())).second)
      return wrong(link.where, fmt::format("duplicate link {}; the second one is left out",
                                           in_quotes(link.name)));
    read_inertial(element.child("inertial"), link);
    for (const xml_node child : element.children()) {
      const std::string_view name = child.name();
      if (name == "visual") {
        const std::size_t waiting = later_.size();
        Visual visual;
        visual.name = child.attribute("name").value();
        visual.where = text_.at(child);
        visual.origin = origin_of(child);
        visual.paint = paint_of(child);
        auto geometry = geometry_of(child);
        if (!geometry) {
          later_.resize(waiting);
          continue;
        }
        if (later_.size() > waiting) later_.back().visual = link.visuals.size();
        visual.geometry = std::move(*geometry);
        link.visuals.push_back(std::move(visual));
      } else if (name != "inertial" && !name.empty()) {
        skip(child);
      }
    }
    out_.links.push_back(std::move(link));
  }

  // ---- joints

  std::int32_t link_of(const xml_node& joint, const char* end) {
    const xml_attribute link = joint.child(end).attribute("link");
    const auto known = link_named_.find(link.value());
    if (known != link_named_.end()) return known->second;
    if (!link) {
      wrong(text_.at(joint), fmt::format("the joint {} has no <{} link=>; it is left out",
                                         in_quotes(joint.attribute("name").value()), end));
      return kNone;
    }
    std::vector<std::string_view> names;
    for (const Link& each : out_.links) names.push_back(each.name);
    c_.log.report(
        Code("E6220"), text_.at(link),
        fmt::format("there is no link {}; the joint is left out", in_quotes(link.value())),
        near_hint(link.value(), names));
    return kNone;
  }

  JointType type_of(const xml_node& element) {
    const std::string_view type = element.attribute("type").value();
    for (std::size_t k = 0; k < std::size(kTypes); ++k)
      if (type == kTypes[k]) return static_cast<JointType>(k);
    wrong(element.attribute("type") ? text_.at(element.attribute("type")) : text_.at(element),
          fmt::format("the type of the joint {} is {}, expected revolute, continuous, prismatic, "
                      "fixed, floating or planar; it does not move",
                      in_quotes(element.attribute("name").value()), in_quotes(type)));
    return JointType::fixed;
  }

  Vec3 axis_of(const xml_node& element) {
    const Vec3 usual(1, 0, 0);
    const auto xyz = numbers<3>(element.child("axis"), "xyz");
    if (!xyz) return usual;
    if (const auto axis = unit_vector({(*xyz)[0], (*xyz)[1], (*xyz)[2]})) return *axis;
    wrong(text_.at(element.child("axis").attribute("xyz")),
          "the axis has no length, expected a direction; 1 0 0 is taken");
    return usual;
  }

  void read_limits(const xml_node& element, RobotJoint& joint) {
    const xml_node limit = element.child("limit");
    const bool wanted = joint.type == JointType::revolute || joint.type == JointType::prismatic;
    if (!limit) {
      if (wanted)
        tolerated(joint.where,
                  fmt::format("the joint {} has no <limit>, which a {} joint needs; "
                              "it moves without one",
                              in_quotes(joint.name), kTypes[static_cast<std::size_t>(joint.type)]));
      return;
    }
    const double lower = number_or(limit, "lower", 0), upper = number_or(limit, "upper", 0);
    if (!wanted) {
      if (lower != upper)
        tolerated(text_.at(limit), fmt::format("a {} joint has no limits; these are left out",
                                               kTypes[static_cast<std::size_t>(joint.type)]));
      return;
    }
    if (lower > upper)
      return wrong(text_.at(limit), fmt::format("the lower limit {:g} is above the upper one {:g}; "
                                                "the joint moves without limits",
                                                lower, upper));
    if (lower == upper)
      tolerated(text_.at(limit), fmt::format("both limits of the joint {} are {:g} (0 where they "
                                             "are not given); it cannot move",
                                             in_quotes(joint.name), lower));
    joint.limits = Vec2(lower, upper);
  }

  void read_joint(const xml_node& element) {
    RobotJoint joint;
    joint.name = name_of(element);
    joint.where = text_.at(element);
    joint.parent = link_of(element, "parent");
    joint.child = link_of(element, "child");
    if (joint.parent == kNone || joint.child == kNone) return;
    if (!joint.name.empty() && !joint_named_.try_emplace(joint.name, 0).second)
      wrong(joint.where, fmt::format("two joints are called {}", in_quotes(joint.name)));
    joint.type = type_of(element);
    joint.origin = origin_of(element);
    if (joint.type != JointType::fixed && joint.type != JointType::floating)
      joint.axis = axis_of(element);
    read_limits(element, joint);
    if (const xml_node mimic = element.child("mimic")) {
      joint.mimic = Mimic{mimic.attribute("joint").value(), number_or(mimic, "multiplier", 1),
                          number_or(mimic, "offset", 0), text_.at(mimic)};
    }
    out_.joints.push_back(std::move(joint));
  }

 public:
  // Materials that are named before they stand.
  void resolve(Robot& robot) {
    for (const Later& each : later_) {
      const auto known = paint_named_.find(each.name);
      if (known == paint_named_.end()) {
        wrong(each.where,
              fmt::format("there is no material {}; the part is grey", in_quotes(each.name)));
        continue;
      }
      if (each.link < robot.links.size() && each.visual < robot.links[each.link].visuals.size())
        robot.links[each.link].visuals[each.visual].paint = known->second;
    }
  }

 private:
  struct Later {
    std::string name;
    SourceSpan where;
    std::size_t link, visual;
  };

  const XmlText& text_;
  meshes::ReaderContext& c_;
  XmlValues values_;
  Robot out_;
  std::unordered_map<std::string, std::int32_t> link_named_, joint_named_, paint_named_;
  std::vector<Later> later_;
};

}  // namespace

Robot read_robot(const XmlText& text, meshes::ReaderContext& context) {
  RobotReader reader(text, context);
  Robot robot = reader.read();
  reader.resolve(robot);
  return robot;
}

}  // namespace panwright::importers::urdf
