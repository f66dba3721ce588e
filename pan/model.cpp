#include "pan/model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pan/internal/report.h"

namespace panwright::pan {

using layout::SectionKind;

const layout::Header& Model::header() const {
  return *reinterpret_cast<const layout::Header*>(bytes_.data());
}

std::span<const layout::DirectoryEntry> Model::directory() const {
  const std::byte* first = bytes_.data() + header().directory_offset;
  return {reinterpret_cast<const layout::DirectoryEntry*>(first), header().section_count};
}

const layout::DirectoryEntry* Model::entry(SectionKind kind) const {
  const std::uint32_t number = entry_of_kind_[static_cast<std::uint32_t>(kind)];
  return number == 0 ? nullptr : &directory()[number - 1];
}

bool Model::reads(const layout::DirectoryEntry& entry) const {
  return internal::known(entry.kind) && this->entry(SectionKind{entry.kind}) == &entry;
}

bool Model::compressed() const {
  for (const layout::DirectoryEntry& entry : directory())
    if (internal::has_codec(entry)) return true;
  return false;
}

Hash128 Model::build_id() const { return {header().build_id[0], header().build_id[1]}; }

std::int32_t Model::back_of(std::uint32_t instance) const {
  const std::span<const layout::Back> all = backs();
  const auto found = std::ranges::lower_bound(all, instance, {}, &layout::Back::instance);
  if (found == all.end() || found->instance != instance) return -1;
  return static_cast<std::int32_t>(found->material);
}
std::span<const layout::Level> Model::levels(std::uint32_t instance) const {
  const std::span<const layout::Level> all = levels();
  const auto before = [](const layout::Level& level, std::uint32_t value) {
    return level.instance < value;
  };
  const auto first = std::lower_bound(all.begin(), all.end(), instance, before);
  const auto last = std::lower_bound(first, all.end(), instance + 1, before);
  return {first, last};
}
std::span<const std::byte> Model::stream_bytes() const {
  return section(SectionKind::stream_bytes);
}

std::span<const layout::Float3> Model::positions() const {
  return array<layout::Float3>(SectionKind::positions);
}
std::span<const layout::Float3> Model::normals() const {
  return array<layout::Float3>(SectionKind::normals);
}
std::span<const layout::Float2> Model::texcoords() const {
  return array<layout::Float2>(SectionKind::texcoords);
}
std::span<const layout::Float3> Model::colors() const {
  return array<layout::Float3>(SectionKind::colors);
}
std::span<const std::byte> Model::index_bytes() const { return section(SectionKind::indices); }
std::span<const std::byte> Model::texel_bytes() const { return section(SectionKind::texels); }
std::span<const std::uint32_t> Model::string_offsets() const {
  return array<std::uint32_t>(SectionKind::string_offsets);
}
std::span<const char> Model::string_bytes() const { return array<char>(SectionKind::string_bytes); }

void Model::find_places() {
  places_.clear();
  if (!(header().required_features & layout::kFeatureLongRuns)) return;
  Places next{};
  for (const layout::Mesh& mesh : meshes()) {
    places_.push_back({next.vertex, mesh.flags & layout::kMeshTexcoords ? next.texcoord : 0,
                       mesh.flags & layout::kMeshColors ? next.color : 0});
    next.vertex += mesh.vertex_count;
    if (mesh.flags & layout::kMeshTexcoords) next.texcoord += mesh.vertex_count;
    if (mesh.flags & layout::kMeshColors) next.color += mesh.vertex_count;
  }
}

std::uint64_t Model::first_vertex(std::size_t mesh) const {
  return places_.empty() ? meshes()[mesh].first_vertex : places_[mesh].vertex;
}
std::uint64_t Model::first_texcoord(std::size_t mesh) const {
  return places_.empty() ? meshes()[mesh].first_texcoord : places_[mesh].texcoord;
}
std::uint64_t Model::first_color(std::size_t mesh) const {
  return places_.empty() ? meshes()[mesh].first_color : places_[mesh].color;
}

void Model::release(std::span<const std::byte> part) const {
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 30;
  if (mapped_ && bytes_.size() > kLarge) mapped_->release(part);
}

MeshView Model::mesh(std::size_t index) const {
  assert(checked_ && index < meshes().size());
  const layout::Mesh& record = meshes()[index];
  MeshView view;
  view.positions = positions().subspan(first_vertex(index), record.vertex_count);
  view.normals = normals().subspan(first_vertex(index), record.vertex_count);
  if (record.flags & layout::kMeshTexcoords)
    view.texcoords = texcoords().subspan(first_texcoord(index), record.vertex_count);
  if (record.flags & layout::kMeshColors)
    view.colors = colors().subspan(first_color(index), record.vertex_count);
  const std::byte* run = index_bytes().data() + record.index_offset;
  const std::size_t count = std::size_t{3} * record.triangle_count;
  if (record.index_size == 2)
    view.indices.shorts = {reinterpret_cast<const std::uint16_t*>(run), count};
  else
    view.indices.longs = {reinterpret_cast<const std::uint32_t*>(run), count};
  return view;
}

std::span<const std::uint8_t> Model::texels(std::size_t texture) const {
  assert(checked_ && texture < textures().size());
  const layout::Texture& record = textures()[texture];
  const auto bytes = texel_bytes().subspan(record.offset, record.bytes);
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

std::optional<std::size_t> Model::find_frame(std::string_view name) const {
  for (std::size_t i = 0; i < frames().size(); ++i)
    if (frame_name(i) == name) return i;
  return {};
}

std::string_view Model::version() const { return string(builds().front().version); }
std::string_view Model::options() const { return string(builds().front().options); }

std::string Model::node_path(std::size_t index) const {
  assert(checked_ && index < nodes().size());
  std::vector<std::string> parts;
  for (auto i = static_cast<std::int64_t>(index); i >= 0; i = nodes()[i].parent) {
    const std::string_view name = node_name(i);
    parts.push_back(name.empty() ? fmt::format("[{}]", i) : std::string(name));
  }
  std::string path = parts.back();
  for (std::size_t i = parts.size() - 1; i-- > 0;) path += '/' + parts[i];
  return path;
}

std::optional<std::size_t> Model::find_joint(std::string_view name) const {
  for (std::size_t i = 0; i < joints().size(); ++i)
    if (joint_name(i) == name) return i;
  return std::nullopt;
}

geometry::JointSet Model::joint_set() const {
  std::vector<geometry::Joint> all;
  for (const layout::Joint& joint : joints()) all.push_back(kinematic(joint));
  auto set = geometry::JointSet::of(std::move(all));
  assert(set);
  return set ? *std::move(set) : geometry::JointSet();
}

std::vector<geometry::JointValues> Model::initial_values() const {
  std::vector<geometry::JointValues> values(joints().size());
  for (std::size_t i = 0; i < values.size(); ++i)
    std::copy_n(joints()[i].value, geometry::kMaxJointValues, values[i].begin());
  if (!values.empty()) joint_set().resolve(values);
  return values;
}

std::vector<Mat4> Model::world_from_nodes() const {
  std::vector<Mat4> world(nodes().size());
  const auto values = initial_values();
  std::size_t joint = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const layout::Node& node = nodes()[i];
    assert(node.parent < static_cast<std::int64_t>(i));
    world[i] = parent_from_node(node);
    for (; joint < values.size() && joints()[joint].node == i; ++joint)
      world[i] = world[i] * geometry::motion(kinematic(joints()[joint]), values[joint]);
    if (node.parent >= 0) world[i] = world[node.parent] * world[i];
  }
  return world;
}

Mat4 Model::world_from_frame(std::size_t index) const {
  assert(checked_ && index < frames().size());
  const layout::Frame& frame = frames()[index];
  return world_from_nodes()[frame.node] * node_from_frame(frame);
}

std::optional<AxisBox> Model::world_bounds() const {
  assert(checked_);
  if (instances().empty()) return {};
  const std::vector<Mat4> world = world_from_nodes();
  AxisBox bounds;
  for (const layout::Instance& instance : instances()) {
    const layout::Mesh& record = meshes()[instance.mesh];
    const Vec3 origin(record.origin[0], record.origin[1], record.origin[2]);
    const Mat4& matrix = world[instance.node];
    const auto points = mesh(instance.mesh).positions;
    for (const layout::Float3& p : points)
      bounds.add(Vec3(matrix * Vec4(origin + Vec3(p.x, p.y, p.z), 1.0)));
    release(std::as_bytes(points));
  }
  return bounds;
}

namespace {

Vec3 vector3(const double* v) { return {v[0], v[1], v[2]}; }
Quat quat(const double* q) { return {q[0], q[1], q[2], q[3]}; }

}  // namespace

geometry::Joint kinematic(const layout::Joint& joint) {
  geometry::Joint out;
  out.kind = static_cast<geometry::JointKind>(joint.kind);
  out.axis = vector3(joint.axis);
  out.limited = (joint.flags & layout::kJointLimited) != 0;
  std::copy_n(joint.lower, geometry::kMaxJointValues, out.lower.begin());
  std::copy_n(joint.upper, geometry::kMaxJointValues, out.upper.begin());
  out.mimic = joint.mimic;
  out.multiplier = joint.multiplier;
  out.offset = joint.offset;
  return out;
}

Mat4 parent_from_node(const layout::Node& node) {
  return matrix_from_trs(vector3(node.translation), quat(node.rotation), vector3(node.scale));
}

Mat4 node_from_frame(const layout::Frame& frame) {
  return matrix_from_trs(vector3(frame.origin), quat(frame.rotation), Vec3(1));
}

std::string kind_name(std::uint32_t kind) {
  if (internal::known(kind)) return layout::kSections[layout::place_of(kind)].name;
  for (const layout::ReservedKind& reserved : layout::kReservedKinds)
    if (kind == reserved.value) return reserved.name;
  return fmt::format("kind {}", kind);
}

std::string_view reason_name(layout::ToleranceReason reason) {
  assert(static_cast<std::size_t>(reason) < std::size(layout::kToleranceReasonNames));
  return layout::kToleranceReasonNames[static_cast<std::size_t>(reason)];
}

Mat4 mesh_from_decal(const layout::Decal& decal) {
  return matrix_from_trs(vector3(decal.origin), quat(decal.rotation), Vec3(1));
}

}  // namespace panwright::pan
