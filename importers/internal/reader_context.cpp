#include "importers/internal/reader_context.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/file.h"
#include "base/text.h"
#include "geometry/mesh/strip.h"
#include "geometry/tessellate/tessellate.h"
#include "image/decode.h"

namespace panwright::importers::meshes {

using geometry::Mesh;
using geometry::Triangle;

namespace {

// "3 lines, 1 point"
std::string listed(const std::map<std::string, std::uint64_t>& counts) {
  std::string out;
  for (const auto& [what, count] : counts)
    out += fmt::format("{}{}", out.empty() ? "" : ", ",
                       count == 1 ? what : fmt::format("{} ({})", what, count));
  return out;
}

// The normal of a vertex, of the faces around it: for those that have none of their own.
void take_normals_of_faces(Mesh& mesh) {
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const Triangle& t : mesh.triangles) {
    const std::vector<Vec3>& p = mesh.positions;
    const Vec3 cross = glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
    for (const std::uint32_t v : t) sums[v] += cross;
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    if (mesh.normals[v] != Vec3(0)) continue;
    const double length = glm::length(sums[v]);
    mesh.normals[v] = length > 0 && std::isfinite(length) ? sums[v] / length : Vec3(0, 0, 1);
  }
}

}  // namespace

// ---- ReaderContext

ReaderContext::ReaderContext(Files& from, const InputFile& model, const Options& asked, bool text,
                             DiagnosticLog& to)
    : files(from), file(model), options(asked), log(to), text_(text) {
  source_ = log.sources().add({file.name, text ? file.bytes : SharedText(),
                               text ? Encoding::utf8 : Encoding::binary, file.included_at});
}

SourceSpan ReaderContext::at(std::size_t begin, std::size_t end) const {
  if (!text_) return {source_, 0, 0};
  return {source_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

SourceSpan ReaderContext::at(std::string_view part) const {
  const std::string_view all = *file.bytes;
  const std::less<> before;
  if (before(part.data(), all.data()) || before(all.data() + all.size(), part.data()))
    return {source_, 0, 0};
  const auto begin = static_cast<std::size_t>(part.data() - all.data());
  return at(begin, begin + part.size());
}

void ReaderContext::add(Counts& counts, const std::string& what, std::uint64_t count) {
  constexpr std::size_t kMost = 30;
  const bool fits = counts.size() < kMost || counts.contains(what);
  counts[fits ? what : "others"] += count;
}

void ReaderContext::limit(const std::string& message, SourceSpan where) {
  if (!full) log.report(Code("E6002"), where, message);
  full = true;
}

bool ReaderContext::charge(std::uint64_t bytes) {
  if (bytes <= options.limits.memory && memory_ <= options.limits.memory - bytes) {
    memory_ += bytes;
    return true;
  }
  limit(fmt::format("{} bytes more are over the limit of {} bytes of memory", bytes,
                    options.limits.memory),
        {source_, 0, 0});
  return false;
}

void ReaderContext::served(std::size_t offset) {
  file.job.poll();
  constexpr std::size_t kStep = std::size_t{16} << 20;  // bytes that are worth a call
  if (offset < served_ + kStep && offset < file.bytes->size()) return;
  file.bytes.forget(served_, offset);
  served_ = offset;
}

void ReaderContext::report_missing(const NamedFile& found, bool part, SourceSpan where) {
  const std::string hint = found.outside ? kRootHint : "";
  if (part)
    log.report(Code("E6010"), where, "part not found: " + found.problem, hint);
  else
    log.report(found.outside ? Code("W6005") : Code("W6004"), where, found.problem, hint);
}

void ReaderContext::accept(const NamedFile& found, SourceSpan where) {
  if (!found.deviation.empty()) log.report(tolerated, where, found.deviation);
  const auto is_known = [&](const scene::Input& input) { return input.path == found.path; };
  if (std::ranges::none_of(inputs, is_known))
    inputs.push_back({found.path, hash128(as_bytes(*found.bytes)), found.bytes->size()});
}

std::optional<NamedFile> ReaderContext::read_named(const FileName& name, SourceSpan where) {
  if (++named_ > options.limits.files) {
    constexpr const char* kTooMany = "the model names too many files";
    if (name.part)
      limit(kTooMany, where);
    else
      trouble(Code("W6004"), "too many files", where, [] { return std::string(kTooMany); });
    return std::nullopt;
  }
  NamedFile found = find_file(files, name);
  if (found.outcome != Files::Outcome::found) {
    report_missing(found, name.part, where);
    return std::nullopt;
  }
  accept(found, where);
  return found;
}

void ReaderContext::tell() {
  for (const Trouble& trouble : troubles_)
    log.report(trouble.code, trouble.where,
               trouble.more == 0
                   ? trouble.message
                   : fmt::format("{}; {} more like this one", trouble.message, trouble.more));
  if (!skipped_.empty())
    log.report(Code("N6007"), {source_, 0, 0}, fmt::format("skipped: {}", listed(skipped_)));
  lost_.report({source_, 0, 0}, log);
}

// ---- meshes

bool is_usable(const Vec3& p) {
  const double most = geometry::kMaxCoordinate;
  return std::fabs(p.x) <= most && std::fabs(p.y) <= most && std::fabs(p.z) <= most;
}

void FaceCutter::cut(std::span<const std::uint32_t> face, const std::vector<Vec3>& positions,
                     std::vector<Triangle>& triangles) {
  if (face.size() == 3) {
    triangles.push_back({face[0], face[1], face[2]});
    return;
  }
  outline_.clear();
  for (const std::uint32_t v : face) outline_.push_back(positions[v]);
  cut_.clear();
  cutter_.cut(outline_, cut_);
  for (const Triangle& t : cut_) triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
}

void drop_unused(Mesh& mesh) {
  std::vector<std::uint32_t> to(mesh.positions.size(), kNoIndex);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) to[v] = 0;
  std::uint32_t kept = 0;
  for (std::uint32_t& v : to)
    if (v != kNoIndex) v = kept++;
  if (kept == to.size()) return;
  const auto compact = [&](auto& list) {
    if (list.empty()) return;
    for (std::size_t v = 0; v < to.size(); ++v)
      if (to[v] != kNoIndex) list[to[v]] = list[v];
    list.resize(kept);
  };
  compact(mesh.positions);
  compact(mesh.normals);
  compact(mesh.texcoords);
  compact(mesh.colors);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = to[v];
}

void finish_normals(Mesh& mesh, double crease_angle) {
  if (mesh.normals.empty()) {
    geometry::compute_normals(mesh, crease_angle);
    for (Vec3& n : mesh.normals)
      if (!is_finite(n)) n = Vec3(0, 0, 1);
    return;
  }
  bool whole = true;
  for (Vec3& n : mesh.normals) {
    const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
    // note: in two steps, so that no square gets lost
    n = largest > 0 && is_finite(n) ? glm::normalize(n / largest) : Vec3(0);
    whole = whole && n != Vec3(0);
  }
  if (!whole) take_normals_of_faces(mesh);
}

std::uint32_t Welder::vertex(const Vec3& p, std::vector<Vec3>& positions) {
  if (2 * (used_ + 1) > slots_.size()) grow(positions);
  // note: −0 and 0 are one place
  const std::array<double, 3> key = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash64(std::as_bytes(std::span(key))) & mask;
  for (; slots_[slot] != kNoIndex; slot = (slot + 1) & mask)
    if (positions[slots_[slot]] == p) return slots_[slot];
  ++used_;
  slots_[slot] = static_cast<std::uint32_t>(positions.size());
  positions.push_back(p);
  return slots_[slot];
}

void Welder::grow(const std::vector<Vec3>& positions) {
  slots_.assign(std::max<std::size_t>(64, slots_.size() * 2), kNoIndex);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const std::array<double, 3> key = {positions[v].x + 0.0, positions[v].y + 0.0,
                                       positions[v].z + 0.0};
    std::size_t slot = hash64(std::as_bytes(std::span(key))) & mask;
    while (slots_[slot] != kNoIndex) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::uint32_t>(v);
  }
}

void Welder::clear() {
  slots_ = {};
  used_ = 0;
}

// ---- Assembly

Assembly::Assembly(ReaderContext& context, Format format) : context_(context) {
  out_.format = format;
  scene::Node root;
  root.name = "root";
  out_.scene.nodes.push_back(root);
}

scene::Source Assembly::source_of(SourceSpan where) {
  if (!context_.is_text()) return {context_.file.path};
  const Position at = context_.log.sources().position(where.file, where.begin);
  return {context_.file.path, at.line, at.column};
}

std::int32_t Assembly::add_node(std::int32_t parent, std::string_view name, std::string_view kind,
                                SourceSpan where) {
  if (out_.scene.nodes.size() >= context_.options.limits.nodes) {
    context_.limit(fmt::format("more than {} nodes", context_.options.limits.nodes), where);
    return scene::kNone;
  }
  scene::Node node;
  node.name = to_utf8(name, Encoding::utf8);
  std::replace(node.name.begin(), node.name.end(), '/', '_');
  if (node.name.empty()) node.name = fmt::format("{}{}", kind, ++kinds_[std::string(kind)]);
  node.parent = parent;
  node.source = source_of(where);
  out_.scene.nodes.push_back(std::move(node));
  return static_cast<std::int32_t>(out_.scene.nodes.size() - 1);
}

bool Assembly::has_room_for(std::uint64_t triangles, SourceSpan where) {
  const std::uint64_t most = context_.options.limits.triangles;
  if (triangles <= most && triangles_ <= most - triangles) return true;
  context_.limit(fmt::format("more than {} triangles", most), where);
  return false;
}

void Assembly::add_part(std::int32_t node, Mesh mesh, std::int32_t material, SourceSpan where) {
  context_.file.job.poll();
  triangles_ += mesh.triangles.size();
  scene::Instance instance;
  instance.node = node;
  instance.shape = static_cast<std::int32_t>(out_.scene.shapes.size());
  instance.material = material;
  instance.source = source_of(where);
  out_.scene.shapes.emplace_back(std::make_shared<const Mesh>(std::move(mesh)));
  out_.scene.instances.push_back(std::move(instance));
}

std::int32_t Assembly::add_material(materials::Material material, CadMaterial cad) {
  materials::fit(material);
  for (const LostProperty& lost : cad.lost) context_.lost(lost.what, lost.where);
  out_.scene.materials.push_back(std::move(material));
  out_.materials.push_back(std::move(cad));
  return static_cast<std::int32_t>(out_.scene.materials.size() - 1);
}

std::int32_t Assembly::plain_material(bool colored) {
  std::int32_t& index = plain_[colored ? 1 : 0];
  if (index >= 0) return index;
  materials::Material material;
  material.name = colored ? "coloured" : "none";
  if (colored) material.diffuse = Vec3(1);
  CadMaterial cad;
  cad.base_color = material.diffuse;
  return index = add_material(std::move(material), std::move(cad));
}

std::int32_t Assembly::texture(const FileName& name, bool linear, SourceSpan where) {
  if (!context_.options.textures) return scene::kNone;
  std::string key(name.text);
  for (const std::string& including : name.including) key += '\n' + including;
  const auto [place, is_new] = texture_cache_.try_emplace({std::move(key), linear}, scene::kNone);
  if (!is_new) return place->second;
  const auto found = context_.read_named(name, where);
  if (!found) return scene::kNone;
  image::DecodedImage image;
  const image::ImageProblem problem = image::decode_image(
      as_bytes(*found->bytes), context_.options.limits.texture_bytes - texture_bytes_, image);
  if (problem.code) {
    context_.log.report(Code("W6004"), where,
                        fmt::format("{}: {}", in_quotes(context_.files.display_name(found->path)),
                                    problem.message));
    return scene::kNone;
  }
  texture_bytes_ += image.rgba.size();
  out_.scene.textures.push_back(
      {found->path, image.width, image.height, std::move(image.rgba), linear});
  return place->second = static_cast<std::int32_t>(out_.scene.textures.size() - 1);
}

Result<Imported> Assembly::finished() {
  if (triangles_ == 0 && !context_.full)
    context_.trouble(Code("E6501"), "no faces", context_.at(0, 0),
                     [] { return "the file has no faces, expected at least 1"; });
  context_.tell();
  if (triangles_ == 0) return failed;
  out_.scene.inputs = std::move(context_.inputs);
  return std::move(out_);
}

}  // namespace panwright::importers::meshes
