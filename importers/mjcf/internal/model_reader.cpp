#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <unordered_map>

#include "base/text.h"
#include "importers/mjcf/internal/attributes.h"
#include "importers/mjcf/internal/mesh_vertices.h"

namespace panwright::importers::mjcf {

namespace {

using pugi::xml_attribute;
using pugi::xml_node;

constexpr double kMostShown = 2;  // the last group of geoms that MuJoCo shows by itself
enum GeomType : std::size_t {
  kPlane,
  kHeightField,
  kSphere,
  kCapsule,
  kEllipsoid,
  kCylinder,
  kBox,
  kMesh,
  kDistance
};

class ModelReader {
 public:
  ModelReader(const XmlText& text, meshes::ReaderContext& context)
      : text_(text), c_(context), a_(text, context) {}

  Model read() {
    const xml_node top = text_.top();
    out_.bodies.emplace_back();
    if (std::string_view(top.name()) != "mujoco") {
      a_.wrong(text_.at(top),
               fmt::format("unexpected element {}, expected <mujoco>", in_quotes(top.name())));
      return std::move(out_);
    }
    out_.name = top.attribute("model").value();
    for (const xml_node each : top.children("compiler")) a_.read_compiler(each);
    for (const xml_node each : top.children("default")) a_.classes().read(each);
    for (const xml_node each : top.children("asset")) read_assets(each);
    for (const xml_node child : top.children()) {
      const std::string_view name = child.name();
      if (name == "worldbody")
        read_inside(child, 0, {}, 0, 1);
      else if (name == "equality")
        read_couplings(child);
      else if (name != "compiler" && name != "default" && name != "asset" && !name.empty())
        skip(child);
    }
    return std::move(out_);
  }

 private:
  // Macros hold parts of the model; other elements have no surface.
  void skip(const xml_node& element) {
    const std::string_view name = element.name();
    for (const std::string_view macro : {"attach", "composite", "flexcomp", "model"})
      if (name == macro)
        return c_.trouble(Code("E6220"), macro, text_.at(element), [&] {
          return fmt::format(
              "<{}> is not supported and is left out; expand the model with MuJoCo first: "
              "mj_saveLastXML()",
              name);
        });
    c_.skipped(std::string(name));
  }

  template <typename Named>
  static std::string near_of(const std::string& name, const Named& known) {
    std::vector<std::string_view> names;
    for (const auto& [each, index] : known) names.push_back(each);
    std::ranges::sort(names);
    return near_hint(name, names);
  }

  // ---- assets

  // The name of a file, without folders on request, and the files that it is relative to: beside
  // the model, then beside the text that names it, each with the folder of <compiler>.
  FileName file_name(const xml_node& element, const std::string& folder,
                     const std::string& written) const {
    FileName out{.text = std::string_view(written), .including = {}};
    if (a_.compiler().strip_path) out.text.remove_prefix(written.find_last_of("/\\") + 1);
    const std::string below = path_in(folder, false);
    const auto add = [&](const std::string& including, const std::string& inside) {
      const std::filesystem::path at = std::filesystem::path(including).parent_path() / inside;
      const std::string base = (at / "model").lexically_normal().generic_string();
      if (std::ranges::find(out.including, base) == out.including.end())
        out.including.push_back(base);
    };
    const std::string& own = text_.path_of(element);
    add(c_.file.path, below);
    add(own, below);
    add(own, {});
    return out;
  }

  static std::string stem_of(const std::string& file) {
    return std::filesystem::path(path_in(file, false)).stem().generic_string();
  }

  void read_assets(const xml_node& section) {
    for (const xml_node each : section.children("texture")) read_texture(each);
    for (const xml_node each : section.children("material")) read_material(each);
    for (const xml_node child : section.children()) {
      const std::string_view name = child.name();
      if (name == "mesh")
        read_mesh(child);
      else if (name != "texture" && name != "material" && !name.empty())
        skip(child);
    }
  }

  void read_mesh(const xml_node& element) {
    const std::size_t its_class = a_.classes().of(element, 0);
    const std::string file = element.attribute("file").value();
    MeshAsset mesh;
    if (!file.empty()) {
      FileName name = file_name(element, a_.compiler().mesh_folder, file);
      mesh.file.name = name.text;
      mesh.file.including = std::move(name.including);
      mesh.file.where = text_.at(element.attribute("file"));
    } else {
      mesh.mesh = mesh_of_vertices(element, its_class, a_, c_);
      if (!mesh.mesh) return;
    }
    if (const auto scale = a_.vector(element, "scale", its_class)) {
      if (scale->x != 0 && scale->y != 0 && scale->z != 0)
        mesh.file.scale = *scale;
      else
        a_.wrong(a_.at(element, "scale", its_class),
                 "a scale of 0 flattens the mesh; it is not scaled");
    }
    if (const auto at = a_.vector(element, "refpos", its_class)) mesh.reference.position = *at;
    if (const auto q = a_.numbers(element, "refquat", its_class, 4, 4)) {
      const Quat turned((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
      if (glm::length(turned) > 1e-10) mesh.reference.rotation = glm::normalize(turned);
    }
    add_asset(element, file, meshes_, out_.meshes.size());
    out_.meshes.push_back(std::move(mesh));
  }

  void read_texture(const xml_node& element) {
    const std::string file = element.attribute("file").value();
    const bool flat = std::string_view(element.attribute("type").value()) == "2d";
    if (!file.empty() && flat) {
      add_asset(element, file, textures_, texture_files_.size());
      FileName name = file_name(element, a_.compiler().texture_folder, file);
      texture_files_.push_back(
          {std::string(name.text), std::move(name.including), text_.at(element.attribute("file"))});
      return;
    }
    c_.lost(file.empty() ? "procedural textures" : "cube textures", text_.at(element));
    add_asset(element, file, textures_, texture_files_.size());
    texture_files_.emplace_back();
  }

  void read_material(const xml_node& element) {
    const std::size_t its_class = a_.classes().of(element, 0);
    Paint paint;
    paint.name = element.attribute("name").value();
    paint.where = text_.at(element);
    if (const auto rgba = a_.numbers(element, "rgba", its_class, 4, 4))
      paint.rgba = {(*rgba)[0], (*rgba)[1], (*rgba)[2], (*rgba)[3]};
    if (const xml_attribute texture = a_.classes().find(element, "texture", its_class)) {
      const auto known = textures_.find(texture.value());
      if (known == textures_.end()) {
        c_.log.report(Code("E6220"), text_.at(texture),
                      fmt::format("there is no texture {}; the material has none",
                                  in_quotes(texture.value())),
                      near_of(texture.value(), textures_));
      } else {
        const TextureFile& file = texture_files_[known->second];
        paint.texture = file.name;
        paint.including = file.including;
        paint.texture_at = file.where;
      }
    }
    // note: a material without a colour is white in MuJoCo
    if (!paint.rgba) paint.rgba = {1, 1, 1, 1};
    add_asset(element, {}, materials_, out_.paints.size());
    out_.paints.push_back(std::move(paint));
  }

  using Named = std::unordered_map<std::string, std::size_t>;
  void add_asset(const xml_node& element, const std::string& file, Named& known,
                 std::size_t index) {
    std::string name = element.attribute("name").value();
    if (name.empty()) name = stem_of(file);
    if (!known.try_emplace(name, index).second)
      a_.wrong(text_.at(element), fmt::format("duplicate {} {}; the first one is used",
                                              element.name(), in_quotes(name)));
  }

  // ---- the tree

  // What stands in a body, or in a frame of it. frame: from the frame to the body.
  void read_inside(const xml_node& element, std::size_t body, const Pose& frame, std::size_t around,
                   std::uint32_t depth) {
    if (depth > c_.options.limits.depth)
      return c_.limit(fmt::format("bodies are nested more than {} deep", c_.options.limits.depth),
                      text_.at(element));
    for (const xml_node child : element.children()) {
      if (c_.full) return;
      const std::string_view name = child.name();
      if (name.empty()) continue;
      if (name == "body") {
        read_body(child, body, frame, around, depth);
      } else if (name == "frame") {
        const std::size_t inner = a_.classes().of(child, around, "childclass");
        read_inside(child, body, frame * a_.pose(child, 0), inner, depth + 1);
      } else if (name == "replicate") {
        read_replicas(child, body, frame, around, depth);
      } else if (name == "joint" || name == "freejoint") {
        read_joint(child, body, frame, around);
      } else if (name == "geom") {
        read_geom(child, body, frame, around);
      } else if (name == "site" || name == "camera") {
        read_mark(child, body, frame, around);
      } else {
        skip(child);
      }
    }
  }

  // What stands in it several times: copy n is placed by the n-th power of its step. Names get
  // `sep` and n, with as many digits as the last one has.
  void read_replicas(const xml_node& element, std::size_t body, const Pose& frame,
                     std::size_t around, std::uint32_t depth) {
    const std::size_t inner = a_.classes().of(element, around, "childclass");
    const double count = a_.number_or(element, "count", 0, 0);
    if (!(count >= 1 && count == std::floor(count)))
      return a_.wrong(a_.at(element, "count", 0),
                      "<replicate> needs a count of 1 or more; its contents are left out");
    Pose step = a_.pose(element, 0);
    step.position = a_.vector(element, "offset", 0).value_or(Vec3(0));
    const std::string before = suffix_;
    const std::string separator = element.attribute("sep").value();
    const std::size_t digits = fmt::format("{:.0f}", count - 1).size();
    Pose at = frame;
    for (std::uint64_t i = 0; static_cast<double>(i) < count && !c_.full; ++i) {
      if (++replicas_ > c_.options.limits.nodes)
        return c_.limit(fmt::format("more than {} copies", c_.options.limits.nodes),
                        text_.at(element));
      suffix_ = fmt::format("{}{:0{}}{}", separator, i, digits, before);
      read_inside(element, body, at, inner, depth + 1);
      at = at * step;
      at.rotation = glm::normalize(at.rotation);
    }
    suffix_ = before;
  }

  std::string name_of(const xml_node& element) const {
    const std::string name = element.attribute("name").value();
    return name.empty() ? name : name + suffix_;
  }

  void read_body(const xml_node& element, std::size_t parent, const Pose& frame, std::size_t around,
                 std::uint32_t depth) {
    const std::size_t inner = a_.classes().of(element, around, "childclass");
    Body body;
    body.name = name_of(element);
    body.where = text_.at(element);
    body.parent = static_cast<std::int32_t>(parent);
    body.pose = frame * a_.pose(element, 0);
    if (!body.name.empty() && !body_names_.try_emplace(body.name, out_.bodies.size()).second)
      a_.wrong(body.where, fmt::format("two bodies are called {}", in_quotes(body.name)));
    const std::size_t index = out_.bodies.size();
    if (index >= c_.options.limits.nodes)
      return c_.limit(fmt::format("more than {} nodes", c_.options.limits.nodes), body.where);
    out_.bodies.push_back(std::move(body));
    read_inside(element, index, {}, inner, depth + 1);
  }

  void read_mark(const xml_node& element, std::size_t body, const Pose& frame, std::size_t around) {
    const bool camera = std::string_view(element.name()) == "camera";
    Mark mark;
    mark.name = name_of(element);
    mark.where = text_.at(element);
    if (mark.name.empty())
      return c_.skipped(camera ? "camera without a name" : "site without a name");
    mark.pose = frame * a_.pose(element, a_.classes().of(element, around));
    // it looks along −z, with y up
    if (camera) mark.pose.rotation = mark.pose.rotation * Quat(0, 1, 0, 0);
    if (!mark_names_.try_emplace(mark.name, 0).second)
      return a_.tolerated(mark.where, fmt::format("duplicate frame {}; the first one is kept",
                                                  in_quotes(mark.name)));
    out_.bodies[body].marks.push_back(std::move(mark));
  }

  // ---- joints

  void read_joint(const xml_node& element, std::size_t body, const Pose& frame,
                  std::size_t around) {
    if (body == 0)
      return a_.wrong(text_.at(element),
                      "a joint in the world, which does not move; expected in a body");
    ModelJoint joint;
    joint.name = name_of(element);
    joint.where = text_.at(element);
    std::vector<ModelJoint>& joints = out_.bodies[body].joints;
    const bool is_free = std::string_view(element.name()) == "freejoint";
    const std::size_t its_class = is_free ? around : a_.classes().of(element, around);
    if (is_free)
      joint.type = JointType::free;
    else
      joint.type = static_cast<JointType>(
          a_.word(element, "type", its_class, {"hinge", "slide", "ball", "free"}, 0));
    if (!joint.name.empty() && !joint_names_.try_emplace(joint.name, 0).second)
      a_.wrong(joint.where, fmt::format("two joints are called {}", in_quotes(joint.name)));
    if (joint.type == JointType::free) {
      if (out_.bodies[body].parent != 0 || !joints.empty())
        return a_.wrong(
            joint.where,
            "a free joint, expected as the only joint of a body of the world; it is left out");
      joints.push_back(std::move(joint));
      return;
    }
    if (!joints.empty() && joints[0].type == JointType::free)
      return a_.wrong(joint.where, "a joint beside a free one has no effect; it is left out");
    if (const auto anchor = a_.vector(element, "pos", its_class)) joint.anchor = *anchor;
    joint.anchor = frame(joint.anchor);
    if (const auto axis = a_.vector(element, "axis", its_class))
      joint.axis =
          a_.direction(*axis, a_.at(element, "axis", its_class), "the axis").value_or(joint.axis);
    joint.axis = frame.rotation * joint.axis;
    read_range(element, its_class, joint);
    joints.push_back(std::move(joint));
  }

  void read_range(const xml_node& element, std::size_t its_class, ModelJoint& joint) {
    const bool turns = joint.type == JointType::hinge;
    const double unit = turns ? a_.compiler().angle : 1;
    if (joint.type != JointType::ball)
      joint.reference = unit * a_.number_or(element, "ref", its_class, 0);
    const auto range = a_.numbers(element, "range", its_class, 2, 2);
    const std::size_t limited =
        a_.word(element, "limited", its_class, {"false", "true", "auto"}, 2);
    const SourceSpan where = a_.at(element, "range", its_class);
    if (limited == 0 || (!range && limited == 2)) return;
    if (!range) {
      if (!a_.classes().find(element, "range", its_class))
        a_.wrong(joint.where, fmt::format("the joint {} is limited and has no range; it moves "
                                          "without limits",
                                          in_quotes(joint.name)));
      return;
    }
    if (limited == 2 && !a_.compiler().limits_by_range) {
      a_.tolerated(where,
                   "a range without limited=\"true\" has no meaning with "
                   "autolimits=\"false\"; the joint moves without limits");
      return;
    }
    if (joint.type == JointType::ball) {
      if ((*range)[1] != 0)
        c_.trouble(Code("W6221"), "ball", where, [] {
          return std::string("the largest angle of a ball joint is left out: it moves freely");
        });
      return;
    }
    if (!((*range)[0] < (*range)[1])) {
      if ((*range)[0] == 0 && (*range)[1] == 0 && limited == 2) return;  // MuJoCo's "none"
      return a_.wrong(where,
                      fmt::format("the lower limit {:g} is not below the upper one {:g}; the "
                                  "joint moves without limits",
                                  (*range)[0], (*range)[1]));
    }
    joint.range = unit * Vec2((*range)[0], (*range)[1]);
  }

  void read_couplings(const xml_node& section) {
    for (const xml_node child : section.children()) {
      if (std::string_view(child.name()) != "joint") {
        if (*child.name() != '\0') skip(child);
        continue;
      }
      const std::size_t its_class = a_.classes().of(child, 0);
      if (a_.word(child, "active", its_class, {"false", "true"}, 1) == 0) {
        c_.skipped("coupling that is not active");
        continue;
      }
      Coupling coupling;
      coupling.where = text_.at(child);
      coupling.follower = child.attribute("joint1").value();
      coupling.leader = child.attribute("joint2").value();
      if (const auto factors = a_.numbers(child, "polycoef", its_class, 1, 5))
        std::ranges::copy(*factors, coupling.factors.begin());
      out_.couplings.push_back(std::move(coupling));
    }
  }

  // ---- geoms

  void read_geom(const xml_node& element, std::size_t body, const Pose& frame, std::size_t around) {
    const std::size_t its_class = a_.classes().of(element, around);
    if (a_.number_or(element, "group", its_class, 0) > kMostShown)
      return c_.skipped("geom of a group that is not shown");
    const xml_attribute mesh = a_.classes().find(element, "mesh", its_class);
    const std::size_t type = a_.word(
        element, "type", its_class,
        {"plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"},
        mesh ? kMesh : kSphere);
    Geom geom;
    geom.name = name_of(element);
    geom.where = text_.at(element);
    geom.pose = a_.pose(element, its_class);
    if (type == kHeightField || type == kDistance)
      return c_.skipped(type == kHeightField ? "height field" : "signed distance field");
    if (type == kMesh || mesh) {
      if (type != kMesh && mesh)
        c_.trouble(Code("W6221"), "fitted", geom.where, [] {
          return std::string("a shape that is to be fitted to a mesh is shown as the mesh itself");
        });
      if (!find_mesh(element, its_class, geom)) return;
    } else if (!shapes_of(element, its_class, type, geom)) {
      return;
    }
    geom.pose = frame * geom.pose;
    geom.paint = paint_of(element, its_class);
    out_.bodies[body].geoms.push_back(std::move(geom));
  }

  bool find_mesh(const xml_node& element, std::size_t its_class, Geom& geom) {
    const std::string name = a_.text(element, "mesh", its_class);
    const auto known = meshes_.find(name);
    if (known != meshes_.end()) {
      geom.mesh = static_cast<std::int32_t>(known->second);
      return true;
    }
    c_.log.report(Code("E6220"), a_.at(element, "mesh", its_class),
                  name.empty()
                      ? std::string("a geom has no mesh; it is left out")
                      : fmt::format("there is no mesh {}; the geom is left out", in_quotes(name)),
                  near_of(name, meshes_));
    return false;
  }

  // The sizes of a geom that has `count` of them at least, above 0; its ends where it has some.
  std::optional<std::vector<double>> sizes_of(const xml_node& element, std::size_t its_class,
                                              std::size_t count, bool may_end, Geom& geom) {
    auto size = a_.numbers(element, "size", its_class, 1, 3);
    const auto ends = may_end ? a_.numbers(element, "fromto", its_class, 6, 6) : std::nullopt;
    const SourceSpan where = a_.at(element, ends ? "fromto" : "size", its_class);
    if (!size) {
      if (!a_.classes().find(element, "size", its_class))
        a_.wrong(where, "a geom has no size; it is left out");
      return std::nullopt;
    }
    if (ends) {
      const Vec3 from((*ends)[0], (*ends)[1], (*ends)[2]), to((*ends)[3], (*ends)[4], (*ends)[5]);
      const double length = glm::length(from - to);
      if (!(length > 1e-12)) {
        a_.wrong(where, "both points of fromto are the same, expected two; the geom is left out");
        return std::nullopt;
      }
      geom.pose.position = (from + to) / 2.0;
      geom.pose.rotation = z_towards((from - to) / length);
      if (count == 2)
        size = {(*size)[0], length / 2};
      else
        size = {(*size)[0], (*size)[0], length / 2};
    }
    if (size->size() >= count &&
        std::all_of(size->begin(), size->begin() + std::ssize(*size),
                    [](double s) { return s >= 0; }) &&
        std::all_of(size->begin(), size->begin() + static_cast<std::ptrdiff_t>(count),
                    [](double s) { return s > 0; }))
      return size;
    a_.wrong(where,
             fmt::format("the size of a geom is {}, expected {} above 0; it is left out",
                         in_quotes(a_.text(element, "size", its_class)), counted(count, "number")));
    return std::nullopt;
  }

  bool shapes_of(const xml_node& element, std::size_t its_class, std::size_t type, Geom& geom) {
    if (type == kPlane) {
      const auto size = a_.numbers(element, "size", its_class, 2, 3);
      if (!size || !((*size)[0] > 0 && (*size)[1] > 0)) {
        c_.skipped("infinite plane");
        return false;
      }
      geom.shapes = {geometry::Plane{.width = 2 * (*size)[0], .height = 2 * (*size)[1]}};
      geom.heights = {0};
      return true;
    }
    const bool round = type == kCapsule || type == kCylinder;
    const std::size_t count = type == kSphere ? 1 : round ? 2 : 3;
    const auto size = sizes_of(element, its_class, count, type != kSphere, geom);
    if (!size) return false;
    const std::vector<double>& s = *size;
    geom.heights = {0};
    if (type == kSphere)
      geom.shapes = {geometry::Sphere{.radius = s[0], .counts = {}}};
    else if (type == kEllipsoid)
      geom.shapes = {geometry::Ellipsoid{.radii = {s[0], s[1], s[2]}}};
    else if (type == kBox)
      geom.shapes = {geometry::Box{.size = 2.0 * Vec3(s[0], s[1], s[2])}};
    else if (type == kCylinder)
      geom.shapes = {geometry::Cylinder{.radius = s[0], .height = 2 * s[1]}};
    else
      add_capsule(s[0], s[1], geom);
    return true;
  }

  // A tube between two half spheres.
  static void add_capsule(double radius, double half, Geom& geom) {
    geometry::Sphere top{.radius = radius, .counts = {}}, bottom = top;
    top.latitude_min = 0;
    bottom.latitude_max = 0;
    geom.shapes = {
        geometry::Cylinder{.radius = radius, .height = 2 * half, .caps = geometry::Caps::none}, top,
        bottom};
    geom.heights = {0, half, -half};
  }

  std::int32_t paint_of(const xml_node& element, std::size_t its_class) {
    std::int32_t paint = kNone;
    if (const xml_attribute material = a_.classes().find(element, "material", its_class)) {
      const auto known = materials_.find(material.value());
      if (known != materials_.end())
        paint = static_cast<std::int32_t>(known->second);
      else
        c_.log.report(
            Code("E6220"), text_.at(material),
            fmt::format("there is no material {}; the part is grey", in_quotes(material.value())),
            near_of(material.value(), materials_));
    }
    const auto rgba = a_.numbers(element, "rgba", its_class, 4, 4);
    if (!rgba) return paint;
    const std::array<double, 4> color{(*rgba)[0], (*rgba)[1], (*rgba)[2], (*rgba)[3]};
    const auto [known, is_new] = colored_.try_emplace(
        std::pair(paint, color), static_cast<std::int32_t>(out_.paints.size()));
    if (!is_new) return known->second;
    Paint own;
    if (paint != kNone) {
      own = out_.paints[static_cast<std::size_t>(paint)];
      own.name.clear();
    }
    own.rgba = color;
    own.where = text_.at(element);
    out_.paints.push_back(std::move(own));
    return known->second;
  }

  const XmlText& text_;
  meshes::ReaderContext& c_;
  Attributes a_;
  Model out_;
  Named meshes_, textures_, materials_, body_names_, joint_names_, mark_names_;
  std::string suffix_;          // of names, by the <replicate>s around
  std::uint64_t replicas_ = 0;  // so far
  struct TextureFile {
    std::string name;  // empty: none that is read
    std::vector<std::string> including;
    SourceSpan where;
  };
  std::vector<TextureFile> texture_files_;
  std::map<std::pair<std::int32_t, std::array<double, 4>>, std::int32_t> colored_;
};

}  // namespace

Model read_model(const XmlText& text, meshes::ReaderContext& context) {
  return ModelReader(text, context).read();
}

}  // namespace panwright::importers::mjcf
