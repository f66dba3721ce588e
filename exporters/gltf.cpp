#include "exporters/export.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/text.h"
#include "exporters/internal/gltf_joints.h"
#include "exporters/internal/gltf_materials.h"

namespace panwright::exporters {

namespace {

using nlohmann::ordered_json;

constexpr int kFloat = 5126, kShorts = 5123, kLongs = 5125;
constexpr int kVertices = 34962, kElements = 34963;

// Surfaces of one glTF mesh: a pan mesh, material, texture, and the side that wears them, each.
using Part = std::array<std::int64_t, 4>;
using Parts = std::vector<Part>;
constexpr std::int64_t kBoth = 0, kFront = 1, kBack = 2;

class Exporter {
 public:
  Exporter(const pan::Model& model, DiagnosticLog& log, const Job& job, const GlbOptions& options)
      : model_(model), log_(log), job_(job), options_(options), materials_(model, job) {}

  Result<std::vector<std::byte>> run() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "panwright"}};
    json_["scene"] = 0;
    json_["scenes"] = ordered_json::array({{{"nodes", {0}}}});
    add_nodes();
    add_points();
    finish_nodes();
    if (!materials_.json().empty()) json_["materials"] = materials_.json();
    add_textures();
    say_what_is_lost();
    std::set<std::string> extensions = materials_.extensions();
    if (!articulations_.empty()) {
      extensions.insert("AGI_articulations");
      json_["extensions"]["AGI_articulations"]["articulations"] = std::move(articulations_);
    }
    if (!extensions.empty()) json_["extensionsUsed"] = extensions;
    return container();
  }

 private:
  // ---- the binary chunk

  std::size_t add_view(const void* data, std::size_t size, int stride, int target) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    ordered_json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
    if (stride > 0) view["byteStride"] = stride;
    if (target > 0) view["target"] = target;
    const std::size_t at = binary_.size();
    binary_.resize(at + size);
    std::memcpy(binary_.data() + at, data, size);
    json_["bufferViews"].push_back(std::move(view));
    return json_["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(std::size_t view, int component, std::size_t count, const char* type) {
    json_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return json_["accessors"].size() - 1;
  }

  template <class Vector>
  std::size_t add_vertices(std::span<const Vector> vertices, const char* type) {
    const std::size_t view = add_view(vertices.data(), vertices.size_bytes(),
                                      static_cast<int>(sizeof(Vector)), kVertices);
    return add_accessor(view, kFloat, vertices.size(), type);
  }

  std::size_t add_positions(std::span<const pan::layout::Float3> positions) {
    const std::size_t accessor = add_vertices(positions, "VEC3");
    pan::layout::Float3 low = positions[0], high = positions[0];
    for (const auto& p : positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    json_["accessors"][accessor]["min"] = {double{low.x}, double{low.y}, double{low.z}};
    json_["accessors"][accessor]["max"] = {double{high.x}, double{high.y}, double{high.z}};
    return accessor;
  }

  // (0, 0) is the top left in glTF
  std::size_t add_texcoords(std::span<const pan::layout::Float2> texcoords) {
    std::vector<pan::layout::Float2> turned(texcoords.begin(), texcoords.end());
    for (auto& p : turned) p.y = 1 - p.y;
    return add_vertices(std::span<const pan::layout::Float2>(turned), "VEC2");
  }

  const ordered_json& geometry(std::size_t index) {
    const auto known = geometries_.find(index);
    if (known != geometries_.end()) return known->second;
    const pan::MeshView mesh = model_.mesh(index);
    ordered_json& out = geometries_[index];
    out["attributes"]["POSITION"] = add_positions(mesh.positions);
    out["attributes"]["NORMAL"] = add_vertices(mesh.normals, "VEC3");
    if (!mesh.texcoords.empty()) out["attributes"]["TEXCOORD_0"] = add_texcoords(mesh.texcoords);
    const bool shorts = !mesh.indices.shorts.empty();
    const std::size_t view =
        shorts
            ? add_view(mesh.indices.shorts.data(), mesh.indices.shorts.size_bytes(), 0, kElements)
            : add_view(mesh.indices.longs.data(), mesh.indices.longs.size_bytes(), 0, kElements);
    out["indices"] = add_accessor(view, shorts ? kShorts : kLongs, mesh.indices.size(), "SCALAR");
    return out;
  }

  std::size_t colors(std::size_t index) {
    const auto known = colors_.find(index);
    if (known != colors_.end()) return known->second;
    return colors_[index] = add_vertices(model_.mesh(index).colors, "VEC3");
  }

  // The same mesh turned inside out: what is seen of its back.
  const ordered_json& turned(std::size_t index) {
    const auto known = turned_.find(index);
    if (known != turned_.end()) return known->second;
    ordered_json out = geometry(index);
    const pan::MeshView mesh = model_.mesh(index);
    std::vector<pan::layout::Float3> normals(mesh.normals.begin(), mesh.normals.end());
    for (auto& n : normals) n = {-n.x, -n.y, -n.z};
    out["attributes"]["NORMAL"] =
        add_vertices(std::span<const pan::layout::Float3>(normals), "VEC3");
    std::vector<std::uint32_t> indices(mesh.indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i)
      indices[i] = mesh.indices[i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1];
    const std::size_t view =
        add_view(indices.data(), indices.size() * sizeof(std::uint32_t), 0, kElements);
    out["indices"] = add_accessor(view, kLongs, indices.size(), "SCALAR");
    return turned_[index] = std::move(out);
  }

  ordered_json primitive(const Part& part) {
    const auto index = static_cast<std::size_t>(part[0]);
    const auto material = static_cast<std::size_t>(part[1]);
    const std::int64_t side = part[3];
    ordered_json out = side == kBack ? turned(index) : geometry(index);
    // our back faces are drawn but where they are hidden
    const bool closed = (model_.meshes()[index].flags & pan::layout::kMeshClosed) != 0 &&
                        model_.materials()[material].cutout_map < 0;
    const Faces faces = side != kBoth ? Faces::one_side : closed ? Faces::front : Faces::both;
    const std::size_t place = materials_.place(material, static_cast<std::int32_t>(part[2]),
                                               out["attributes"].contains("TEXCOORD_0"), faces);
    if (side != kBack && !model_.mesh(index).colors.empty() && materials_.takes_colors(place)) {
      out["attributes"]["COLOR_0"] = colors(index);
      materials_.note_colors(place);
    }
    out["material"] = place;
    return out;
  }

  // ---- nodes

  static void place(ordered_json& node, const Vec3& translation, const Quat& rotation,
                    const Vec3& scale) {
    if (translation != Vec3(0)) node["translation"] = {translation.x, translation.y, translation.z};
    if (rotation != Quat(1, 0, 0, 0))
      node["rotation"] = {rotation.x, rotation.y, rotation.z, rotation.w};
    if (scale != Vec3(1)) node["scale"] = {scale.x, scale.y, scale.z};
  }

  void add_nodes() {
    // +z becomes +y
    const double half = std::sqrt(0.5);
    ordered_json top = {{"name", "panwright"}};
    place(top, Vec3(0), Quat(half, -half, 0, 0), Vec3(1));
    nodes_.push_back(std::move(top));
    children_.resize(1);
    std::vector<std::map<std::size_t, std::vector<std::size_t>>> instances(model_.nodes().size());
    for (std::size_t i = 0; i < model_.instances().size(); ++i) {
      const pan::layout::Instance& instance = model_.instances()[i];
      instances[instance.node][origin_index(instance.mesh)].push_back(i);
    }
    const auto values =
        options_.joint_values.empty() ? model_.initial_values() : options_.joint_values;
    std::size_t joint = 0, label = 0;
    for (std::size_t i = 0; i < model_.nodes().size(); ++i) {
      const pan::layout::Node& from = model_.nodes()[i];
      ordered_json node = {{"name", std::string(model_.node_name(i))}};
      if (label < model_.labels().size() && model_.labels()[label].node == i)
        node["extras"] = {{"label", std::string(model_.label_name(label++))}};
      place(node, {from.translation[0], from.translation[1], from.translation[2]},
            Quat(from.rotation[0], from.rotation[1], from.rotation[2], from.rotation[3]),
            {from.scale[0], from.scale[1], from.scale[2]});
      std::size_t self = add(std::move(node), from.parent < 0 ? 0 : place_of_[from.parent]);
      for (; joint < values.size() && model_.joints()[joint].node == i; ++joint)
        self = options_.articulations ? articulate(joint, values[joint], self)
                                      : add_motion(joint, values[joint], self);
      place_of_.push_back(self);
    }
    for (std::size_t i = 0; i < model_.nodes().size(); ++i)
      for (const auto& [origin, list] : instances[i]) add_surfaces(place_of_[i], origin, list);
  }

  // An articulation on the node itself, or below it on one whose z is the joint's axis. Returns the
  // node that what moves stands below.
  std::size_t articulate(std::size_t index, const geometry::JointValues& values,
                         std::size_t parent) {
    const pan::layout::Joint& record = model_.joints()[index];
    std::optional<Vec3> pointing(std::in_place, record.pointing[0], record.pointing[1],
                                 record.pointing[2]);
    if (*pointing == Vec3(0) || record.gimbal >= 0) pointing.reset();
    const std::string name(model_.joint_name(index));
    ArticulatedJoint made = articulated(pan::kinematic(record), values, name, pointing);
    if (made.articulation.is_null()) return parent;
    const bool turned = made.node_from_axis != Quat(1, 0, 0, 0);
    std::size_t host = parent;
    if (turned || nodes_[parent].contains("extensions")) {
      ordered_json node = {{"name", name}, {"extras", {{"kind", "axis"}}}};
      place(node, Vec3(0), made.node_from_axis, Vec3(1));
      host = add(std::move(node), parent);
    }
    nodes_[host]["extensions"]["AGI_articulations"]["articulationName"] = name;
    articulations_.push_back(std::move(made.articulation));
    uncoupled_ += made.coupled;
    if (!turned) return host;
    ordered_json back = {{"name", name}, {"extras", {{"kind", "axis"}}}};
    place(back, Vec3(0), glm::conjugate(made.node_from_axis), Vec3(1));
    return add(std::move(back), host);
  }

  // A node for the motion of a joint at its initial values; the node that holds it where it moves
  // nothing then.
  std::size_t add_motion(std::size_t index, const geometry::JointValues& values,
                         std::size_t parent) {
    const geometry::Joint joint = pan::kinematic(model_.joints()[index]);
    const Mat4 motion = geometry::motion(joint, values);
    if (motion == Mat4(1)) return parent;
    Vec3 scale(1);
    if (joint.kind == geometry::JointKind::general) scale = {values[0], values[1], values[2]};
    if (joint.kind == geometry::JointKind::scale)
      scale = {motion[0][0], motion[1][1], motion[2][2]};
    Mat3 turn(motion);
    for (int k = 0; k < 3; ++k) turn[k] /= scale[k];
    ordered_json node = {{"name", std::string(model_.joint_name(index))},
                         {"extras", {{"kind", "motion"}}}};
    place(node, Vec3(motion[3]), glm::normalize(glm::quat_cast(turn)), scale);
    return add(std::move(node), parent);
  }

  std::size_t add(ordered_json node, std::size_t parent) {
    nodes_.push_back(std::move(node));
    children_.emplace_back();
    children_[parent].push_back(nodes_.size() - 1);
    return nodes_.size() - 1;
  }

  // Meshes about one origin can stand at one node.
  std::size_t origin_index(std::size_t mesh) {
    const auto& o = model_.meshes()[mesh].origin;
    const std::array<double, 3> origin = {o[0], o[1], o[2]};
    const auto [place, is_new] = origin_places_.try_emplace(origin, origins_.size());
    if (is_new) origins_.push_back(origin);
    return place->second;
  }

  void add_surfaces(std::size_t node, std::size_t origin, const std::vector<std::size_t>& list) {
    Parts parts;
    for (const std::size_t i : list) {
      const pan::layout::Instance& instance = model_.instances()[i];
      const std::int32_t back = model_.back_of(static_cast<std::uint32_t>(i));
      parts.push_back(
          {instance.mesh, instance.material, instance.texture, back < 0 ? kBoth : kFront});
      if (back >= 0) parts.push_back({instance.mesh, back, -1, kBack});
    }
    const Vec3 at(origins_[origin][0], origins_[origin][1], origins_[origin][2]);
    if (at != Vec3(0)) {
      ordered_json below = {
          {"name", std::string(model_.mesh_name(static_cast<std::size_t>(parts[0][0])))},
          {"extras", {{"kind", "origin"}}}};
      place(below, at, Quat(1, 0, 0, 0), Vec3(1));
      node = add(std::move(below), node);
    }
    nodes_[node]["mesh"] = mesh_index(parts);
  }

  std::size_t mesh_index(const Parts& parts) {
    const auto [known, is_new] = meshes_.try_emplace(parts, meshes_.size());
    if (!is_new) return known->second;
    ordered_json mesh = {
        {"name", std::string(model_.mesh_name(static_cast<std::size_t>(parts[0][0])))},
        {"primitives", ordered_json::array()}};
    for (const auto& part : parts) {
      job_.poll();
      mesh["primitives"].push_back(primitive(part));
    }
    json_["meshes"].push_back(std::move(mesh));
    return known->second;
  }

  void add_points() {
    for (std::size_t i = 0; i < model_.frames().size(); ++i) {
      const pan::layout::Frame& frame = model_.frames()[i];
      ordered_json node = {{"name", std::string(model_.frame_name(i))},
                           {"extras", {{"kind", "frame"}}}};
      place(node, {frame.origin[0], frame.origin[1], frame.origin[2]},
            Quat(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]),
            Vec3(1));
      add(std::move(node), place_of_[frame.node]);
    }
    for (std::size_t i = 0; i < model_.keypoints().size(); ++i) {
      const pan::layout::Keypoint& point = model_.keypoints()[i];
      ordered_json node = {{"name", std::string(model_.keypoint_name(i))},
                           {"extras", {{"kind", "keypoint"}}}};
      place(node, {point.position[0], point.position[1], point.position[2]}, Quat(1, 0, 0, 0),
            Vec3(1));
      add(std::move(node), place_of_[point.node]);
    }
  }

  void finish_nodes() {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!children_[i].empty()) nodes_[i]["children"] = children_[i];
    json_["nodes"] = nodes_;
  }

  // ---- materials and textures

  void add_textures() {
    const std::vector<TexturePool::Packed> packed = materials_.textures().packed();
    for (std::size_t i = 0; i < packed.size(); ++i) {
      const std::size_t view = add_view(packed[i].png.data(), packed[i].png.size(), 0, 0);
      json_["images"].push_back(
          {{"name", packed[i].name}, {"mimeType", "image/png"}, {"bufferView", view}});
      json_["textures"].push_back({{"source", i}});
    }
  }

  void say_what_is_lost() {
    if (!model_.lamps().empty())
      log_.report_file(Code("W6402"), model_.name(),
                       fmt::format("glTF does not keep {}, whose light is not in candela",
                                   counted(model_.lamps().size(), "lamp")));
    if (!model_.scene().empty())
      log_.report_file(Code("W6402"), model_.name(),
                       "glTF does not keep the scene: Sun, planets and stars");
    for (const auto& [what, loss] : materials_.losses()) {
      const std::string others =
          loss.materials > 1 ? fmt::format(", the most of {} materials", loss.materials) : "";
      log_.report_file(Code("W6402"), model_.name(),
                       fmt::format("glTF does not keep {}: {} of the light of {} changes{}", what,
                                   percent(loss.share), in_quotes(loss.worst), others));
    }
    if (uncoupled_ > 0)
      log_.report_file(
          Code("W6402"), model_.name(),
          fmt::format(
              "glTF does not keep that {} others: they have values of their own",
              uncoupled_ == 1 ? "1 joint follows" : fmt::format("{} joints follow", uncoupled_)));
    if (!model_.joints().empty() && !options_.articulations)
      log_.report_file(Code("W6402"), model_.name(),
                       fmt::format("glTF does not keep {}: parts are placed by the joint values",
                                   counted(model_.joints().size(), "joint")));
    if (model_.decals().empty()) return;
    std::set<std::uint32_t> under;
    for (const pan::layout::Decal& decal : model_.decals()) under.insert(decal.instance);
    log_.report_file(
        Code("W6402"), model_.name(),
        fmt::format("glTF does not keep {} over {}", counted(model_.decals().size(), "decal"),
                    counted(under.size(), "surface")));
  }

  static std::string percent(double share) {
    return share < 0.0005 ? "under 0.1 %" : fmt::format("{:.2g} %", 100 * std::min(share, 2.0));
  }

  // ---- the file

  static void append_word(std::vector<std::byte>& out, std::uint64_t word) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(word >> (8 * i) & 255));
  }

  Result<std::vector<std::byte>> container() {
    job_.poll();
    binary_.resize((binary_.size() + 3) / 4 * 4);
    if (!binary_.empty()) json_["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string text = json_.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t size = 12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size());
    if (size > 0xffffffffu) {
      log_.report_file(Code("E6002"), model_.name(),
                       fmt::format("{} bytes are more than a GLB file can hold", size));
      return failed;
    }
    std::vector<std::byte> out;
    out.reserve(size);
    append_word(out, 0x46546c67);
    append_word(out, 2);
    append_word(out, size);
    append_word(out, text.size());
    append_word(out, 0x4e4f534a);
    for (const char c : text) out.push_back(static_cast<std::byte>(c));
    if (!binary_.empty()) {
      append_word(out, binary_.size());
      append_word(out, 0x004e4942);
      out.insert(out.end(), binary_.begin(), binary_.end());
    }
    return out;
  }

  const pan::Model& model_;
  DiagnosticLog& log_;
  const Job& job_;
  const GlbOptions options_;
  ordered_json json_;
  std::vector<ordered_json> articulations_;
  std::size_t uncoupled_ = 0;  // joints that followed others
  std::vector<ordered_json> nodes_;
  std::vector<std::vector<std::size_t>> children_;
  std::vector<std::size_t> place_of_;  // of the model's nodes
  std::vector<std::array<double, 3>> origins_;
  std::map<std::array<double, 3>, std::size_t> origin_places_;
  std::map<std::size_t, ordered_json> geometries_;
  std::map<std::size_t, ordered_json> turned_;
  std::map<Parts, std::size_t> meshes_;
  std::map<std::size_t, std::size_t> colors_;  // accessors of meshes
  MaterialWriter materials_;
  std::vector<std::byte> binary_;
};

}  // namespace

Result<std::vector<std::byte>> glb_from(const pan::Model& model, DiagnosticLog& log, const Job& job,
                                        const GlbOptions& options) {
  assert(model.checked());
  return run_job(job, log, [&] { return Exporter(model, log, job, options).run(); });
}

}  // namespace panwright::exporters
