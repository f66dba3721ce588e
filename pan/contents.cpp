// Whole models: rounding to float, numbering of strings, and the sections in their order.
#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>
#include <utility>

#include "base/text.h"
#include "pan/internal/identity.h"
#include "pan/internal/material_limits.h"
#include "pan/internal/table_records.h"
#include "pan/model.h"
#include "pan/writer.h"

namespace panwright::pan {

namespace {

using layout::SectionKind;

using internal::append;
using internal::store;

std::uint32_t index_size(std::uint64_t vertices) {
  return vertices <= layout::kMaxShortVertices ? 2 : 4;
}
std::uint32_t index_size(const PackedMesh& mesh) { return index_size(mesh.vertex_count()); }

std::uint64_t index_bytes(std::uint32_t size, std::uint64_t count) {
  const std::uint64_t bytes = std::uint64_t{size} * count;
  return (bytes + 3) / 4 * 4;
}

std::uint64_t index_bytes(const PackedMesh& mesh) {
  return index_bytes(index_size(mesh), mesh.indices.size());
}

// Lengths of the arrays of all meshes so far: where the runs of the next one begin.
struct Runs {
  std::uint64_t vertices = 0, texcoords = 0, colors = 0, index_bytes = 0;

  void add(std::uint64_t count, std::uint64_t indices, bool has_texcoords, bool has_colors) {
    vertices += count;
    texcoords += has_texcoords ? count : 0;
    colors += has_colors ? count : 0;
    index_bytes += pan::index_bytes(index_size(count), indices);
  }
};

// The tables of a model, ready to be written.
struct Tables {
  StringTable strings{};
  std::vector<layout::Mesh> meshes;
  Runs runs;
  std::string beyond;                                     // what the format cannot hold
  std::vector<std::byte> records[layout::kLastKind + 1];  // of the others, by kind
  std::uint64_t features = 0;                             // that readers need for them

  std::vector<std::byte>& of(SectionKind kind) { return records[static_cast<std::size_t>(kind)]; }
  std::span<const std::byte> bytes(SectionKind kind) const {
    if (kind == SectionKind::meshes) return std::as_bytes(std::span(meshes));
    return records[static_cast<std::size_t>(kind)];
  }
};

bool fits_32_bits(std::uint64_t count) { return count <= 0xffffffffu; }

// Texts of a mesh that the format cannot hold; nothing: it can.
std::optional<std::string> beyond(std::size_t i, std::uint64_t vertices, std::uint64_t triangles) {
  if (fits_32_bits(vertices) && fits_32_bits(triangles)) return {};
  return fmt::format("mesh {} has {} vertices and {} triangles, expected at most {} of each", i,
                     vertices, triangles, 0xffffffffu);
}

void set_bounds(const PackedMesh& mesh, layout::Mesh& record) {
  for (int k = 0; k < 3; ++k) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (std::size_t i = k; i < mesh.positions.size(); i += 3) {
      const float p = mesh.positions[i];
      low = p < low ? p : low;
      high = p > high ? p : high;
    }
    record.bounds_min[k] = low;
    record.bounds_max[k] = high;
  }
}

void add_mesh(const PackedMesh& mesh, Tables& tables) {
  const std::size_t count = mesh.vertex_count();
  assert(mesh.triangle_count() > 0 && mesh.indices.size() % 3 == 0);
  assert(mesh.normals.size() == 3 * count && mesh.positions.size() == 3 * count);
  assert(mesh.texcoords.empty() || mesh.texcoords.size() == 2 * count);
  assert(mesh.colors.empty() || mesh.colors.size() == 3 * count);
  if (tables.beyond.empty())
    tables.beyond =
        beyond(tables.meshes.size(), count, mesh.triangle_count()).value_or(std::string());
  layout::Mesh record{};
  store(record.origin, mesh.origin);
  record.error = mesh.error;
  set_bounds(mesh, record);
  Runs& runs = tables.runs;
  if (!fits_32_bits(std::max({runs.vertices, runs.texcoords, runs.colors})))
    tables.features |= layout::kFeatureLongRuns;
  record.index_offset = runs.index_bytes;
  record.first_vertex = static_cast<std::uint32_t>(runs.vertices);
  record.vertex_count = static_cast<std::uint32_t>(count);
  record.triangle_count = static_cast<std::uint32_t>(mesh.triangle_count());
  record.index_size = index_size(mesh);
  record.name = tables.strings.id(mesh.name);
  if (mesh.closed) record.flags |= layout::kMeshClosed;
  if (!mesh.texcoords.empty()) {
    record.flags |= layout::kMeshTexcoords;
    record.first_texcoord = static_cast<std::uint32_t>(runs.texcoords);
  }
  if (!mesh.colors.empty()) {
    record.flags |= layout::kMeshColors;
    record.first_color = static_cast<std::uint32_t>(runs.colors);
  }
  runs.add(count, mesh.indices.size(), !mesh.texcoords.empty(), !mesh.colors.empty());
  tables.meshes.push_back(record);
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
    append(tables.of(SectionKind::textures), record);
  }
}

void add_instances(const std::vector<InstanceContent>& instances, Tables& tables) {
  std::uint32_t index = 0;
  for (const InstanceContent& instance : instances) {
    append(tables.of(SectionKind::instances),
           layout::Instance{instance.node, instance.mesh, instance.material, instance.texture});
    if (instance.back >= 0)
      append(tables.of(SectionKind::backs),
             layout::Back{index, static_cast<std::uint32_t>(instance.back)});
    ++index;
  }
  if (!tables.of(SectionKind::backs).empty()) tables.features |= layout::kFeatureBacks;
}

void add_materials(const std::vector<materials::Material>& all, Tables& tables) {
  const std::vector<std::uint32_t> variants = materials::variants_of(all);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    layout::Material record = record_from(all[i], tables.strings.id(all[i].name));
    record.variant = variants[i];
    tables.features |= features_of(record);
    append(tables.of(SectionKind::materials), record);
  }
}

// Whether a joint moves what is at its node from the beginning: by itself, or as it follows
// another.
bool begins_elsewhere(const JointContent& joint) {
  return joint.joint.mimic >= 0 || joint.value != geometry::rest_values(joint.joint.kind);
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
    append(tables.of(SectionKind::joints), record);
    if (begins_elsewhere(content)) tables.features |= layout::kFeatureJointValues;
  }
}

// Whether a reader that knows neither lamps nor scenes would light the model otherwise.
bool is_lit(const Contents& contents) {
  return !contents.scene.empty() ||
         std::ranges::any_of(contents.lamps, [](const LampContent& lamp) {
           return (lamp.flags & layout::kLampOff) == 0;
         });
}

// meshes: the tables of those that have been made already.
//
// note: strings get their numbers in the order of the sections
Tables tables_of(const Contents& contents, Tables meshes = {}) {
  Tables tables = std::move(meshes);
  assert(contents.sources.empty() || contents.sources.size() == contents.instances.size());
  StringTable& strings = tables.strings;
  for (const layout::SectionInfo& info : layout::kSections) {
    if (info.kind == SectionKind::build)
      append(tables.of(info.kind),
             layout::Build{strings.id(contents.version), strings.id(contents.options), {}});
    else if (info.kind == SectionKind::meshes)
      for (const PackedMesh& mesh : contents.meshes) add_mesh(mesh, tables);
    else if (info.kind == SectionKind::instances)
      add_instances(contents.instances, tables);
    else if (info.kind == SectionKind::materials)
      add_materials(contents.materials, tables);
    else if (info.kind == SectionKind::textures)
      add_textures(contents.textures, tables);
    else if (info.kind == SectionKind::joints)
      add_joints(contents.joints, tables);
    else
      internal::add_records(contents, info.kind, strings, tables.of(info.kind));
    const std::uint64_t count = tables.bytes(info.kind).size() / info.stride;
    if (tables.beyond.empty() && !fits_32_bits(count))
      tables.beyond = fmt::format("section '{}' would have {} records, expected at most {}",
                                  info.name, count, 0xffffffffu);
  }
  if (is_lit(contents)) tables.features |= layout::kFeatureLights;
  assert(contents.mesh_tolerances.empty() ||
         contents.mesh_tolerances.size() == tables.meshes.size());
  if (tables.beyond.empty() && strings.full())
    tables.beyond = fmt::format("names would take more than {} bytes", 0xffffffffu);
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
  if (!writer.begin(value, layout::kSections[layout::place_of(value)].stride, false, log))
    return false;
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

bool write_section(const Writing& writing, const Tables& tables, const layout::SectionInfo& info,
                   Writer& writer, DiagnosticLog& log, const Job& job) {
  switch (info.kind) {
    case SectionKind::string_offsets:
      return writer.section(info.kind, std::as_bytes(tables.strings.offsets()), log);
    case SectionKind::string_bytes:
      return writer.section(info.kind, as_bytes(tables.strings.bytes()), log);
    case SectionKind::positions:
      return write_meshes(writing, tables, writer, log, job);
    case SectionKind::normals:
    case SectionKind::texcoords:
    case SectionKind::colors:
    case SectionKind::indices:
    case SectionKind::mesh_streams:
    case SectionKind::stream_bytes:
      return true;  // with the positions
    case SectionKind::texels:
      return write_texels(writing.contents, writer, log, job);
    default:
      break;
  }
  const auto bytes = tables.bytes(info.kind);
  return (info.optional && bytes.empty()) || writer.section(info.kind, bytes, log);
}

bool is_beyond(const Tables& tables, const std::string& path, DiagnosticLog& log) {
  if (!tables.beyond.empty()) log.report_file(Code("E0103"), path, tables.beyond);
  return !tables.beyond.empty();
}

bool write_sections(const Writing& writing, Writer& writer, const std::string& path,
                    DiagnosticLog& log, double* sync_seconds, const Job& job) {
  const Contents& contents = writing.contents;
  assert(!contents.nodes.empty());
  const Tables tables = tables_of(contents);
  if (is_beyond(tables, path, log)) return false;
  writer.require(tables.features);
  for (const layout::SectionInfo& info : layout::kSections)
    if (!write_section(writing, tables, info, writer, log, job)) return false;
  job.poll();
  return writer.finish(build_identity(contents.inputs, contents.version, contents.options), log,
                       sync_seconds, &job);
}

}  // namespace

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
  [[maybe_unused]] const bool done = write_sections(writing, writer, "", unused, nullptr, {});
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
    if (!writer || !write_sections(writing, *writer, path.string(), log, &report.seconds_sync, job))
      return failed;
    report.bytes = writer->bytes();
    return report;
  });
}

std::string shape_words(const MeshProducer::Shape& shape) {
  return fmt::format(
      "{} {}, {}, {} and {}", shape.vertices, shape.vertices == 1 ? "vertex" : "vertices",
      counted(shape.triangles, "triangle"), shape.texcoords ? "texcoords" : "no texcoords",
      shape.colors ? "colours" : "no colours");
}

// What is wrong with a mesh: another shape than announced, or arrays that do not fit one another.
std::optional<std::string> misshapen(const PackedMesh& mesh, const MeshProducer::Shape& shape,
                                     std::size_t i) {
  const std::uint64_t v = mesh.vertex_count(), t = mesh.triangle_count();
  const std::string made = shape_words({v, t, !mesh.texcoords.empty(), !mesh.colors.empty()});
  const std::string announced = shape_words(shape);
  if (made != announced)
    return fmt::format("mesh {} has {}, but was announced with {}", i, made, announced);
  if (mesh.positions.size() != 3 * v || mesh.normals.size() != 3 * v ||
      mesh.indices.size() != 3 * t || (shape.texcoords && mesh.texcoords.size() != 2 * v) ||
      (shape.colors && mesh.colors.size() != 3 * v))
    return fmt::format("mesh {} has arrays of different lengths", i);
  return {};
}

// Lengths of all arrays; nothing, once reported, where the format does not hold them.
std::optional<Runs> announced(const MeshProducer& producer, const std::string& path,
                              DiagnosticLog& log) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 52;  // bytes
  Runs runs;
  for (std::size_t i = 0; i < producer.shapes.size(); ++i) {
    const MeshProducer::Shape& shape = producer.shapes[i];
    auto problem = beyond(i, shape.vertices, shape.triangles);
    if (!problem && (shape.vertices < 3 || shape.triangles < 1))
      problem = fmt::format("mesh {} has {} vertices and {} triangles, expected at least 3 and 1",
                            i, shape.vertices, shape.triangles);
    if (!problem) runs.add(shape.vertices, 3 * shape.triangles, shape.texcoords, shape.colors);
    if (!problem && std::max(12 * runs.vertices, runs.index_bytes) > kMost)
      problem =
          fmt::format("meshes 0 to {} have {} vertices, more than a file holds", i, runs.vertices);
    if (!problem) continue;
    log.report_file(Code("E0103"), path, *problem);
    return {};
  }
  return runs;
}

bool fill_mesh(const PackedMesh& mesh, Writer& writer, DiagnosticLog& log) {
  const auto all = [&](SectionKind kind, const auto& values) {
    return writer.fill(kind, std::as_bytes(std::span(values)), log);
  };
  if (!all(SectionKind::positions, mesh.positions) || !all(SectionKind::normals, mesh.normals) ||
      !all(SectionKind::texcoords, mesh.texcoords) || !all(SectionKind::colors, mesh.colors))
    return false;
  if (index_size(mesh) == 4) return all(SectionKind::indices, mesh.indices);
  std::vector<std::uint16_t> shorts(mesh.indices.begin(), mesh.indices.end());
  shorts.resize(index_bytes(2, shorts.size()) / 2);
  return all(SectionKind::indices, shorts);
}

// The meshes of a producer, one at a time, in sections that are set aside.
bool write_produced(const MeshProducer& producer, const Runs& runs, Writer& writer, Tables& tables,
                    const std::string& path, DiagnosticLog& log, const Job& job) {
  const std::pair<SectionKind, std::uint64_t> arrays[] = {{SectionKind::positions, runs.vertices},
                                                          {SectionKind::normals, runs.vertices},
                                                          {SectionKind::texcoords, runs.texcoords},
                                                          {SectionKind::colors, runs.colors},
                                                          {SectionKind::indices, runs.index_bytes}};
  for (const auto& [kind, count] : arrays)
    if (!writer.reserve(kind, count, log)) return false;
  PackedMesh mesh;
  for (std::size_t i = 0; i < producer.shapes.size(); ++i) {
    job.poll();
    std::optional<std::string> problem;
    if (!producer.make(i, mesh))
      problem =
          fmt::format("the producer broke off before mesh {} of {}", i, producer.shapes.size());
    if (!problem) problem = misshapen(mesh, producer.shapes[i], i);
    if (problem) {
      log.report_file(Code("E0103"), path, *problem);
      return false;
    }
    add_mesh(mesh, tables);
    if (!fill_mesh(mesh, writer, log)) return false;
  }
  return true;
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

Result<WriteReport> write(const Contents& contents, const MeshProducer& producer,
                          const std::filesystem::path& path, DiagnosticLog& log, const Job& job) {
  assert(contents.meshes.empty() && !contents.nodes.empty());
  return run_job(job, log, [&]() -> Result<WriteReport> {
    const std::string name = path.string();
    const auto runs = announced(producer, name, log);
    if (!runs) return failed;
    auto writer = Writer::create(path, log);
    Tables tables;
    if (!writer || !write_produced(producer, *runs, *writer, tables, name, log, job)) return failed;
    tables = tables_of(contents, std::move(tables));
    if (is_beyond(tables, name, log)) return failed;
    writer->require(tables.features);
    for (const layout::SectionInfo& info : layout::kSections)
      if ((info.kind < SectionKind::positions || info.kind > SectionKind::indices) &&
          !write_section({contents}, tables, info, *writer, log, job))
        return failed;
    job.poll();
    WriteReport report;
    const Hash128 id = build_identity(contents.inputs, contents.version, contents.options);
    if (!writer->finish(id, log, &report.seconds_sync, &job)) return failed;
    report.bytes = writer->bytes();
    return report;
  });
}

std::vector<std::byte> write_to_memory(const Contents& contents, const WriteOptions& options) {
  return in_memory({contents}, options);
}

std::vector<std::byte> write_to_memory(Contents&& contents, const WriteOptions& options) {
  return in_memory({contents, &contents}, options);
}

}  // namespace panwright::pan
