#include "pan/model.h"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/text.h"
#include "pan/internal/block_hash.h"

namespace panwright::pan {

namespace {

using layout::SectionKind;

static_assert(std::endian::native == std::endian::little, "pan files are little endian");

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

// What transfers that take a file for text make of the magic.
bool damaged_by_text_mode(std::span<const std::byte> bytes) {
  constexpr std::string_view kSeen[] = {
      "\x89PAN\r\r\n\x1a\r\n",  // line feeds became CR LF
      "\x89PAN\n\x1a\n",        // CR LF became line feeds
      "\x89PAN\n\n\x1a\n",      // carriage returns became line feeds
      "\x89PAN\r\r\x1a\r",      // line feeds became carriage returns
      "\tPAN\r\n\x1a\n",        // the eighth bit was lost
      "\xc2\x89PAN",            // read as ISO-8859-1, written as UTF-8
      "\xef\xbf\xbdPAN",        // read as UTF-8, bad bytes replaced
  };
  for (const std::string_view seen : kSeen)
    if (begins_with(bytes, seen)) return true;
  return false;
}

template <class T>
bool all_zero(const T& values) {
  for (const auto value : values)
    if (value != 0) return false;
  return true;
}

bool known(std::uint32_t kind) { return kind >= 1 && kind <= layout::kSectionKinds; }

// Steps 1 and 2 of docs/pan-format.md, Reading: one complaint, or none.
struct Complaint {
  Code code;
  std::string message;
  std::string hint;
};

std::optional<Complaint> check_magic(std::span<const std::byte> bytes) {
  if (bytes.empty()) return Complaint{Code::E4001, "the file is empty", {}};
  const std::string_view magic(reinterpret_cast<const char*>(layout::kMagic),
                               sizeof layout::kMagic);
  if (begins_with(bytes, magic.substr(0, std::min(bytes.size(), magic.size())))) {
    if (bytes.size() >= sizeof(layout::Header)) return {};
    return Complaint{Code::E4005,
                     fmt::format("the file is {} bytes long, the header alone takes {}",
                                 bytes.size(), sizeof(layout::Header)),
                     {}};
  }
  if (damaged_by_text_mode(bytes))
    return Complaint{Code::E4002, "the first bytes show that the file was transferred as text",
                     "transfer the file again in binary mode"};
  std::string seen;
  for (const std::byte byte : bytes.first(std::min<std::size_t>(bytes.size(), 8)))
    seen += fmt::format(" {:02x}", static_cast<unsigned>(byte));
  return Complaint{
      Code::E4001,
      fmt::format("the file begins with{}, a pan file with 89 50 41 4e 0d 0a 1a 0a", seen),
      {}};
}

std::optional<Complaint> check_header(const layout::Header& header, std::uint64_t size) {
  constexpr std::uint32_t kSwapped = 0x01020304;
  if (header.endian == kSwapped)
    return Complaint{Code::E4003, "the file is big endian, pan files are little endian", {}};
  if (header.header_hash != internal::header_hash(header))
    return Complaint{Code::E4007, "the header (bytes 0 to 127) does not match its checksum", {}};
  if (header.complete != layout::kComplete)
    return Complaint{Code::E4006, "the complete mark is missing: the writer was stopped", {}};
  if (header.endian != layout::kEndianTag || header.major != layout::kMajor)
    return Complaint{Code::E4003,
                     fmt::format("the file has format {}.{}, this program reads {}.x", header.major,
                                 header.minor, layout::kMajor),
                     "compile the model again with this version of panwright"};
  const std::uint64_t unknown = header.required_features & ~layout::kKnownRequiredFeatures;
  if (unknown != 0)
    return Complaint{Code::E4004,
                     fmt::format("the file (format {}.{}) needs the features {:#x}, which this "
                                 "program does not have",
                                 header.major, header.minor, unknown),
                     "update panwright, or compile the model again with this version"};
  if (!all_zero(header.reserved))
    return Complaint{Code::E4012, "reserved words of the header (bytes 80 to 119) are not 0", {}};
  if (header.total_length != size)
    return Complaint{
        Code::E4005,
        fmt::format("the file is {} bytes long, its header says {}", size, header.total_length),
        {}};
  // note: compared so that nothing can overflow; total_length is the size of real bytes here
  const std::uint64_t offset = header.directory_offset;
  const std::uint64_t count = header.section_count;
  if (count > layout::kMaxSections || offset < sizeof(layout::Header) || offset > size ||
      offset % layout::kSectionAlignment != 0 ||
      size - offset != count * sizeof(layout::DirectoryEntry))
    return Complaint{Code::E4008,
                     fmt::format("the directory of {} sections at byte {} does not end with the "
                                 "file at byte {}",
                                 count, offset, size),
                     {}};
  return {};
}

std::string section_name(const layout::DirectoryEntry& entry) {
  return known(entry.kind) ? fmt::format("section '{}'", layout::kSections[entry.kind - 1].name)
                           : fmt::format("the section of kind {}", entry.kind);
}

// Step 3, for one entry of any kind.
std::optional<std::string> misplaced(const layout::DirectoryEntry& entry, std::uint64_t begin,
                                     std::uint64_t end) {
  const std::string name = section_name(entry);
  if (entry.offset != begin)
    return fmt::format("{} begins at byte {}, the one before it ends at {}", name, entry.offset,
                       begin);
  if (entry.stored_length > end - begin)
    return fmt::format("{} at byte {} has {} bytes, {} are left before the directory", name,
                       entry.offset, entry.stored_length, end - begin);
  if (entry.stride == 0 || entry.count > entry.stored_length / entry.stride ||
      entry.raw_length != entry.count * entry.stride)
    return fmt::format("{} has {} bytes, which is not {} elements of {}", name, entry.raw_length,
                       entry.count, entry.stride);
  constexpr std::uint64_t kAlignment = layout::kSectionAlignment;
  if (entry.stored_length % kAlignment != 0 || entry.stored_length - entry.raw_length >= kAlignment)
    return fmt::format("{} stores {} bytes, {} rounded up to a multiple of {} are needed", name,
                       entry.stored_length, entry.raw_length, kAlignment);
  if (entry.reserved != 0 || entry.reserved_2 != 0 ||
      (entry.flags & ~layout::kSectionOptional) != 0)
    return fmt::format("{} has reserved bits that are not 0", name);
  return {};
}

}  // namespace

Result<Model> Model::open(const std::filesystem::path& path, DiagnosticLog& log) {
  auto mapped = MappedFile::open(path, log);
  if (!mapped) return failed;
  Model model;
  model.name_ = path.string();
  model.mapped_.emplace(*std::move(mapped));
  model.bytes_ = model.mapped_->bytes();
  // the file may have shrunk since its length was taken; pages past its end cannot be touched
  std::error_code error;
  const std::uint64_t now = std::filesystem::file_size(path, error);
  if (!error && now < model.bytes_.size()) {
    log.report_file(Code::E4005, model.name_,
                    fmt::format("the file shrank from {} to {} bytes while it was opened",
                                model.bytes_.size(), now));
    return failed;
  }
  if (!model.parse(log)) return failed;
  return model;
}

Result<Model> Model::read(const std::filesystem::path& path, std::uint64_t max_bytes,
                          DiagnosticLog& log) {
  const auto text = read_file(path, max_bytes, log);
  if (!text) return failed;
  return from_bytes(as_bytes(*text), path.string(), log);
}

Result<Model> Model::from_bytes(std::span<const std::byte> bytes, std::string name,
                                DiagnosticLog& log) {
  Model model;
  model.name_ = std::move(name);
  model.owned_ = std::make_unique_for_overwrite<std::byte[]>(bytes.size());
  if (!bytes.empty()) std::memcpy(model.owned_.get(), bytes.data(), bytes.size());
  model.bytes_ = {model.owned_.get(), bytes.size()};
  if (!model.parse(log)) return failed;
  return model;
}

Result<Model> Model::load(const std::filesystem::path& path, DiagnosticLog& log,
                          const Job& job) {
  auto model = open(path, log);
  if (!model || !model->check(log, job)) return failed;
  return model;
}

bool Model::parse(DiagnosticLog& log) {
  auto complaint = check_magic(bytes_);
  if (!complaint) complaint = check_header(header(), bytes_.size());
  if (!complaint &&
      header().directory_hash != internal::block_hash(bytes_.subspan(header().directory_offset)))
    complaint = Complaint{Code::E4007,
                          fmt::format("the directory (from byte {}) does not match its checksum",
                                      header().directory_offset),
                          {}};
  if (complaint) {
    log.report_file(complaint->code, name_, complaint->message, complaint->hint);
    return false;
  }
  std::uint64_t begin = sizeof(layout::Header);
  std::uint32_t number = 0;
  for (const layout::DirectoryEntry& found : directory()) {
    ++number;
    if (const auto problem = misplaced(found, begin, header().directory_offset)) {
      log.report_file(Code::E4008, name_, *problem);
      return false;
    }
    begin += found.stored_length;
    if (!known(found.kind) || found.version != 1) {
      if (found.flags & layout::kSectionOptional) continue;
      log.report_file(Code::E4004, name_,
                      fmt::format("{} has version {}, which this program does not read",
                                  section_name(found), found.version),
                      "update panwright, or compile the model again with this version");
      return false;
    }
    const layout::SectionInfo& info = layout::kSections[found.kind - 1];
    if (found.stride != info.stride || entry_of_kind_[found.kind] != 0) {
      const std::string problem =
          found.stride != info.stride
              ? fmt::format("section '{}' has elements of {} bytes, {} are needed", info.name,
                            found.stride, info.stride)
              : fmt::format("section '{}' stands twice", info.name);
      log.report_file(Code::E4008, name_, problem);
      return false;
    }
    entry_of_kind_[found.kind] = number;
  }
  if (begin != header().directory_offset) {
    log.report_file(Code::E4008, name_,
                    fmt::format("the sections end at byte {}, the directory begins at {}", begin,
                                header().directory_offset));
    return false;
  }
  bool complete = true;
  for (const layout::SectionInfo& info : layout::kSections) {
    if (info.optional || entry(info.kind)) continue;
    log.report_file(Code::E4008, name_, fmt::format("section '{}' is missing", info.name));
    complete = false;
  }
  return complete;
}

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

std::span<const std::byte> Model::section(SectionKind kind) const {
  const layout::DirectoryEntry* found = entry(kind);
  if (!found) return {};
  return bytes_.subspan(found->offset, found->raw_length);
}

Hash128 Model::build_id() const { return {header().build_id[0], header().build_id[1]}; }

template <class T>
std::span<const T> Model::array(SectionKind kind) const {
  const auto bytes = section(kind);
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

std::span<const layout::Node> Model::nodes() const {
  return array<layout::Node>(SectionKind::nodes);
}
std::span<const layout::Mesh> Model::meshes() const {
  return array<layout::Mesh>(SectionKind::meshes);
}
std::span<const layout::Instance> Model::instances() const {
  return array<layout::Instance>(SectionKind::instances);
}
std::span<const layout::Material> Model::materials() const {
  return array<layout::Material>(SectionKind::materials);
}
std::span<const layout::Texture> Model::textures() const {
  return array<layout::Texture>(SectionKind::textures);
}
std::span<const layout::Frame> Model::frames() const {
  return array<layout::Frame>(SectionKind::frames);
}
std::span<const layout::Source> Model::sources() const {
  return array<layout::Source>(SectionKind::sources);
}
const layout::Need* Model::need() const {
  const auto records = array<layout::Need>(SectionKind::need);
  return records.empty() ? nullptr : records.data();
}
std::span<const layout::MeshNeed> Model::mesh_needs() const {
  return array<layout::MeshNeed>(SectionKind::mesh_needs);
}
std::span<const layout::Keypoint> Model::keypoints() const {
  return array<layout::Keypoint>(SectionKind::keypoints);
}
std::span<const layout::Decal> Model::decals() const {
  return array<layout::Decal>(SectionKind::decals);
}
std::span<const layout::Input> Model::inputs() const {
  return array<layout::Input>(SectionKind::inputs);
}
std::span<const layout::Build> Model::builds() const {
  return array<layout::Build>(SectionKind::build);
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
std::span<const layout::Float3> Model::colours() const {
  return array<layout::Float3>(SectionKind::colours);
}
std::span<const std::byte> Model::index_bytes() const { return section(SectionKind::indices); }
std::span<const std::byte> Model::texel_bytes() const { return section(SectionKind::texels); }
std::span<const std::uint32_t> Model::string_offsets() const {
  return array<std::uint32_t>(SectionKind::string_offsets);
}
std::span<const char> Model::string_bytes() const { return array<char>(SectionKind::string_bytes); }

std::string_view Model::string(std::uint32_t id) const {
  assert(checked_ && id + 1 < string_offsets().size());
  const std::uint32_t* place = &string_offsets()[id];
  return {string_bytes().data() + place[0], place[1] - place[0]};
}

MeshView Model::mesh(std::size_t index) const {
  assert(checked_ && index < meshes().size());
  const layout::Mesh& record = meshes()[index];
  MeshView view;
  view.positions = positions().subspan(record.first_vertex, record.vertex_count);
  view.normals = normals().subspan(record.first_vertex, record.vertex_count);
  if (record.flags & layout::kMeshTexcoords)
    view.texcoords = texcoords().subspan(record.first_texcoord, record.vertex_count);
  if (record.flags & layout::kMeshColours)
    view.colours = colours().subspan(record.first_colour, record.vertex_count);
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

std::vector<Mat4> Model::world_from_nodes() const {
  std::vector<Mat4> world(nodes().size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const layout::Node& node = nodes()[i];
    assert(node.parent < static_cast<std::int64_t>(i));
    world[i] = parent_from_node(node);
    if (node.parent >= 0) world[i] = world[node.parent] * world[i];
  }
  return world;
}

Mat4 Model::world_from_frame(std::size_t index) const {
  assert(checked_ && index < frames().size());
  const layout::Frame& frame = frames()[index];
  Mat4 world = node_from_frame(frame);
  for (std::int64_t i = frame.node; i >= 0; i = nodes()[i].parent)
    world = parent_from_node(nodes()[i]) * world;
  return world;
}

std::optional<Model::Bounds> Model::world_bounds() const {
  assert(checked_);
  if (instances().empty()) return {};
  const std::vector<Mat4> world = world_from_nodes();
  Bounds bounds{Vec3(HUGE_VAL), Vec3(-HUGE_VAL)};
  for (const layout::Instance& instance : instances()) {
    const layout::Mesh& record = meshes()[instance.mesh];
    const Vec3 origin(record.origin[0], record.origin[1], record.origin[2]);
    const Mat4& matrix = world[instance.node];
    for (const layout::Float3& p : mesh(instance.mesh).positions) {
      const Vec3 point(matrix * Vec4(origin + Vec3(p.x, p.y, p.z), 1.0));
      bounds.min = glm::min(bounds.min, point);
      bounds.max = glm::max(bounds.max, point);
    }
  }
  return bounds;
}

namespace {

Vec3 vec3(const double* v) { return {v[0], v[1], v[2]}; }
Vec3 vec3(const float* v) { return {v[0], v[1], v[2]}; }
Vec2 vec2(const float* v) { return {v[0], v[1]}; }
Quat quat(const double* q) { return {q[0], q[1], q[2], q[3]}; }

void store(float* to, const Vec2& v) {
  for (int k = 0; k < 2; ++k) to[k] = static_cast<float>(v[k]);
}

void store(float* to, const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

}  // namespace

Mat4 parent_from_node(const layout::Node& node) {
  return matrix_from_trs(vec3(node.translation), quat(node.rotation), vec3(node.scale));
}

Mat4 node_from_frame(const layout::Frame& frame) {
  return matrix_from_trs(vec3(frame.origin), quat(frame.rotation), Vec3(1));
}

std::string_view reason_name(layout::NeedReason reason) {
  constexpr std::string_view kNames[] = {
      "explicit_counts", "tolerance", "shape", "pixels", "flux", "centroid", "command_line"};
  assert(static_cast<std::size_t>(reason) < std::size(kNames));
  return kNames[static_cast<std::size_t>(reason)];
}

Mat4 mesh_from_decal(const layout::Decal& decal) {
  return matrix_from_trs(vec3(decal.origin), quat(decal.rotation), Vec3(1));
}

materials::Material material_from(const layout::Material& record, std::string_view name) {
  materials::Material material;
  material.name = name;
  material.diffuse_law = static_cast<materials::DiffuseLaw>(record.diffuse_law);
  material.specular_law = static_cast<materials::SpecularLaw>(record.specular_law);
  material.diffuse = vec3(record.diffuse);
  material.specular = vec3(record.specular);
  material.emissive = vec3(record.emissive);
  material.weights = {record.weight_d, record.weight_s, record.weight_e};
  if (vec3(record.refract) != Vec3(0)) material.refract = vec3(record.refract);
  material.extinction = vec3(record.extinction);
  material.shine = record.shine;
  material.alpha_y = record.alpha_y;
  material.grains = {record.grains[0], record.grains[1], record.grains[2], record.grains[3],
                     record.porosity};
  material.compensation = static_cast<materials::Compensation>(record.compensation);
  if (record.coat_index > 0)
    material.coat = {record.coat_index, record.coat_alpha, vec3(record.coat_depth)};
  if (record.cell_count[0] > 0)
    material.cells = {vec2(record.cell_count),
                      vec2(record.cell_gap),
                      record.fingers,
                      record.finger_width,
                      vec3(record.gap_color),
                      vec3(record.finger_color),
                      {det::atan(record.tilt_u), det::atan(record.tilt_v)}};
  for (std::size_t k = 0; k < 8; ++k) {
    material.fits.loss[k] = record.loss[k];
    material.fits.hapke_h[k] = record.hapke_h[k];
  }
  material.fits.many_scale = vec3(record.many_scale);
  material.fits.coat_return = vec3(record.coat_return);
  material.fits.error = record.fit_error;
  for (int k = 0; k < 4; ++k) material.cook[k] = record.cook[k];
  for (int k = 0; k < 4; ++k) material.hapke[k] = record.hapke[k];
  material.oren = record.oren;
  material.fits.reflectance = vec3(record.reflectance);
  material.maps = {record.albedo_map,      record.normal_map, record.roughness_map,
                   record.reflectance_map, record.cutout_map, record.cutout_threshold,
                   vec2(record.map_repeat)};
  return material;
}

layout::Material record_from(const materials::Material& material, std::uint32_t name) {
  layout::Material record{};
  store(record.diffuse, material.diffuse);
  store(record.specular, material.specular);
  store(record.emissive, material.emissive);
  record.weight_d = static_cast<float>(material.weights.x);
  record.weight_s = static_cast<float>(material.weights.y);
  record.weight_e = static_cast<float>(material.weights.z);
  if (material.refract) store(record.refract, *material.refract);
  store(record.extinction, material.extinction);
  record.shine = static_cast<float>(material.shine);
  record.alpha_y = static_cast<float>(material.alpha_y);
  const materials::HapkeGrains& grains = material.grains;
  store(record.grains, Vec3(grains.b, grains.c, grains.h_c));
  record.grains[3] = static_cast<float>(grains.b_c0);
  record.porosity = static_cast<float>(grains.porosity);
  record.hapke_k = static_cast<float>(materials::porosity_factor(grains.porosity));
  record.compensation = static_cast<std::uint32_t>(material.compensation);
  if (const auto& coat = material.coat) {
    record.coat_index = static_cast<float>(coat->index);
    record.coat_alpha = static_cast<float>(coat->alpha);
    store(record.coat_depth, coat->depth);
  }
  if (const auto& cells = material.cells) {
    store(record.cell_count, cells->count);
    store(record.cell_gap, cells->gap);
    record.fingers = static_cast<float>(cells->fingers);
    record.finger_width = static_cast<float>(cells->finger_width);
    store(record.gap_color, cells->gap_color);
    store(record.finger_color, cells->finger_color);
    record.tilt_u = static_cast<float>(det::tan(cells->tilt.x));
    record.tilt_v = static_cast<float>(det::tan(cells->tilt.y));
  }
  for (std::size_t k = 0; k < 8; ++k) {
    record.loss[k] = static_cast<float>(material.fits.loss[k]);
    record.hapke_h[k] = static_cast<float>(material.fits.hapke_h[k]);
  }
  store(record.many_scale, material.fits.many_scale);
  store(record.coat_return, material.fits.coat_return);
  record.fit_error = static_cast<float>(material.fits.error);
  for (int k = 0; k < 4; ++k) record.cook[k] = static_cast<float>(material.cook[k]);
  for (int k = 0; k < 4; ++k) record.hapke[k] = static_cast<float>(material.hapke[k]);
  record.oren = static_cast<float>(material.oren);
  record.diffuse_law = static_cast<std::uint32_t>(material.diffuse_law);
  record.specular_law = static_cast<std::uint32_t>(material.specular_law);
  record.name = name;
  record.albedo_map = material.maps.albedo;
  record.normal_map = material.maps.normal;
  record.roughness_map = material.maps.roughness;
  record.reflectance_map = material.maps.reflectance;
  store(record.reflectance, material.fits.reflectance);
  record.cutout_map = material.maps.cutout;
  record.cutout_threshold = static_cast<float>(material.maps.threshold);
  store(record.map_repeat, material.maps.repeat);
  return record;
}

}  // namespace panwright::pan
