#include "importers/step/internal/wire.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

namespace panwright::importers::step {

namespace {

enum Kind : std::uint32_t {
  kDiagnostic = 1,
  kNodes,
  kShape,
  kMaterials,
  kInstances,
  kUnit,
  kEnd,
};

// Kinds of shapes that a STEP file becomes; others are never sent.
enum ShapeKind : std::uint32_t { kMesh = 1, kSphere, kTorus, kCylinder, kCone, kBox, kTube };

// What the reader may report.
constexpr Code kCodes[] = {Code("E6002"), Code("E6601"), Code("W6004"), Code("N6007"),
                           Code("W6008"), Code("W6009"), Code("W6602")};

constexpr std::size_t kRecordHead = 12;
constexpr std::size_t kAtOnce = 4096;             // nodes or instances of a record
constexpr std::uint32_t kMostText = 1u << 20;     // bytes of a string
constexpr std::uint64_t kOverhead = 64ull << 20;  // of an answer: whatever is no array

// note: GLM's vectors are plain numbers, which their constructors hide from the compiler
template <class T>
inline constexpr bool kPlain =
    std::is_trivially_copyable_v<T> || std::is_same_v<T, Vec3> || std::is_same_v<T, Quat>;
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Quat) == 4 * sizeof(double));

template <class T>
void put(std::string& out, const T& value) {
  static_assert(kPlain<T>);
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_text(std::string& out, std::string_view text) {
  text = text.substr(0, kMostText);
  put(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

template <class T>
void put_array(std::string& out, const std::vector<T>& list) {
  static_assert(kPlain<T>);
  out.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
}

bool send_record(Kind kind, const std::string& payload, const Send& send) {
  std::string head;
  put(head, static_cast<std::uint32_t>(kind));
  put(head, static_cast<std::uint64_t>(payload.size()));
  return send(head) && send(payload);
}

}  // namespace

// Takes values off the front of bytes. Once they do not suffice, it fails and gives zeros.
class Values {
 public:
  explicit Values(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    static_assert(kPlain<T>);
    T value{};
    if (!has(sizeof value)) return value;
    std::memcpy(static_cast<void*>(&value), bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }

  std::string text() {
    const auto size = get<std::uint32_t>();
    if (size > kMostText || !has(size)) {
      failed_ = true;
      return {};
    }
    std::string out(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return out;
  }

  template <class T>
  std::vector<T> array(std::uint64_t count) {
    std::vector<T> out;
    if (failed_ || count > bytes_.size() / sizeof(T)) {
      failed_ = true;
      return out;
    }
    out.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(out.data()), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
    return out;
  }

  bool failed() const { return failed_; }
  bool ended() const { return !failed_ && bytes_.empty(); }
  std::string_view rest() const { return bytes_; }

 private:
  bool has(std::size_t size) {
    failed_ = failed_ || bytes_.size() < size;
    return !failed_;
  }

  std::string_view bytes_;
  bool failed_ = false;
};

materials::Material lambert_of(const CadMaterial& cad) {
  materials::Material material;
  material.name = cad.name;
  material.diffuse = cad.base_color;
  materials::fit(material);
  return material;
}

// ---- request

std::string request_head(const Request& request) {
  std::string out(kRequestMark);
  const Limits& limits = request.limits;
  put(out, request.bytes);
  put(out, limits.memory);
  put(out, limits.nodes);
  put(out, limits.triangles);
  put(out, limits.depth);
  put(out, request.deflection);
  put_text(out, request.path);
  put_text(out, request.name);
  return out;
}

std::optional<Request> request_from(std::string_view& bytes) {
  if (!bytes.starts_with(kRequestMark)) return std::nullopt;
  Values in(bytes.substr(kRequestMark.size()));
  Request out;
  out.bytes = in.get<std::uint64_t>();
  out.limits.memory = in.get<std::uint64_t>();
  out.limits.nodes = in.get<std::uint64_t>();
  out.limits.triangles = in.get<std::uint64_t>();
  out.limits.depth = in.get<std::uint32_t>();
  out.deflection = in.get<double>();
  out.path = in.text();
  out.name = in.text();
  if (in.failed() || in.rest().size() != out.bytes) return std::nullopt;
  bytes = in.rest();
  return out;
}

// ---- answer, sent

std::size_t send_diagnostics(const DiagnosticLog& log, std::size_t first, const Send& send) {
  for (std::size_t i = first; i < log.entries().size(); ++i) {
    const Diagnostic& entry = log.entries()[i];
    std::string out;
    put_text(out, code_info(entry.code).name);
    // a diagnostic of the file as a whole is about one without bytes
    const FileId file = entry.where.file;
    const bool placed = file != kNoFile && log.sources().file(file).bytes;
    put(out, static_cast<std::uint32_t>(placed ? 1 : 0));
    put(out, entry.where.begin);
    put(out, entry.where.end);
    put_text(out, entry.message);
    put_text(out, entry.object);
    put_text(out, entry.hint);
    if (!send_record(kDiagnostic, out, send)) break;
  }
  return log.entries().size();
}

namespace {

bool send_nodes(const scene::Scene& scene, const Send& send) {
  for (std::size_t first = 0; first < scene.nodes.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, scene.nodes.size() - first);
    std::string out;
    put(out, static_cast<std::uint32_t>(count));
    for (std::size_t i = first; i < first + count; ++i) {
      const scene::Node& node = scene.nodes[i];
      put_text(out, node.name);
      put(out, node.parent);
      put(out, node.parent_from_node.translation);
      put(out, node.parent_from_node.rotation);
      put(out, node.parent_from_node.scale);
      put(out, node.source.line);
      put(out, node.source.column);
    }
    if (!send_record(kNodes, out, send)) return false;
  }
  return true;
}

struct ShapeWriter {
  std::string& out;

  void operator()(const geometry::MeshShape& shape) const {
    const geometry::Mesh& mesh = *shape;
    put(out, kMesh);
    put(out, static_cast<std::uint64_t>(mesh.positions.size()));
    put(out, static_cast<std::uint64_t>(mesh.normals.size()));
    put(out, static_cast<std::uint64_t>(mesh.triangles.size()));
    put_array(out, mesh.positions);
    put_array(out, mesh.normals);
    put_array(out, mesh.triangles);
  }
  void operator()(const geometry::Sphere& shape) const {
    put(out, kSphere);
    put(out, shape.radius);
  }
  void operator()(const geometry::Torus& shape) const {
    put(out, kTorus);
    put(out, shape.radius);
    put(out, shape.tube_radius);
  }
  void operator()(const geometry::Cylinder& shape) const {
    put(out, kCylinder);
    put(out, shape.radius);
    put(out, shape.height);
  }
  void operator()(const geometry::Cone& shape) const {
    put(out, kCone);
    put(out, shape.bottom_radius);
    put(out, shape.top_radius);
    put(out, shape.height);
  }
  void operator()(const geometry::Box& shape) const {
    put(out, kBox);
    put(out, shape.size);
  }
  void operator()(const geometry::Tube& shape) const {
    put(out, kTube);
    put(out, shape.path.front());
    put(out, shape.path.back());
    put(out, shape.radius);
    put(out, shape.inner_radius);
  }
  template <class Other>
  void operator()(const Other&) const {
    assert(false && "no shape of a STEP file");
  }
};

}  // namespace

void send_scene(const Imported& imported, const Send& send) {
  const scene::Scene& scene = imported.scene;
  std::string unit;
  put(unit, imported.file_unit);
  put(unit, static_cast<std::uint32_t>(imported.lacks_unit ? 1 : 0));
  if (!send_record(kUnit, unit, send)) return;
  if (!send_nodes(scene, send)) return;
  for (const geometry::Shape& shape : scene.shapes) {
    std::string out;
    std::visit(ShapeWriter{out}, shape);
    if (!send_record(kShape, out, send)) return;
  }
  for (std::size_t first = 0; first < imported.materials.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, imported.materials.size() - first);
    std::string out;
    put(out, static_cast<std::uint32_t>(count));
    for (std::size_t i = first; i < first + count; ++i) {
      put_text(out, imported.materials[i].name);
      put(out, imported.materials[i].base_color);
      put(out, imported.materials[i].opacity);
    }
    if (!send_record(kMaterials, out, send)) return;
  }
  for (std::size_t first = 0; first < scene.instances.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, scene.instances.size() - first);
    std::string out;
    put(out, static_cast<std::uint32_t>(count));
    for (std::size_t i = first; i < first + count; ++i) {
      const scene::Instance& instance = scene.instances[i];
      put(out, instance.node);
      put(out, instance.shape);
      put(out, instance.material);
      put(out, instance.source.line);
      put(out, instance.source.column);
    }
    if (!send_record(kInstances, out, send)) return;
  }
}

void send_end(bool complete, const Send& send) {
  std::string out;
  put(out, static_cast<std::uint32_t>(complete ? 1 : 0));
  (void)send_record(kEnd, out, send);
}

// ---- answer, taken

AnswerReader::State AnswerReader::damaged(std::string what) {
  damage_ = std::move(what);
  waiting_.clear();
  out_ = {};
  return state_ = State::damaged;
}

AnswerReader::State AnswerReader::take(std::string_view bytes) {
  if (state_ != State::open) return state_;
  taken_ += bytes.size();
  if (taken_ > request_.limits.memory + kOverhead) return damaged("it is too long");
  waiting_.append(bytes);
  std::string_view left = waiting_;
  if (!begun_) {
    const std::size_t known = std::min(left.size(), kAnswerMark.size());
    if (left.substr(0, known) != kAnswerMark.substr(0, known))
      return damaged("it does not begin as an answer does");
    if (known < kAnswerMark.size()) return state_;
    left.remove_prefix(known);
    begun_ = true;
  }
  while (state_ == State::open && left.size() >= kRecordHead) {
    std::uint32_t kind = 0;
    std::uint64_t size = 0;
    std::memcpy(&kind, left.data(), sizeof kind);
    std::memcpy(&size, left.data() + sizeof kind, sizeof size);
    if (kind < kDiagnostic || kind > kEnd || size > request_.limits.memory + kOverhead)
      return damaged("it holds a record of no known kind or size");
    if (left.size() - kRecordHead < size) break;
    if (!take_record(kind, left.substr(kRecordHead, size)))
      return damaged(fmt::format("its record of kind {} is invalid", kind));
    left.remove_prefix(kRecordHead + size);
  }
  waiting_.erase(0, waiting_.size() - left.size());
  return state_;
}

bool AnswerReader::take_record(std::uint32_t kind, std::string_view payload) {
  Values record(payload);
  switch (kind) {
    case kDiagnostic:
      return take_diagnostic(record);
    case kNodes:
      return take_nodes(record);
    case kShape:
      return take_shape(record);
    case kMaterials:
      return take_materials(record);
    case kInstances:
      return take_instances(record);
    case kUnit:
      out_.file_unit = record.get<double>();
      out_.lacks_unit = record.get<std::uint32_t>() == 1;
      return record.ended() && out_.file_unit >= 0 && std::isfinite(out_.file_unit);
    default:
      break;
  }
  const auto complete = record.get<std::uint32_t>();
  if (!record.ended() || complete > 1) return false;
  has_scene_ = complete == 1;
  if (has_scene_ && !scene::check(out_.scene).empty()) return false;
  state_ = State::complete;
  return true;
}

bool AnswerReader::take_diagnostic(Values& record) {
  const auto code = code_from_name(record.text());
  const auto placed = record.get<std::uint32_t>();
  SourceSpan where{file_, record.get<std::uint32_t>(), record.get<std::uint32_t>()};
  std::string message = record.text();
  std::string object = record.text();
  std::string hint = record.text();
  if (!record.ended() || !code || placed > 1 ||
      std::find(std::begin(kCodes), std::end(kCodes), *code) == std::end(kCodes))
    return false;
  if (placed == 0) {
    log_.report_file(*code, request_.name, std::move(message), std::move(hint));
    return true;
  }
  if (where.begin > where.end || where.end > request_.bytes) return false;
  log_.report(*code, where, std::move(message), std::move(hint), std::move(object));
  return true;
}

bool AnswerReader::take_nodes(Values& record) {
  const auto count = record.get<std::uint32_t>();
  auto& nodes = out_.scene.nodes;
  if (count > kAtOnce || nodes.size() + count > request_.limits.nodes + 1) return false;
  for (std::uint32_t i = 0; i < count && !record.failed(); ++i) {
    scene::Node node;
    node.name = record.text();
    node.parent = record.get<std::int32_t>();
    node.parent_from_node.translation = record.get<Vec3>();
    node.parent_from_node.rotation = record.get<Quat>();
    node.parent_from_node.scale = record.get<Vec3>();
    node.source = {request_.path, record.get<std::uint32_t>(), 0};
    node.source.column = record.get<std::uint32_t>();
    nodes.push_back(std::move(node));
  }
  return record.ended();
}

bool AnswerReader::take_mesh(Values& record) {
  const auto positions = record.get<std::uint64_t>();
  const auto normals = record.get<std::uint64_t>();
  const auto triangles = record.get<std::uint64_t>();
  if (record.failed() || triangles > request_.limits.triangles - triangles_) return false;
  triangles_ += triangles;
  auto mesh = std::make_shared<geometry::Mesh>();
  mesh->positions = record.array<Vec3>(positions);
  mesh->normals = record.array<Vec3>(normals);
  mesh->triangles = record.array<geometry::Triangle>(triangles);
  out_.scene.shapes.emplace_back(geometry::MeshShape(std::move(mesh)));
  return record.ended();
}

bool AnswerReader::take_shape(Values& record) {
  if (out_.scene.shapes.size() >= request_.limits.nodes) return false;
  auto& shapes = out_.scene.shapes;
  switch (record.get<std::uint32_t>()) {
    case kMesh:
      return take_mesh(record);
    case kSphere: {
      geometry::Sphere shape;
      shape.radius = record.get<double>();
      shapes.emplace_back(shape);
      break;
    }
    case kTorus: {
      geometry::Torus shape;
      shape.radius = record.get<double>();
      shape.tube_radius = record.get<double>();
      shapes.emplace_back(shape);
      break;
    }
    case kCylinder: {
      geometry::Cylinder shape;
      shape.radius = record.get<double>();
      shape.height = record.get<double>();
      shapes.emplace_back(shape);
      break;
    }
    case kCone: {
      geometry::Cone shape;
      shape.bottom_radius = record.get<double>();
      shape.top_radius = record.get<double>();
      shape.height = record.get<double>();
      shapes.emplace_back(shape);
      break;
    }
    case kBox: {
      geometry::Box shape;
      shape.size = record.get<Vec3>();
      shapes.emplace_back(shape);
      break;
    }
    case kTube: {
      geometry::Tube shape;
      shape.path = {record.get<Vec3>(), record.get<Vec3>()};
      shape.radius = record.get<double>();
      shape.inner_radius = record.get<double>();
      shapes.emplace_back(std::move(shape));
      break;
    }
    default:
      return false;
  }
  return record.ended();
}

bool AnswerReader::take_materials(Values& record) {
  const auto count = record.get<std::uint32_t>();
  if (count > kAtOnce || out_.materials.size() + count > request_.limits.nodes) return false;
  for (std::uint32_t i = 0; i < count && !record.failed(); ++i) {
    CadMaterial cad;
    cad.name = record.text();
    cad.base_color = record.get<Vec3>();
    cad.opacity = record.get<double>();
    for (int k = 0; k < 3; ++k)
      if (!(cad.base_color[k] >= 0 && cad.base_color[k] <= 1)) return false;
    if (!(cad.opacity >= 0 && cad.opacity <= 1)) return false;
    out_.scene.materials.push_back(lambert_of(cad));
    out_.materials.push_back(std::move(cad));
  }
  return record.ended();
}

bool AnswerReader::take_instances(Values& record) {
  const auto count = record.get<std::uint32_t>();
  auto& instances = out_.scene.instances;
  if (count > kAtOnce || instances.size() + count > request_.limits.nodes) return false;
  for (std::uint32_t i = 0; i < count && !record.failed(); ++i) {
    scene::Instance instance;
    instance.node = record.get<std::int32_t>();
    instance.shape = record.get<std::int32_t>();
    instance.material = record.get<std::int32_t>();
    instance.source = {request_.path, record.get<std::uint32_t>(), 0};
    instance.source.column = record.get<std::uint32_t>();
    instances.push_back(std::move(instance));
  }
  return record.ended();
}

std::optional<Imported> AnswerReader::finished() {
  assert(state_ == State::complete);
  if (!has_scene_) return std::nullopt;
  return std::move(out_);
}

}  // namespace panwright::importers::step
