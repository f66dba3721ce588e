#include "importers/mjcf/mjcf.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/text.h"
#include "importers/mjcf/internal/model.h"

namespace panwright::importers::mjcf {

namespace {

using geometry::JointKind;

// From what is to be placed next to the node that is there: x → position + rotation·(x − minus).
struct Pending {
  Vec3 position{0};
  Quat rotation{1, 0, 0, 0};
  Vec3 minus{0};
  scene::Transform at(const Vec3& p) const {
    return {position + rotation * (p - minus), rotation, Vec3(1)};
  }
};

class SceneMaker {
 public:
  SceneMaker(const Model& model, meshes::ReaderContext& context)
      : model_(model), c_(context), out_(model.paints, context, Format::mjcf) {}

  Imported made() {
    node_of_.assign(model_.bodies.size(), kNone);
    depth_.assign(model_.bodies.size(), 0);
    node_of_[0] = 0;
    for (std::size_t i = 0; i < model_.bodies.size() && !c_.full; ++i) {
      if (i > 0 && !add_body(i)) break;
      if (!fill(i)) break;
    }
    if (!c_.full) couple();
    return out_.finished();
  }

 private:
  scene::Node& node(std::int32_t index) { return out_.node(index); }

  // ---- bodies and joints

  // The nodes of a body: one for each anchor of its joints, and its own.
  bool add_body(std::size_t index) {
    const Body& body = model_.bodies[index];
    std::int32_t parent = node_of_[static_cast<std::size_t>(body.parent)];
    std::uint32_t depth = depth_[static_cast<std::size_t>(body.parent)];
    Pending next{body.pose.position, body.pose.rotation, Vec3(0)};
    std::int32_t open = kNone;  // a node whose joints are complete but for what comes next
    std::string open_name;
    const auto add = [&](const Vec3& at) {
      const scene::Transform here = next.at(at);
      if (open != kNone && here == scene::Transform{}) return true;
      if (open != kNone) node(open).name = open_name;
      if (++depth > c_.options.limits.depth) {
        c_.limit(fmt::format("bodies are nested more than {} deep", c_.options.limits.depth),
                 body.where);
        return false;
      }
      open = out_.assembly.add_node(parent, body.name, "body", body.where);
      if (open == kNone) return false;
      node(open).parent_from_node = here;
      parent = open;
      return true;
    };
    std::size_t number = 0;
    for (const ModelJoint& joint : body.joints) {
      ++number;
      std::string name = scene_name(joint.name);
      if (name.empty())
        name = fmt::format("{}_joint", body.name.empty() ? "body" : scene_name(body.name));
      if (joint.name.empty() && body.joints.size() > 1) name += std::to_string(number);
      // where something slides does not matter
      const bool anywhere = joint.type == JointType::slide || joint.type == JointType::free;
      const Vec3 anchor = anywhere ? next.minus : joint.anchor;
      if (!add(anchor)) return false;
      open_name = name;
      add_joint(joint, name, open);
      next = {Vec3(0), Quat(1, 0, 0, 0), anchor};
      if (joint.reference == 0) continue;
      // the pose of the file is that of the reference
      if (joint.type == JointType::slide) {
        next.position = -joint.reference * joint.axis;
      } else {
        const auto [sine, cosine] = det::sincos(-joint.reference / 2);
        next.rotation = {cosine, sine * joint.axis.x, sine * joint.axis.y, sine * joint.axis.z};
      }
    }
    if (!add(Vec3(0))) return false;
    node_of_[index] = open;
    depth_[index] = depth;
    return true;
  }

  void add_joint(const ModelJoint& from, const std::string& name, std::int32_t at) {
    scene::Joint joint;
    joint.name = name;
    joint.node = at;
    joint.axis = from.axis;
    joint.source = out_.assembly.source_of(from.where);
    switch (from.type) {
      case JointType::hinge:
        joint.kind = from.range ? JointKind::revolute : JointKind::continuous;
        break;
      case JointType::slide:
        joint.kind = JointKind::prismatic;
        break;
      case JointType::ball:
        joint.kind = JointKind::ball;
        break;
      case JointType::free:
        joint.kind = JointKind::general;
        break;
    }
    double begins = from.reference;
    if (from.range) {
      joint.lower = {from.range->x};
      joint.upper = {from.range->y};
      begins = std::clamp(from.reference, from.range->x, from.range->y);
      if (begins != from.reference)
        outside_.push_back({out_.scene().joints.size(), from.where, begins});
    }
    if (begins != 0) joint.value = {begins};
    const auto index = static_cast<std::int32_t>(out_.scene().joints.size());
    if (geometry::value_count(joint.kind) == 1 && !from.name.empty())
      scalars_.try_emplace(from.name, Scalar{index, from.reference});
    out_.scene().joints.push_back(std::move(joint));
  }

  struct Scalar {
    std::int32_t joint;
    double reference;
  };

  // The joint of a name that can lead or follow; nothing: reported.
  const Scalar* scalar(const std::string& name, const Coupling& coupling) {
    const auto found = scalars_.find(name);
    if (found != scalars_.end()) return &found->second;
    std::vector<std::string_view> names;
    for (const auto& [each, value] : scalars_) names.push_back(each);
    std::ranges::sort(names);
    c_.log.report(Code("E6220"), coupling.where,
                  fmt::format("there is no hinge or slide {}; the joints move independently",
                              in_quotes(name)),
                  near_hint(name, names));
    return nullptr;
  }

  // Joints that follow others, and those that are held.
  void couple() {
    std::vector<scene::Joint>& joints = out_.scene().joints;
    std::vector<char> taken(joints.size(), 0);
    for (const Coupling& coupling : model_.couplings) {
      const Scalar* const follower = scalar(coupling.follower, coupling);
      if (!follower) continue;
      const auto index = static_cast<std::size_t>(follower->joint);
      if (taken[index]) {
        c_.log.report(Code("W6221"), coupling.where,
                      fmt::format("the joint {} is held or follows another one already; this is "
                                  "left out",
                                  in_quotes(coupling.follower)));
        continue;
      }
      if (coupling.leader.empty()) {
        taken[index] = 1;
        hold(joints[index], follower->reference + coupling.factors[0]);
        continue;
      }
      const Scalar* const leader = scalar(coupling.leader, coupling);
      if (!leader) continue;
      if (leads(joints, leader->joint, follower->joint)) {
        c_.log.report(Code("E6220"), coupling.where,
                      fmt::format("the joint {} follows itself; it moves independently",
                                  in_quotes(coupling.follower)));
        continue;
      }
      taken[index] = 1;
      const auto& factors = coupling.factors;
      if (factors[2] != 0 || factors[3] != 0 || factors[4] != 0)
        c_.log.report(Code("W6221"), coupling.where,
                      fmt::format("the joint {} follows a curve; its line {:g} + {:g}·x is taken",
                                  in_quotes(coupling.follower), factors[0], factors[1]));
      scene::Joint& joint = joints[index];
      joint.mimic = leader->joint;
      joint.multiplier = factors[1];
      joint.offset = follower->reference + factors[0] - factors[1] * leader->reference;
      joint.value.clear();
    }
    for (const Outside& each : outside_)
      if (joints[each.joint].mimic == kNone)
        c_.log.report(Code("W6221"), each.where,
                      fmt::format("ref is outside the limits of the joint {}: it begins at {:g}",
                                  in_quotes(joints[each.joint].name), each.begins));
  }

  // Whether going up from a joint through those that it follows comes to another one.
  static bool leads(const std::vector<scene::Joint>& joints, std::int32_t from, std::int32_t to) {
    for (; from != kNone; from = joints[static_cast<std::size_t>(from)].mimic)
      if (from == to) return true;
    return false;
  }

  static void hold(scene::Joint& joint, double value) {
    if (joint.kind == JointKind::continuous) joint.kind = JointKind::revolute;
    joint.lower = joint.upper = {value};
    joint.value.clear();
    if (value != 0) joint.value = {value};
  }

  // ---- what a body holds

  bool fill(std::size_t index) {
    const Body& body = model_.bodies[index];
    const std::string name = index == 0 ? "world" : body.name.empty() ? "body" : body.name;
    std::size_t number = 0;
    for (const Geom& geom : body.geoms) {
      ++number;
      std::string own = geom.name;
      if (own.empty()) own = number == 1 ? name + "_geom" : fmt::format("{}_geom{}", name, number);
      const std::int32_t place = out_.assembly.add_node(node_of_[index], own, "geom", geom.where);
      if (place == kNone) return false;
      node(place).parent_from_node = {geom.pose.position, geom.pose.rotation, Vec3(1)};
      if (!add_geom(geom, own, place)) return false;
    }
    for (const Mark& mark : body.marks) {
      scene::Frame frame;
      frame.name = scene_name(mark.name);
      frame.node = node_of_[index];
      frame.origin = mark.pose.position;
      frame.rotation = glm::normalize(mark.pose.rotation);
      frame.source = out_.assembly.source_of(mark.where);
      scene::Scene& scene = out_.scene();
      // note: names that differ in the file alone, as "a/b" and "a_b"
      if (std::ranges::none_of(scene.frames, [&](const auto& f) { return f.name == frame.name; }))
        scene.frames.push_back(std::move(frame));
    }
    return true;
  }

  bool add_geom(const Geom& geom, const std::string& name, std::int32_t place) {
    const Cover cover = out_.painter.cover_of(geom.paint);
    if (geom.mesh != kNone) {
      // note: whatever materials the mesh has, MuJoCo draws none of it
      if (geom.paint != kNone && out_.painter.is_invisible(geom.paint)) {
        c_.skipped("geom of opacity 0");
        return true;
      }
      const MeshAsset& mesh = model_.meshes[static_cast<std::size_t>(geom.mesh)];
      node(place).parent_from_node.scale = mesh.file.scale;
      if (!(mesh.reference.position == Vec3(0) && mesh.reference.rotation == Quat(1, 0, 0, 0))) {
        place = out_.assembly.add_node(place, name + "_mesh", "geom", geom.where);
        if (place == kNone) return false;
        const Quat back = glm::conjugate(mesh.reference.rotation);
        node(place).parent_from_node = {-(back * mesh.reference.position), back, Vec3(1)};
      }
      if (mesh.mesh)
        add_vertices(geom, place, cover);
      else
        out_.meshes.attach(mesh.file, place, cover);
      return true;
    }
    for (std::size_t k = 0; k < geom.shapes.size(); ++k) {
      std::int32_t at = place;
      if (geom.heights[k] != 0) {
        at = out_.assembly.add_node(place, fmt::format("{}_end{}", name, k), "geom", geom.where);
        if (at == kNone) return false;
        node(at).parent_from_node.translation = {0, 0, geom.heights[k]};
      }
      if (!out_.add_shape(geom.shapes[k], at, cover, geom.where)) break;
    }
    return true;
  }

  // A mesh of the model's own numbers, kept once.
  void add_vertices(const Geom& geom, std::int32_t place, Cover cover) {
    const auto& mesh = model_.meshes[static_cast<std::size_t>(geom.mesh)].mesh;
    const auto [shape, is_new] =
        shape_of_.try_emplace(geom.mesh, static_cast<std::int32_t>(out_.scene().shapes.size()));
    if (is_new) {
      if (!out_.assembly.has_room_for(mesh->triangles.size(), geom.where)) return;
      out_.scene().shapes.emplace_back(mesh);
    }
    if (cover.texture != kNone && mesh->texcoords.empty()) {
      cover.texture = kNone;
      c_.trouble(Code("W6221"), "flat", geom.where, [] {
        return std::string(
            "a mesh has no texture coordinates: the texture of its geom is not used");
      });
    }
    out_.place_shape(shape->second, place, cover, geom.where);
  }

  struct Outside {
    std::size_t joint;
    SourceSpan where;
    double begins;
  };

  const Model& model_;
  meshes::ReaderContext& c_;
  RobotScene out_;
  std::vector<std::int32_t> node_of_;  // of bodies
  std::vector<std::uint32_t> depth_;
  std::unordered_map<std::string, Scalar> scalars_;
  std::vector<Outside> outside_;
  std::unordered_map<std::int32_t, std::int32_t> shape_of_;  // of meshes with vertices
};

// Includer of files: the contents of each take the place of its <include>.
class Includer {
 public:
  Includer(XmlText& text, meshes::ReaderContext& context) : text_(text), c_(context) {}

  void run() {
    const pugi::xml_node top = text_.top();
    pugi::xml_node at = top.first_child();
    pugi::xml_node around = top;  // of `at`
    for (;;) {
      if (!at) {
        if (around == top) return;
        at = around.next_sibling();
        around = around.parent();
      } else if (std::string_view(at.name()) == "include") {
        at = in_place_of(at);
      } else {
        around = at;
        at = at.first_child();
      }
    }
  }

 private:
  // A file is looked for beside the model, then beside the text that includes it, as MuJoCo does.
  // It may be included again, but not in itself.
  pugi::xml_node in_place_of(pugi::xml_node element) {
    const pugi::xml_attribute file = element.attribute("file");
    const SourceSpan where = file ? text_.at(file) : text_.at(element);
    if (!file) {
      c_.log.report(Code("E6220"), where, "<include> has no file; it is left out");
    } else if (!c_.full) {
      const FileName name{
          .text = file.value(), .including = {c_.file.path, text_.path_of(element)}, .part = true};
      if (const auto found = c_.read_named(name, where)) {
        if (!text_.is_within(element, found->path))
          return text_.include(element, found->path, found->bytes, where,
                               {"mujoco", "mujocoinclude"});
        c_.log.report(Code("E6220"), where,
                      fmt::format("{} includes itself; it is left out", in_quotes(found->path)));
      }
    }
    const pugi::xml_node next = element.next_sibling();
    element.parent().remove_child(element);
    return next;
  }

  XmlText& text_;
  meshes::ReaderContext& c_;
};

}  // namespace

bool is_model(std::string_view text) { return first_element_is(text, "mujoco"); }

Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log) {
  const auto made = [](XmlText& text, meshes::ReaderContext& context) -> std::optional<Imported> {
    Includer(text, context).run();
    const Model model = read_model(text, context);
    if (model.bodies.size() < 2 && model.bodies[0].geoms.empty()) return std::nullopt;
    return SceneMaker(model, context).made();
  };
  return read_robot_file(files, file, options, log, made,
                         "the model has no body and no geom, expected a <worldbody> with bodies");
}

}  // namespace panwright::importers::mjcf
