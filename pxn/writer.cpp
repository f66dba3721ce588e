#include "pxn/writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "pxn/format.h"
#include "pxn/text/element_writer.h"
#include "pxn/text/writer_lights.h"

namespace panwright::pxn {

namespace {

// Characters that a name of level 1 cannot hold as they are.
std::string plain(std::string name) {
  for (char& c : name) {
    if (c == '{') c = '(';
    if (c == '}') c = ')';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return name.find_first_not_of(' ') == std::string::npos ? "unnamed" : name;
}

// Names as they are, with a number where several things have the same.
class UniqueNames {
 public:
  std::string add(const std::string& name) {
    std::string unique = name;
    for (std::size_t number = 2; !taken_.insert(unique).second; ++number)
      unique = name + "_" + std::to_string(number);
    return unique;
  }

 private:
  std::set<std::string> taken_;
};

class Writer {
 public:
  Writer(const scene::Scene& scene, const TextureName& image_name)
      : scene_(scene), texture_(image_name), out_(text_) {}

  std::string run() {
    collect();
    name_materials();
    name_shapes();
    joint_names_ = scene::joint_names(scene_);
    text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    out_.open("pangu_model");
    out_.attribute("ver", "1");
    out_.attribute("angle", "rad");
    const scene::Transform& root = scene_.nodes[0].parent_from_node;
    const bool moved = !(root == scene::Transform{}) && !is_y_up(root);
    if (is_y_up(root)) out_.attribute("up", "y");
    budget();
    write_settings(scene_.settings, out_);
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) material(i);
    if (moved) {
      out_.open("node");
      transform(root);
    }
    content(0);
    if (moved) out_.close("node");
    for (const DecalGroup& group : decals_) decal(group);
    out_.close("pangu_model");
    return std::move(text_);
  }

 private:
  struct DecalGroup {
    std::size_t decal;  // of the first instance
    std::string on;
  };
  // What stands at a node, in the scene's order.
  struct At {
    std::vector<std::size_t> children;
    std::vector<std::size_t> instances;
    std::vector<std::size_t> frames;
    std::vector<std::size_t> keypoints;
    std::vector<std::size_t> lamps;
    std::vector<std::size_t> joints;
    // the first frame, keypoint and lamp at the node and below
    std::size_t first_frame = kNever;
    std::size_t first_keypoint = kNever;
    std::size_t first_lamp = kNever;
    std::int32_t texture = scene::kNone;  // begins here, around the node
    bool lone_shape() const {
      return instances.size() == 1 && children.empty() && frames.empty() && keypoints.empty() &&
             lamps.empty() && joints.empty();
    }
  };
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

  static bool is_y_up(const scene::Transform& t) {
    return t.translation == Vec3(0) && t.scale == Vec3(1) &&
           t.rotation ==
               glm::normalize(Quat(1, 0, 0, 0) * Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0));
  }

  // ---- what stands where

  void collect() {
    at_.resize(scene_.nodes.size());
    for (std::size_t i = 1; i < scene_.nodes.size(); ++i)
      at_[static_cast<std::size_t>(scene_.nodes[i].parent)].children.push_back(i);
    const auto add = [&](const auto& items, std::vector<std::size_t> At::*list) {
      for (std::size_t i = 0; i < items.size(); ++i)
        (at_[static_cast<std::size_t>(items[i].node)].*list).push_back(i);
    };
    add(scene_.instances, &At::instances);
    add(scene_.frames, &At::frames);
    add(scene_.keypoints, &At::keypoints);
    add(scene_.lamps, &At::lamps);
    add(scene_.joints, &At::joints);
    for (std::size_t i = scene_.nodes.size(); i-- > 0;) {
      At& at = at_[i];
      if (!at.frames.empty()) at.first_frame = std::min(at.first_frame, at.frames[0]);
      if (!at.keypoints.empty()) at.first_keypoint = std::min(at.first_keypoint, at.keypoints[0]);
      if (!at.lamps.empty()) at.first_lamp = std::min(at.first_lamp, at.lamps[0]);
      if (i == 0) break;
      At& parent = at_[static_cast<std::size_t>(scene_.nodes[i].parent)];
      parent.first_frame = std::min(parent.first_frame, at.first_frame);
      parent.first_keypoint = std::min(parent.first_keypoint, at.first_keypoint);
      parent.first_lamp = std::min(parent.first_lamp, at.first_lamp);
    }
    for (const scene::Instance& instance : scene_.instances) place_texture(instance);
  }

  // Finds the node that a texture by direction begins around: where the transforms from there on
  // make its matrix.
  void place_texture(const scene::Instance& instance) {
    if (instance.texture == scene::kNone || instance.mapping != scene::Mapping::sphere) return;
    std::vector<std::size_t> path;  // from the instance's node to the root, which is left out
    for (std::int32_t node = instance.node; node > 0;
         node = scene_.nodes[static_cast<std::size_t>(node)].parent)
      path.push_back(static_cast<std::size_t>(node));
    for (std::size_t length = 1; length <= path.size(); ++length) {
      Mat4 matrix(1);
      for (std::size_t i = length; i-- > 0;)
        matrix = matrix * scene_.nodes[path[i]].parent_from_node.matrix();
      if (!(matrix == instance.texture_from_shape)) continue;
      at_[path[length - 1]].texture = instance.texture;
      return;
    }
    if (!path.empty()) at_[path[0]].texture = instance.texture;
  }

  // ---- names

  void name_materials() {
    UniqueNames names;
    for (const materials::Material& m : scene_.materials)
      materials_.push_back(names.add(plain(m.name)));
  }

  // Instances are called as their nodes. Decals find theirs by name, so where others have the name
  // too, it changes, unless the same decal lies on all of them.
  void name_shapes() {
    std::map<std::string, std::vector<std::int32_t>> called;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      names_.push_back(
          plain(scene_.nodes[static_cast<std::size_t>(scene_.instances[i].node)].name));
      called[names_.back()].push_back(static_cast<std::int32_t>(i));
    }
    std::set<std::string> taken;
    for (const auto& [name, instances] : called) taken.insert(name);
    const auto rename = [&](std::int32_t instance) {
      std::string& name = names_[static_cast<std::size_t>(instance)];
      std::vector<std::int32_t>& group = called[name];
      if (group.size() == 1) return;
      group.erase(std::find(group.begin(), group.end(), instance));
      std::string unique = name;
      for (std::size_t number = 2; !taken.insert(unique).second; ++number)
        unique = name + "_" + std::to_string(number);
      name = unique;
      called[name] = {instance};
    };
    // first those that lie on some only, which changes names; then all of them by their names
    const auto lies_on_all = [&](std::size_t first) {
      const scene::Decal& decal = scene_.decals[first];
      const auto& group = called[names_[static_cast<std::size_t>(decal.instance)]];
      for (std::size_t k = 0; k < group.size(); ++k)
        if (first + k >= scene_.decals.size() || !same_decal(decal, scene_.decals[first + k]) ||
            scene_.decals[first + k].instance != group[k])
          return std::size_t{0};
      return group.size();
    };
    for (bool changed = true; changed;) {
      changed = false;
      decals_.clear();
      for (std::size_t i = 0; i < scene_.decals.size();) {
        const std::int32_t instance = scene_.decals[i].instance;
        if (const std::size_t all = lies_on_all(i)) {
          decals_.push_back({i, names_[static_cast<std::size_t>(instance)]});
          i += all;
          continue;
        }
        rename(instance);
        changed = true;
        ++i;
      }
    }
  }

  static bool same_decal(const scene::Decal& a, const scene::Decal& b) {
    return a.name == b.name && a.texture == b.texture && a.at == b.at && a.normal == b.normal &&
           a.up == b.up && a.width == b.width && a.height == b.height;
  }

  std::string image_name(std::int32_t texture) const {
    const auto index = static_cast<std::size_t>(texture);
    return texture_ ? texture_(index) : scene_.textures[index].name;
  }

  // ---- definitions

  void budget() {
    const scene::Budget& budget = scene_.budget;
    const bool camera = budget.nearest && budget.ifov;
    if (!budget.tolerance && !camera && !budget.flux) return;
    out_.open("budget");
    const auto term = [&](std::string_view name, const std::optional<double>& value) {
      if (value) out_.attribute(name, *value);
    };
    term("tolerance", budget.tolerance);
    if (camera) {
      term("nearest", budget.nearest);
      term("ifov", budget.ifov);
      term("pixels", budget.pixels);
      term("centroid", budget.centroid);
      if (!budget.approach.empty()) {
        out_.attribute("approach", budget.approach);
        out_.attribute("corridor", budget.corridor);
      }
    }
    term("flux", budget.flux);
    out_.close("budget");
  }

  void material(std::size_t index) {
    materials::Material m = scene_.materials[index];
    // level 1 refuses weights that add up to more than 1; their products with the colours remain
    const double weights = m.weights.x + m.weights.y + m.weights.z;
    if (weights > 1 + 1e-9) {
      m.weights /= weights;
      for (Vec3* color : {&m.diffuse, &m.specular, &m.emissive}) *color *= weights;
    }
    out_.open("material");
    out_.attribute("name", materials_[index]);
    const auto map = [&](std::string_view name, std::int32_t texture) {
      if (texture != scene::kNone) out_.attribute(name, image_name(texture));
    };
    map("albedo_map", m.maps.albedo);
    map("normal_map", m.maps.normal);
    map("roughness_map", m.maps.roughness);
    map("reflectance_map", m.maps.reflectance);
    if (m.maps.repeat != Vec2(1)) out_.numbers("map_repeat", std::span(&m.maps.repeat.x, 2));
    vector("diffuse", m.diffuse);
    const auto* phong = std::get_if<materials::BlinnPhong>(&m.specular_brdf);
    const double shine = phong != nullptr ? phong->shine : 0;
    if (m.specular != Vec3(0) || shine != 0) {
      out_.open("specular");
      if (shine != 0) out_.attribute("shine", shine);
      for (int k = 0; k < 3; ++k) out_.number(m.specular[k]);
      out_.close("specular");
    }
    if (m.emissive != Vec3(0)) vector("emissive", m.emissive);
    vector("reflect", m.weights);
    brdfs(m);
    if (m.maps.cutout != scene::kNone) {
      out_.open("cutout");
      out_.attribute("image", image_name(m.maps.cutout));
      out_.attribute("threshold", m.maps.threshold);
      out_.close("cutout");
    }
    out_.close("material");
  }

  void brdfs(const materials::Material& m) {
    if (m.diffuse_model() != materials::DiffuseModel::lambert)
      brdf(materials::info_of(m.diffuse_model()), m.diffuse_brdf, m.compensation);
    brdf(materials::info_of(m.specular_model()), m.specular_brdf, m.compensation);
    if (m.refract && m.extinction != Vec3(0)) {
      out_.open("conductor");
      out_.attribute("n", *m.refract);
      out_.attribute("k", m.extinction);
      out_.close("conductor");
    } else if (m.refract) {
      vector("refract", *m.refract);
    }
    if (m.coat) {
      out_.open("coat");
      out_.attribute("n", m.coat->index);
      out_.attribute("slope", m.coat->alpha);
      if (m.coat->depth != Vec3(0)) {
        out_.attribute("absorption", m.coat->depth);
        out_.attribute("thickness", 1.0);
      }
      out_.close("coat");
    }
    if (m.cells) cells(*m.cells);
  }

  // The element of a BRDF; attributes that have their default are left out.
  template <class Brdf>
  void brdf(const materials::ModelInfo& info, const Brdf& brdf, materials::Compensation energy) {
    using materials::Compensation;
    if (info.tag.empty()) return;
    out_.open(info.tag);
    std::vector<double> numbers;
    visit_parameters(brdf,
                     [&](const materials::Parameter& parameter, std::span<const double> values) {
                       std::vector<double> written(values.begin(), values.end());
                       if (parameter.pxn_unit != 1)
                         for (double& value : written) value = materials::exact_degrees(value);
                       if (parameter.attribute.empty())
                         numbers.insert(numbers.end(), written.begin(), written.end());
                       else if (values[0] != parameter.initial)
                         out_.numbers(parameter.attribute, written);
                     });
    if (info.smith && energy != Compensation::automatic)
      out_.attribute("energy", energy == Compensation::on ? "full" : "single");
    for (const double number : numbers) out_.number(number);
    out_.close(info.tag);
  }

  void cells(const materials::Cells& c) {
    out_.open("cells");
    out_.attribute("columns", c.count.x);
    out_.attribute("rows", c.count.y);
    out_.numbers("gap", std::span(&c.gap.x, 2));
    out_.attribute("gap_color", c.gap_color);
    out_.attribute("fingers", c.fingers);
    out_.attribute("finger_width", c.finger_width);
    out_.attribute("finger_color", c.finger_color);
    if (c.tilt != Vec2(0)) out_.numbers("tilt", std::span(&c.tilt.x, 2));
    out_.close("cells");
  }

  void vector(std::string_view tag, const Vec3& v) { out_.element(tag, std::span(&v.x, 3)); }

  // ---- nodes

  // Children, frames, keypoints and lamps, so that each of their lists keeps its order.
  void content(std::size_t node) {
    const At& at = at_[node];
    std::size_t frame = 0, keypoint = 0, lamp = 0;
    const auto rest_before = [&](std::size_t first_frame, std::size_t first_keypoint,
                                 std::size_t first_lamp) {
      while (frame < at.frames.size() && at.frames[frame] < first_frame)
        write_frame(at.frames[frame++]);
      while (keypoint < at.keypoints.size() && at.keypoints[keypoint] < first_keypoint)
        write_keypoint(at.keypoints[keypoint++]);
      while (lamp < at.lamps.size() && at.lamps[lamp] < first_lamp)
        one_lamp(scene_.lamps[at.lamps[lamp++]]);
    };
    if (node == 0 || !at.lone_shape())
      for (const std::size_t instance : at.instances) shape(instance, nullptr);
    // those that need not stand before a child stand behind all of them
    const auto due = [](std::size_t first) { return first == kNever ? 0 : first; };
    for (const std::size_t child : at.children) {
      const At& below = at_[child];
      rest_before(due(below.first_frame), due(below.first_keypoint), due(below.first_lamp));
      write_node(child);
    }
    rest_before(kNever, kNever, kNever);
  }

  void write_node(std::size_t index) {
    const scene::Node& node = scene_.nodes[index];
    const At& at = at_[index];
    if (at.texture != scene::kNone) open_texture(at.texture);
    if (at.lone_shape()) {
      shape(at.instances[0], &node.parent_from_node);
    } else if (!at.joints.empty()) {
      for (const std::size_t joint : at.joints) {
        out_.open("joint");
        write_joint(joint, plain(node.name));
        if (joint == at.joints.front()) marks(index);
        if (joint == at.joints.front()) transform(node.parent_from_node);
      }
      content(index);
      for (std::size_t i = 0; i < at.joints.size(); ++i) out_.close("joint");
    } else {
      out_.open("node");
      out_.attribute("name", plain(node.name));
      marks(index);
      transform(node.parent_from_node);
      content(index);
      out_.close("node");
    }
    if (at.texture != scene::kNone) {
      out_.close("child");
      out_.close("texture");
    }
  }

  void write_joint(std::size_t index, const std::string& node) {
    const scene::Joint& joint = scene_.joints[index];
    const std::string name = plain(joint_names_[index]);
    out_.attribute("name", name);
    if (name != node && !node.empty()) out_.attribute("node", node);
    out_.attribute("type", std::string(geometry::kind_name(joint.kind)));
    if (joint.axis != Vec3(0, 0, 1)) out_.attribute("axis", joint.axis);
    const auto list = [&](const char* word, const std::vector<double>& values) {
      if (!values.empty()) out_.numbers(word, values);
    };
    list("lower", joint.lower);
    list("upper", joint.upper);
    if (joint.mimic != scene::kNone) {
      out_.attribute("mimic", plain(joint_names_[static_cast<std::size_t>(joint.mimic)]));
      if (joint.multiplier != 1) out_.attribute("multiplier", joint.multiplier);
      if (joint.offset != 0) out_.attribute("offset", joint.offset);
      return;
    }
    list("value", joint.value);
    if (!joint.pointing) return;
    out_.attribute("pointing", *joint.pointing);
    if (joint.gimbal != scene::kNone)
      out_.attribute("gimbal", plain(joint_names_[static_cast<std::size_t>(joint.gimbal)]));
    if (joint.point_at == scene::PointAt::sun) out_.attribute("point_at", std::string("sun"));
  }

  void open_texture(std::int32_t texture) {
    out_.open("texture");
    out_.attribute("type", "sphere");
    out_.open("data");
    out_.open("include");
    out_.attribute("type", "raw");
    out_.attribute("file", image_name(texture));
    out_.close("include");
    out_.close("data");
    out_.open("child");
  }

  void transform(const scene::Transform& t) {
    if (t.translation != Vec3(0)) out_.attribute("translate", t.translation);
    rotation(t.rotation);
    if (t.scale == Vec3(1)) return;
    if (t.scale.x == t.scale.y && t.scale.y == t.scale.z)
      out_.attribute("scale", t.scale.x);
    else
      out_.attribute("scale", t.scale);
  }
  void rotation(const Quat& q) {
    if (q == Quat(1, 0, 0, 0)) return;
    out_.numbers("quat", std::array{q.w, q.x, q.y, q.z});
  }

  void marks(std::size_t node) {
    const std::string& label = scene_.nodes[node].marks.label;
    if (!label.empty()) out_.attribute("label", plain(label));
  }

  void shape(std::size_t index, const scene::Transform* place) {
    const scene::Instance& instance = scene_.instances[index];
    const geometry::Shape& shape = scene_.shapes[static_cast<std::size_t>(instance.shape)];
    const std::string_view tag = geometry::kind_name(shape);
    out_.open(tag);
    out_.attribute("name", names_[index]);
    if (place != nullptr) marks(static_cast<std::size_t>(instance.node));
    write_shape_attributes(shape, out_);
    if (place != nullptr) transform(*place);
    out_.attribute("material", materials_[static_cast<std::size_t>(instance.material)]);
    if (instance.back != scene::kNone)
      out_.attribute("back", materials_[static_cast<std::size_t>(instance.back)]);
    if (instance.tolerance) out_.attribute("tolerance", *instance.tolerance);
    write_shape_children(shape, out_);
    out_.close(tag);
  }

  void write_frame(std::size_t index) {
    const scene::Frame& frame = scene_.frames[index];
    out_.open("frame");
    out_.attribute("name", plain(frame.name));
    if (frame.origin != Vec3(0)) out_.attribute("translate", frame.origin);
    rotation(frame.rotation);
    out_.close("frame");
  }

  void write_keypoint(std::size_t index) {
    out_.open("keypoint");
    out_.attribute("name", plain(scene_.keypoints[index].name));
    out_.attribute("at", scene_.keypoints[index].position);
    out_.close("keypoint");
  }

  void one_lamp(const scene::Lamp& lamp) { write_lamp(lamp, plain(lamp.name), out_); }

  void decal(const DecalGroup& group) {
    const scene::Decal& decal = scene_.decals[group.decal];
    out_.open("decal");
    if (!decal.name.empty()) out_.attribute("name", plain(decal.name));
    out_.attribute("on", group.on);
    out_.attribute("image", image_name(decal.texture));
    out_.attribute("at", decal.at);
    out_.numbers("size", std::array{decal.width, decal.height});
    if (decal.normal) out_.attribute("normal", *decal.normal);
    if (decal.up) out_.attribute("up", *decal.up);
    out_.close("decal");
  }

  const scene::Scene& scene_;
  const TextureName& texture_;
  std::string text_;
  ElementWriter out_;
  std::vector<At> at_;  // by node
  std::vector<std::string> names_;
  std::vector<std::string> joint_names_;
  std::vector<std::string> materials_;  // by material
  std::vector<DecalGroup> decals_;
};

}  // namespace

std::string to_text(const scene::Scene& scene, const TextureName& name) {
  DiagnosticLog log;
  Limits limits;
  limits.elements = std::numeric_limits<std::uint32_t>::max();
  limits.depth = std::numeric_limits<std::uint32_t>::max();
  auto raw = std::make_shared<const std::string>(Writer(scene, name).run());
  auto text = formatted("scene", raw, limits, log);
  // what is too large for that is right as it is
  return text ? std::move(*text) : *raw;
}

}  // namespace panwright::pxn
