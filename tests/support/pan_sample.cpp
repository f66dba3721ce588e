#include "tests/support/pan_sample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

#include "base/hash.h"
#include "pan/model.h"

namespace panwright::support {

namespace {

using pan::layout::DirectoryEntry;
using pan::layout::Header;
using pan::layout::SectionKind;
using pan::layout::ToleranceReason;

geometry::Mesh tetrahedron() {
  geometry::Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  for (const Vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(p));
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  mesh.closed = true;
  mesh.error = 0.25;
  return mesh;
}

geometry::Mesh square() {
  geometry::Mesh mesh;
  mesh.positions = {{100, 0, 7}, {101, 0, 7}, {101, 1, 7}, {100, 1, 7}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

std::uint64_t hash_of_blocks(const std::byte* bytes, std::uint64_t length) {
  constexpr std::uint64_t kBlock = 786432;  // docs/pan-format.md, Hashes
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t at = 0; at < length; at += kBlock)
    hashes.push_back(hash64({bytes + at, std::min(kBlock, length - at)}));
  return hash64(std::as_bytes(std::span(hashes)));
}

}  // namespace

pan::Contents small_contents() {
  static const std::array<std::uint8_t, 24> kImage = [] {
    std::array<std::uint8_t, 24> texels{};
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<std::uint8_t>(10 * i);
    return texels;
  }();
  pan::Contents contents;
  contents.version = "panwright 0.1.0";
  contents.options = "max_error=0.001";
  contents.inputs = {{"craft.pxn", {1, 2}, 300}, {"skin.png", {3, 4}, 500}};
  contents.nodes = {{"craft", -1, {0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}},
                    {"body", 0, {1, 2, 3}, {0.6, 0, 0.8, 0}, {2, 2, -2}},
                    {"", 1, {0, 0, 1e5}, {0, 1, 0, 0}, {1, 1, 1}}};
  contents.meshes = {pan::packed(tetrahedron(), "hull"), pan::packed(square(), "pl\u00e4t\u00e9")};
  contents.instances = {{1, 0, 0, -1}, {2, 1, 1, 0}, {0, 1, 1, 0}};
  materials::Material plastic;
  plastic.name = "plastic";
  plastic.specular_brdf = materials::CookTorrance{};
  plastic.weights = {0.75, 0.25, 0};
  plastic.refract = Vec3(1.5, 1.5, 1.5);
  materials::Material paint;
  paint.name = "paint";
  paint.diffuse_brdf = materials::OrenNayar{0.25};
  contents.materials = {plastic, paint};
  contents.textures = {{"skin.png", 2, 3, true, kImage}};
  contents.frames = {{"camera", 1, {0, 0, 0.5}, {0.8, 0, 0, 0.6}}};
  contents.sources = {{"craft.pxn", 4, 7}, {"craft.pxn", 9, 3}, {"craft.pxn", 12, 3}};
  contents.budget = pan::layout::Budget{0.5, 100, 1e-4, 0.25, 0.125, 0.0625, 0.5, {}};
  contents.mesh_tolerances = {{0.25, static_cast<std::uint32_t>(ToleranceReason::flux), 0}, {}};
  contents.keypoints = {{"corner", 1, {1, 1, 1}}, {"tip", 2, {0, 0, 0.1}}};
  contents.decals = {{"flag", 1, 0, {100.5, 0.5, 7}, {0.6, 0, 0, 0.8}, 0.5, 0.25, 0.25},
                     {"flag", 0, 0, {1, 1, 1}, {1, 0, 0, 0}, 2, 3, 1.5}};
  pan::layout::Sheet sheet{};
  sheet.width = 2;
  sheet.slope_rms = 0.2;
  sheet.seed = 5;
  sheet.mesh = 1;
  contents.sheets = {sheet};
  contents.levels = {{0.5, 0.25, 2, 1, 0, 0}};
  pan::JointContent hinge;
  hinge.name = "hinge";
  hinge.node = 1;
  hinge.joint.kind = geometry::JointKind::revolute;
  hinge.joint.axis = {0, 1, 0};
  hinge.joint.limited = true;
  hinge.joint.lower[0] = -1;
  hinge.joint.upper[0] = 2;
  pan::JointContent dish = hinge;
  dish.name = "dish";
  dish.joint.axis = {1, 0, 0};
  contents.joints = {hinge, dish};
  return contents;
}

std::string problems(const pan::Contents& contents) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "test.pan", log);
  if (model && model->check(log)) return "";
  return to_text(log);
}

std::vector<std::byte> small_pan() { return pan::write_to_memory(small_contents()); }

pan::Contents regular_contents() {
  constexpr std::uint32_t kQuads = 24, kSide = kQuads + 1, kImage = 40;
  static const std::vector<std::uint8_t> kTexels = [] {
    std::vector<std::uint8_t> texels;
    for (std::uint32_t i = 0; i < 4 * kImage * kImage; ++i)
      texels.push_back(static_cast<std::uint8_t>(i / 16));
    return texels;
  }();
  geometry::Mesh mesh;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const double x = 0.25 * (i % kSide), y = 0.25 * (i / kSide);
    mesh.positions.emplace_back(x, y, 0);
    mesh.texcoords.emplace_back(x, y);
    mesh.colors.emplace_back(1, 0.5, 0.25);
  }
  mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
  for (std::uint32_t i = 0; i < kQuads * kQuads; ++i) {
    const std::uint32_t a = i / kQuads * kSide + i % kQuads;
    mesh.triangles.push_back({a, a + 1, a + kSide});
    mesh.triangles.push_back({a + 1, a + kSide + 1, a + kSide});
  }
  pan::Contents contents = small_contents();
  contents.meshes.push_back(pan::packed(mesh, "sheet"));
  contents.mesh_tolerances.push_back({});
  contents.textures.push_back({"ramp.png", kImage, kImage, false, kTexels});
  for (std::uint32_t i = 0; i < 80; ++i) {
    const auto node = static_cast<std::uint32_t>(contents.nodes.size());
    contents.nodes.push_back({"knot " + std::to_string(i), 0, {1.0 * i, 0, 0}});
    contents.instances.push_back({node, 2, i % 2, 1});
    contents.sources.push_back({"craft.pxn", i + 1, 1});
    contents.frames.push_back({"eye " + std::to_string(i), node, {0, 0, 1}});
  }
  return contents;
}

std::vector<std::byte> compressed_pan() {
  return pan::write_to_memory(regular_contents(), {.compress = true});
}

pan::Contents large_contents(std::uint64_t bytes) {
  constexpr std::uint32_t kQuads = 512;
  constexpr std::uint32_t kSide = kQuads + 1;
  geometry::Mesh mesh;
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const double x = 0.02 * i, y = 0.02 * j;
      mesh.positions.emplace_back(x, y, std::sin(x) * std::cos(y));
      mesh.normals.push_back(
          glm::normalize(Vec3(-std::cos(x) * std::cos(y), std::sin(x) * std::sin(y), 1.0)));
    }
  }
  for (std::uint32_t j = 0; j < kQuads; ++j) {
    for (std::uint32_t i = 0; i < kQuads; ++i) {
      const std::uint32_t a = j * kSide + i, b = a + 1, c = a + kSide, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  pan::Contents contents;
  contents.version = "large";
  contents.nodes = {{"root"}};
  contents.materials = {materials::Material{}};
  const pan::PackedMesh sheet = pan::packed(mesh, "sheet");
  const std::uint64_t each =
      4 * (sheet.positions.size() + sheet.normals.size() + sheet.indices.size());
  const auto count = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, bytes / each));
  for (std::uint32_t m = 0; m < count; ++m) {
    contents.meshes.push_back(sheet);
    contents.instances.push_back({0, m, 0, -1});
  }
  return contents;
}

Header& OpenPan::header() { return *reinterpret_cast<Header*>(bytes_.data()); }

DirectoryEntry& OpenPan::entry(std::size_t index) {
  return reinterpret_cast<DirectoryEntry*>(bytes_.data() + header().directory_offset)[index];
}

DirectoryEntry& OpenPan::entry(SectionKind kind) {
  std::size_t index = 0;
  while (entry(index).kind != static_cast<std::uint32_t>(kind)) {
    ++index;
    assert(index < header().section_count);
  }
  return entry(index);
}

void OpenPan::add_section(std::uint32_t kind, bool optional, std::size_t stride,
                          std::vector<std::byte> bytes) {
  DirectoryEntry added{};
  added.kind = kind;
  added.version = 1;
  added.flags = optional ? 1 : 0;
  added.offset = header().directory_offset;
  added.stored_length = added.raw_length = bytes.size();
  added.count = bytes.size() / stride;
  added.stride = static_cast<std::uint32_t>(stride);
  const auto place = bytes_.begin() + static_cast<std::ptrdiff_t>(added.offset);
  bytes_.insert(place, bytes.begin(), bytes.end());
  const auto record = std::as_bytes(std::span(&added, 1));
  bytes_.insert(bytes_.end(), record.begin(), record.end());
  header().directory_offset += bytes.size();
  header().section_count += 1;
  header().total_length = bytes_.size();
}

void OpenPan::replace_section(SectionKind kind, const std::vector<std::byte>& stored) {
  move_after(kind, stored.size());
  std::copy(stored.begin(), stored.end(),
            bytes_.begin() + static_cast<std::ptrdiff_t>(entry(kind).offset));
}

void OpenPan::restride_section(SectionKind kind, std::uint32_t stride, std::byte tail) {
  const DirectoryEntry before = entry(kind);
  std::vector<std::byte> records(before.count * stride, tail);
  for (std::size_t i = 0; i < before.count; ++i)
    std::memcpy(&records[i * stride], &at<std::byte>(kind, i * before.stride),
                std::min(stride, before.stride));
  const std::uint64_t raw = records.size();
  records.resize((raw + 63) / 64 * 64);
  replace_section(kind, records);
  entry(kind).stride = stride;
  entry(kind).raw_length = raw;
  header().required_features |= 2;
  header().minor = 1;
}

void OpenPan::resize_section(SectionKind kind, std::size_t count) {
  DirectoryEntry& found = entry(kind);
  const std::uint64_t raw = count * found.stride, old_raw = found.raw_length;
  const std::uint64_t stored = (raw + 63) / 64 * 64;
  const std::uint64_t offset = found.offset;
  found.count = count;
  found.raw_length = raw;
  move_after(kind, stored);
  const std::uint64_t kept = std::min(raw, old_raw);
  std::memset(bytes_.data() + offset + kept, 0, stored - kept);
}

void OpenPan::move_after(SectionKind kind, std::uint64_t stored) {
  DirectoryEntry& found = entry(kind);
  const std::uint64_t old = found.stored_length, offset = found.offset;
  found.stored_length = stored;
  for (std::size_t i = 0; i < header().section_count; ++i)
    if (entry(i).offset > offset || (entry(i).offset == offset && &entry(i) > &found))
      entry(i).offset += stored - old;
  const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
  if (stored > old)
    bytes_.insert(first + static_cast<std::ptrdiff_t>(old), stored - old, std::byte{0});
  else
    bytes_.erase(first + static_cast<std::ptrdiff_t>(stored),
                 first + static_cast<std::ptrdiff_t>(old));
  header().directory_offset += stored - old;
  header().total_length = bytes_.size();
}

OpenPan& OpenPan::seal() {
  for (std::size_t i = 0; i < header().section_count; ++i)
    entry(i).hash = hash_of_blocks(bytes_.data() + entry(i).offset, entry(i).stored_length);
  return seal_directory();
}

OpenPan& OpenPan::seal_directory() {
  header().directory_hash =
      hash_of_blocks(bytes_.data() + header().directory_offset, 64 * header().section_count);
  return seal_header();
}

OpenPan& OpenPan::seal_header() {
  header().header_hash = hash64({bytes_.data(), 120});
  return *this;
}

}  // namespace panwright::support
