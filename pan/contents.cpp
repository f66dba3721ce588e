// Whole models: rounding to float, numbering of strings, and the sections in their order.
#include <algorithm>
#include <cassert>
#include <limits>

#include "base/axis_box.h"
#include "pan/internal/identity.h"
#include "pan/internal/material_limits.h"
#include "pan/model.h"
#include "pan/writer.h"

namespace panwright::pan {

namespace {

using layout::SectionKind;

void store(double* to, const Vec3& v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

void store(double* to, const Quat& q) {
  to[0] = q.w;
  to[1] = q.x;
  to[2] = q.y;
  to[3] = q.z;
}

void store(float* to, const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

std::vector<float> rounded(const std::vector<Vec3>& values) {
  std::vector<float> out(3 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) store(&out[3 * i], values[i]);
  return out;
}

std::uint32_t index_size(const PackedMesh& mesh) {
  return mesh.vertex_count() <= layout::kMaxShortVertices ? 2 : 4;
}

std::uint64_t index_bytes(std::uint32_t size, std::size_t count) {
  const std::uint64_t bytes = std::uint64_t{size} * count;
  return (bytes + 3) / 4 * 4;
}

std::uint64_t index_bytes(const PackedMesh& mesh) {
  return index_bytes(index_size(mesh), mesh.indices.size());
}

// The tables of a model, ready to be written.
struct Tables {
  StringTable strings;
  std::vector<layout::Build> build;
  std::vector<layout::Input> inputs;
  std::vector<layout::Node> nodes;
  std::vector<layout::Mesh> meshes;
  std::vector<layout::Instance> instances;
  std::vector<layout::Material> materials;
  std::vector<layout::Texture> textures;
  std::vector<layout::Frame> frames;
  std::vector<layout::Source> sources;
  std::vector<layout::Budget> budget;
  std::vector<layout::Keypoint> keypoints;
  std::vector<layout::Decal> decals;
  std::vector<layout::Joint> joints;
  std::vector<layout::Back> backs;
};

void add_meshes(const std::vector<PackedMesh>& meshes, Tables& tables) {
  std::uint64_t vertices = 0, texcoords = 0, colors = 0, bytes = 0;
  for (const PackedMesh& mesh : meshes) {
    const std::size_t count = mesh.vertex_count();
    assert(mesh.triangle_count() > 0 && mesh.indices.size() % 3 == 0);
    assert(mesh.normals.size() == 3 * count && mesh.positions.size() == 3 * count);
    assert(mesh.texcoords.empty() || mesh.texcoords.size() == 2 * count);
    assert(mesh.colors.empty() || mesh.colors.size() == 3 * count);
    layout::Mesh record{};
    store(record.origin, mesh.origin);
    record.error = mesh.error;
    for (int k = 0; k < 3; ++k) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (std::size_t i = 0; i < count; ++i) {
        const float p = mesh.positions[3 * i + k];
        low = p < low ? p : low;
        high = p > high ? p : high;
      }
      record.bounds_min[k] = low;
      record.bounds_max[k] = high;
    }
    record.index_offset = bytes;
    record.first_vertex = static_cast<std::uint32_t>(vertices);
    record.vertex_count = static_cast<std::uint32_t>(count);
    record.triangle_count = static_cast<std::uint32_t>(mesh.triangle_count());
    record.index_size = index_size(mesh);
    record.name = tables.strings.id(mesh.name);
    if (mesh.closed) record.flags |= layout::kMeshClosed;
    if (!mesh.texcoords.empty()) {
      record.flags |= layout::kMeshTexcoords;
      record.first_texcoord = static_cast<std::uint32_t>(texcoords);
      texcoords += count;
    }
    if (!mesh.colors.empty()) {
      record.flags |= layout::kMeshColors;
      record.first_color = static_cast<std::uint32_t>(colors);
      colors += count;
    }
    vertices += count;
    bytes += index_bytes(mesh);
    assert(vertices <= 0xffffffffu);
    tables.meshes.push_back(record);
  }
}

void add_textures(const std::vector<TextureContent>& textures, Tables& tables) {
  std::uint64_t bytes = 0;
  for (const TextureContent& texture : textures) {
    layout::Texture record{};
    record.width = texture.width;
    record.height = texture.height;
    record.offset = bytes;
    record.bytes = texture.rgba.size();
    assert(record.bytes == std::uint64_t{4} * texture.width * texture.height);
    if (texture.linear) record.flags |= layout::kTextureLinear;
    record.name = tables.strings.id(texture.name);
    bytes += record.bytes;
    tables.textures.push_back(record);
  }
}

void add_truth(const Contents& contents, Tables& tables) {
  assert(contents.mesh_tolerances.empty() ||
         contents.mesh_tolerances.size() == contents.meshes.size());
  if (contents.budget) tables.budget.push_back(*contents.budget);
  for (const KeypointContent& point : contents.keypoints) {
    layout::Keypoint record{};
    store(record.position, point.position);
    record.node = point.node;
    record.name = tables.strings.id(point.name);
    tables.keypoints.push_back(record);
  }
  for (const DecalContent& decal : contents.decals) {
    layout::Decal record{};
    store(record.origin, decal.origin);
    store(record.rotation, decal.rotation);
    record.width = decal.width;
    record.height = decal.height;
    record.depth = decal.depth;
    record.instance = decal.instance;
    record.texture = decal.texture;
    record.name = tables.strings.id(decal.name);
    tables.decals.push_back(record);
  }
}

void add_joints(const std::vector<JointContent>& joints, Tables& tables) {
  for (const JointContent& content : joints) {
    const geometry::Joint& joint = content.joint;
    layout::Joint record{};
    store(record.axis, joint.axis);
    if (joint.limited) {
      record.flags |= layout::kJointLimited;
      std::ranges::copy(joint.lower, record.lower);
      std::ranges::copy(joint.upper, record.upper);
    }
    std::ranges::copy(content.value, record.value);
    record.multiplier = joint.multiplier;
    record.offset = joint.offset;
    if (content.pointing) store(record.pointing, *content.pointing);
    if (content.points_at_sun) record.flags |= layout::kJointPointsAtSun;
    record.node = content.node;
    record.kind = static_cast<std::uint32_t>(joint.kind);
    record.mimic = joint.mimic;
    record.gimbal = content.gimbal;
    record.name = tables.strings.id(content.name);
    tables.joints.push_back(record);
  }
}

Tables tables_of(const Contents& contents) {
  Tables tables;
  StringTable& strings = tables.strings;
  tables.build.push_back({strings.id(contents.version), strings.id(contents.options), {}});
  for (const InputContent& input : contents.inputs) {
    assert(input.path.size() <= layout::kMaxPathBytes);
    tables.inputs.push_back(
        {{input.hash.low, input.hash.high}, input.bytes, strings.id(input.path), 0});
  }
  for (const NodeContent& node : contents.nodes) {
    layout::Node record{};
    store(record.translation, node.translation);
    store(record.rotation, node.rotation);
    store(record.scale, node.scale);
    record.parent = node.parent;
    record.name = strings.id(node.name);
    tables.nodes.push_back(record);
  }
  add_meshes(contents.meshes, tables);
  for (const InstanceContent& instance : contents.instances) {
    if (instance.back >= 0)
      tables.backs.push_back({static_cast<std::uint32_t>(tables.instances.size()),
                              static_cast<std::uint32_t>(instance.back)});
    tables.instances.push_back({instance.node, instance.mesh, instance.material, instance.texture});
  }
  const std::vector<std::uint32_t> variants = materials::variants_of(contents.materials);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const materials::Material& material = contents.materials[i];
    tables.materials.push_back(record_from(material, strings.id(material.name)));
    tables.materials.back().variant = variants[i];
  }
  add_textures(contents.textures, tables);
  for (const FrameContent& frame : contents.frames) {
    layout::Frame record{};
    store(record.origin, frame.origin);
    store(record.rotation, frame.rotation);
    record.node = frame.node;
    record.name = strings.id(frame.name);
    tables.frames.push_back(record);
  }
  assert(contents.sources.empty() || contents.sources.size() == contents.instances.size());
  for (const SourceContent& source : contents.sources)
    tables.sources.push_back({strings.id(source.file), source.line, source.column, 0});
  add_truth(contents, tables);
  add_joints(contents.joints, tables);
  return tables;
}

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// What is written, and where its memory may be given back on the way.
struct Writing {
  const Contents& contents;
  Contents* owned = nullptr;  // the same; null: it stays whole

  template <class T>
  void done(std::size_t mesh, std::vector<T> PackedMesh::*array) const {
    if (owned != nullptr) std::vector<T>().swap(owned->meshes[mesh].*array);
  }
};

// One array of every mesh in turn.
bool write_array(const Writing& writing, std::vector<float> PackedMesh::*array, SectionKind kind,
                 Writer& writer, DiagnosticLog& log, const Job& job) {
  job.poll();
  const auto value = static_cast<std::uint32_t>(kind);
  if (!writer.begin(value, layout::kSections[value - 1].stride, false, log)) return false;
  for (std::size_t i = 0; i < writing.contents.meshes.size(); ++i) {
    if (!writer.append(bytes_of(writing.contents.meshes[i].*array), log)) return false;
    writing.done(i, array);
  }
  return writer.end(log);
}

// note: positions, which say how large an index is, may be gone
bool write_indices(const Writing& writing, const Tables& tables, Writer& writer, DiagnosticLog& log,
                   const Job& job) {
  job.poll();
  if (!writer.begin(static_cast<std::uint32_t>(SectionKind::indices), 1, false, log)) return false;
  std::vector<std::uint16_t> shorts;
  for (std::size_t i = 0; i < writing.contents.meshes.size(); ++i) {
    const std::vector<std::uint32_t>& indices = writing.contents.meshes[i].indices;
    if (tables.meshes[i].index_size == 4) {
      if (!writer.append(bytes_of(indices), log)) return false;
    } else {
      shorts.assign(indices.begin(), indices.end());
      shorts.resize(index_bytes(2, indices.size()) / 2);
      if (!writer.append(bytes_of(shorts), log)) return false;
    }
    writing.done(i, &PackedMesh::indices);
  }
  return writer.end(log);
}

// The streams of meshes, and the sections that are made from them.
bool write_streams(const Writing& writing, Writer& writer, DiagnosticLog& log, const Job& job) {
  job.poll();
  const Contents& contents = writing.contents;
  std::vector<layout::MeshStream> records;
  std::uint64_t length = 0, vertices = 0, indices = 0;
  for (const PackedMesh& mesh : contents.meshes) {
    assert(mesh.stream.length == mesh.stream_bytes.size() && mesh.stream.length > 0);
    records.push_back(mesh.stream);
    records.back().offset = length;
    length += mesh.stream.length;
    vertices += mesh.vertex_count();
    indices += index_bytes(mesh);
  }
  for (std::size_t i = 0; i < contents.meshes.size(); ++i) {
    writing.done(i, &PackedMesh::positions);
    writing.done(i, &PackedMesh::normals);
    writing.done(i, &PackedMesh::indices);
  }
  const auto bytes = static_cast<std::uint32_t>(SectionKind::stream_bytes);
  if (!writer.section(SectionKind::mesh_streams, bytes_of(records), log) ||
      !writer.begin(bytes, 1, true, log))
    return false;
  for (std::size_t i = 0; i < contents.meshes.size(); ++i) {
    if (!writer.append(contents.meshes[i].stream_bytes, log)) return false;
    writing.done(i, &PackedMesh::stream_bytes);
  }
  return writer.end(log) && writer.derived(SectionKind::positions, vertices, log) &&
         writer.derived(SectionKind::normals, vertices, log) &&
         writer.derived(SectionKind::indices, indices, log);
}

// Positions, normals and indices, then texcoords and colours.
bool write_meshes(const Writing& writing, const Tables& tables, Writer& writer, DiagnosticLog& log,
                  const Job& job) {
  const std::vector<PackedMesh>& meshes = writing.contents.meshes;
  const bool streams = !meshes.empty() && !meshes.front().stream_bytes.empty();
  if (streams) {
    if (!write_streams(writing, writer, log, job)) return false;
  } else if (!write_array(writing, &PackedMesh::positions, SectionKind::positions, writer, log,
                          job) ||
             !write_array(writing, &PackedMesh::normals, SectionKind::normals, writer, log, job)) {
    return false;
  }
  return write_array(writing, &PackedMesh::texcoords, SectionKind::texcoords, writer, log, job) &&
         write_array(writing, &PackedMesh::colors, SectionKind::colors, writer, log, job) &&
         (streams || write_indices(writing, tables, writer, log, job));
}

bool write_texels(const Contents& contents, Writer& writer, DiagnosticLog& log, const Job& job) {
  job.poll();
  if (!writer.begin(static_cast<std::uint32_t>(SectionKind::texels), 1, false, log)) return false;
  for (const TextureContent& texture : contents.textures)
    if (!writer.append(std::as_bytes(texture.rgba), log)) return false;
  return writer.end(log);
}

// Whether a joint moves what is at its node from the beginning: by itself, or as it follows
// another.
bool begins_elsewhere(const JointContent& joint) {
  return joint.joint.mimic >= 0 || joint.value != geometry::rest_values(joint.joint.kind);
}

bool write_sections(const Writing& writing, Writer& writer, DiagnosticLog& log,
                    double* sync_seconds, const Job& job) {
  const Contents& contents = writing.contents;
  assert(!contents.nodes.empty());
  const Tables tables = tables_of(contents);
  for (const layout::Material& material : tables.materials) writer.require(features_of(material));
  if (std::ranges::any_of(contents.joints, begins_elsewhere))
    writer.require(layout::kFeatureJointValues);
  if (!tables.backs.empty()) writer.require(layout::kFeatureBacks);
  const auto strings = tables.strings.bytes();
  const bool sections =
      writer.section(SectionKind::build, bytes_of(tables.build), log) &&
      writer.section(SectionKind::inputs, bytes_of(tables.inputs), log) &&
      writer.section(SectionKind::nodes, bytes_of(tables.nodes), log) &&
      writer.section(SectionKind::meshes, bytes_of(tables.meshes), log) &&
      writer.section(SectionKind::instances, bytes_of(tables.instances), log) &&
      writer.section(SectionKind::materials, bytes_of(tables.materials), log) &&
      writer.section(SectionKind::textures, bytes_of(tables.textures), log) &&
      writer.section(SectionKind::frames, bytes_of(tables.frames), log) &&
      (tables.sources.empty() ||
       writer.section(SectionKind::sources, bytes_of(tables.sources), log)) &&
      writer.section(SectionKind::string_offsets, std::as_bytes(tables.strings.offsets()), log) &&
      writer.section(SectionKind::string_bytes, std::as_bytes(std::span(strings)), log) &&
      write_meshes(writing, tables, writer, log, job) && write_texels(contents, writer, log, job) &&
      writer.section(SectionKind::budget, bytes_of(tables.budget), log) &&
      writer.section(SectionKind::mesh_tolerances, bytes_of(contents.mesh_tolerances), log) &&
      writer.section(SectionKind::keypoints, bytes_of(tables.keypoints), log) &&
      writer.section(SectionKind::decals, bytes_of(tables.decals), log) &&
      (contents.sheets.empty() ||
       writer.section(SectionKind::sheets, bytes_of(contents.sheets), log)) &&
      (contents.levels.empty() ||
       writer.section(SectionKind::levels, bytes_of(contents.levels), log)) &&
      (tables.joints.empty() ||
       writer.section(SectionKind::joints, bytes_of(tables.joints), log)) &&
      (tables.backs.empty() || writer.section(SectionKind::backs, bytes_of(tables.backs), log));
  job.poll();
  return sections &&
         writer.finish(build_identity(contents.inputs, contents.version, contents.options), log,
                       sync_seconds, &job);
}

}  // namespace

namespace {

// owned: the same mesh, of which each array is freed once it is rounded; null: it stays whole
PackedMesh packed_from(const geometry::Mesh& mesh, geometry::Mesh* owned, std::string name) {
  assert(!mesh.triangles.empty() && mesh.normals.size() == mesh.positions.size());
  const auto done = [&](auto member) {
    if (owned != nullptr) std::remove_cvref_t<decltype(owned->*member)>().swap(owned->*member);
  };
  PackedMesh out;
  out.name = std::move(name);
  out.closed = mesh.closed;
  AxisBox box;
  for (const Vec3& p : mesh.positions) box.add(p);
  out.origin = box.centre();
  double worst = 0;
  out.positions.resize(3 * mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    float* to = &out.positions[3 * i];
    store(to, mesh.positions[i] - out.origin);
    const Vec3 stored = out.origin + Vec3(to[0], to[1], to[2]);
    const double moved = glm::length(stored - mesh.positions[i]);
    worst = moved > worst ? moved : worst;
  }
  done(&geometry::Mesh::positions);
  out.error = mesh.error + worst;
  out.normals = rounded(mesh.normals);
  done(&geometry::Mesh::normals);
  out.colors = rounded(mesh.colors);
  out.texcoords.reserve(2 * mesh.texcoords.size());
  for (const Vec2& t : mesh.texcoords) {
    out.texcoords.push_back(static_cast<float>(t.x));
    out.texcoords.push_back(static_cast<float>(t.y));
  }
  out.indices.reserve(3 * mesh.triangles.size());
  for (const geometry::Triangle& triangle : mesh.triangles)
    out.indices.insert(out.indices.end(), triangle.begin(), triangle.end());
  return out;
}

}  // namespace

PackedMesh packed(const geometry::Mesh& mesh, std::string name) {
  return packed_from(mesh, nullptr, std::move(name));
}

PackedMesh packed(geometry::Mesh&& mesh, std::string name) {
  return packed_from(mesh, &mesh, std::move(name));
}

Hash128 build_identity(std::span<const InputContent> inputs, std::string_view version,
                       std::string_view options) {
  internal::IdentityHasher hasher;
  for (const InputContent& input : inputs) hasher.input(input.hash, input.bytes, input.path);
  return hasher.finish(version, options);
}

namespace {

// Bytes of the largest sections, as they are without compression.
std::size_t expected_bytes(const Contents& contents) {
  std::size_t sum = 0;
  for (const PackedMesh& mesh : contents.meshes)
    sum += mesh.stream_bytes.size() +
           sizeof(float) * (mesh.texcoords.size() + mesh.colors.size() + mesh.positions.size() +
                            mesh.normals.size()) +
           (mesh.vertex_count() > layout::kMaxShortVertices ? 4 : 2) * mesh.indices.size();
  for (const TextureContent& texture : contents.textures) sum += texture.rgba.size();
  return sum;
}

std::vector<std::byte> in_memory(const Writing& writing, const WriteOptions& options) {
  // a vector that grows is there twice
  Writer writer =
      Writer::in_memory(options, options.compress ? 0 : expected_bytes(writing.contents));
  DiagnosticLog unused;
  [[maybe_unused]] const bool done = write_sections(writing, writer, unused, nullptr, {});
  assert(done);
  return std::move(writer).take();
}

Result<WriteReport> write_to(const std::filesystem::path& path, const Writing& writing,
                             DiagnosticLog& log, const WriteOptions& options, const Job& job) {
  WriteReport report;
  if (path == "-") {
    const std::vector<std::byte> bytes = write_to_memory(writing.contents, options);
    report.bytes = bytes.size();
    auto model = Model::from_bytes(bytes, "-", log);
    if (!model || !model->check(log, job) || !write_file(path, bytes, log)) return failed;
    return report;
  }
  return run_job(job, log, [&]() -> Result<WriteReport> {
    auto writer = Writer::create(path, log, options);
    if (!writer || !write_sections(writing, *writer, log, &report.seconds_sync, job)) return failed;
    report.bytes = writer->bytes();
    return report;
  });
}

}  // namespace

Result<WriteReport> write(const Contents& contents, const std::filesystem::path& path,
                          DiagnosticLog& log, const WriteOptions& options, const Job& job) {
  return write_to(path, {contents}, log, options, job);
}

Result<WriteReport> write(Contents&& contents, const std::filesystem::path& path,
                          DiagnosticLog& log, const WriteOptions& options, const Job& job) {
  return write_to(path, {contents, &contents}, log, options, job);
}

std::vector<std::byte> write_to_memory(const Contents& contents, const WriteOptions& options) {
  return in_memory({contents}, options);
}

std::vector<std::byte> write_to_memory(Contents&& contents, const WriteOptions& options) {
  return in_memory({contents, &contents}, options);
}

}  // namespace panwright::pan
