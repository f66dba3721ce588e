#include "importers/vrml/internal/builder.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/file.h"
#include "base/text.h"
#include "image/decode.h"
#include "image/gif.h"
#include "importers/internal/placed_node.h"

namespace panwright::importers::vrml {

namespace {

// Of materials that are equal to the scene.
bool same(const CadMaterial& a, const CadMaterial& b) {
  return a.name == b.name && a.base_color == b.base_color && a.metallic == b.metallic &&
         a.roughness == b.roughness && a.opacity == b.opacity && a.textured == b.textured &&
         a.lost.empty() && b.lost.empty();
}

Vec3 clamped(const Vec3& v) { return glm::clamp(v, Vec3(0), Vec3(1)); }

// "Fog (2), Viewpoint"
std::string listed(const std::map<std::string, std::uint64_t, std::less<>>& counts) {
  std::string out;
  for (const auto& [what, count] : counts) {
    if (!out.empty()) out += ", ";
    out += count == 1 ? what : fmt::format("{} ({})", what, count);
  }
  return out;
}

}  // namespace

Builder::Builder(ReaderContext& of) : context(of) {
  scene::Node root;
  root.name = "root";
  out_.scene.nodes.push_back(root);
}

scene::Source Builder::source_of(SourceSpan where) {
  if (where.file == kNoFile) return {};
  if (once) {
    const Position at = context.log.sources().position(where.file, where.begin);
    return {context.path_of(where.file), at.line, at.column};
  }
  // note: nodes that are shared ask for the same places again and again
  const auto [it, added] = positions_.try_emplace(std::uint64_t{where.file} << 32 | where.begin);
  if (added) it->second = context.log.sources().position(where.file, where.begin);
  return {context.path_of(where.file), it->second.line, it->second.column};
}

std::int32_t Builder::add_node(std::int32_t parent, const Mat4& parent_from_node,
                               std::string_view name, std::string_view kind, SourceSpan where) {
  context.job.poll();
  std::optional<scene::Decomposed> parts = scene::Decomposed{};
  if (parent_from_node != Mat4(1)) parts = scene::decomposed(parent_from_node);
  if (!parts) {
    context.log.report(Code("W6009"), where, "its transform flattens its contents");
    return scene::kNone;
  }
  auto& nodes = out_.scene.nodes;
  if (nodes.size() + 1 >= context.options.limits.nodes) throw OverLimit{"nodes", where};
  scene::Node node;
  node.name = name;
  std::replace(node.name.begin(), node.name.end(), '/', '_');
  if (node.name.empty()) node.name = fmt::format("{}{}", kind, ++kinds_[std::string(kind)]);
  node.parent = parent;
  node.source = source_of(where);
  return add_placed(nodes, std::move(node), *parts);
}

std::int32_t Builder::add_shape(geometry::Shape shape, SourceSpan where) {
  context.job.poll();
  if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape)) {
    const std::uint64_t count = (*mesh)->triangles.size();
    if (count > context.options.limits.triangles - triangles_) throw OverLimit{"triangles", where};
  }
  const auto [place, added] = shapes_.try_emplace(geometry::hash_of(shape), 0);
  if (!added) return place->second;
  if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape))
    triangles_ += (*mesh)->triangles.size();
  place->second = static_cast<std::int32_t>(out_.scene.shapes.size());
  out_.scene.shapes.push_back(std::move(shape));
  return place->second;
}

std::int32_t Builder::add_material(const materials::Material& material, const CadMaterial& cad) {
  std::pair key(material.name, materials::key_of(material));
  const auto [first, last] = materials_.equal_range(key);
  for (auto it = first; it != last; ++it)
    if (same(out_.materials[static_cast<std::size_t>(it->second)], cad)) return it->second;
  const auto index = static_cast<std::int32_t>(out_.scene.materials.size());
  out_.scene.materials.push_back(material);
  out_.materials.push_back(cad);
  materials_.emplace(std::move(key), index);
  return index;
}

std::int32_t Builder::add_phong(const Phong& phong, std::string_view name, bool textured,
                                SourceSpan where) {
  materials::Material material;
  material.name = name;
  material.diffuse = clamped(phong.diffuse);
  const Vec3 specular = clamped(phong.specular);
  const double shininess = std::clamp(phong.shininess, 0.0, 1.0);
  CadMaterial cad;
  if (specular != Vec3(0)) {
    constexpr double kMostShine = 128;  // ISO/IEC 14772-1, 4.14.4: the exponent is 128·shininess
    material.specular = specular;
    const double shine = kMostShine * shininess;
    material.specular_brdf = materials::BlinnPhong{shine};
    material.weights.y = 1;
    // α² = 2/(n + 2), and α is the square of the perceptual roughness
    cad.roughness = std::sqrt(std::sqrt(2 / (shine + 2)));
  }
  material.emissive = clamped(phong.emissive);
  if (material.emissive != Vec3(0)) material.weights.z = 1;
  const double transparency = std::clamp(phong.transparency, 0.0, 1.0);
  if (material.diffuse != phong.diffuse || specular != phong.specular ||
      material.emissive != phong.emissive || shininess != phong.shininess ||
      transparency != phong.transparency)
    lost("values outside of 0 to 1", where);
  materials::fit(material);
  cad.name = name;
  cad.where = where;
  cad.base_color = material.diffuse;
  cad.opacity = 1 - transparency;
  cad.textured = textured;
  return add_material(material, cad);
}

std::int32_t Builder::add_texture(scene::Texture texture) {
  bool grey = true;
  for (std::size_t i = 0; i + 3 < texture.rgba.size() && grey; i += 4)
    grey = texture.rgba[i] == texture.rgba[i + 1] && texture.rgba[i] == texture.rgba[i + 2];
  grey_.push_back(grey);
  out_.scene.textures.push_back(std::move(texture));
  return static_cast<std::int32_t>(out_.scene.textures.size() - 1);
}

bool Builder::is_grey(std::int32_t texture) const {
  return texture >= 0 && grey_[static_cast<std::size_t>(texture)];
}

std::int32_t Builder::kept_texture(scene::Texture texture, SourceSpan where) {
  if (texture.rgba.size() > context.options.limits.texture_bytes - texture_bytes_) {
    context.log.report(Code("W6004"), where, "the textures are larger than the limit");
    return scene::kNone;
  }
  texture_bytes_ += texture.rgba.size();
  return add_texture(std::move(texture));
}

std::int32_t Builder::add_texture(std::span<const std::string_view> urls, SourceSpan where) {
  if (!context.options.textures || urls.empty()) return scene::kNone;
  std::string key = context.path_of(where.file);
  for (const std::string_view url : urls) key.append(1, '\0').append(url);
  const auto [asked, first] = asked_.try_emplace(key, scene::kNone);
  if (!first) return asked->second;
  std::string path;
  const auto bytes = context.bytes_of(urls, where, &path);
  if (!bytes) return scene::kNone;
  const auto [texture, unread] = texture_cache_.try_emplace(path, scene::kNone);
  if (unread) {
    image::DecodedImage image;
    const std::uint64_t left = context.options.limits.texture_bytes - texture_bytes_;
    const auto packed = as_bytes(*bytes);
    const image::ImageProblem problem = image::is_gif(packed)
                                            ? image::decode_gif(packed, left, image)
                                            : image::decode_image(packed, left, image);
    if (problem.code)
      context.log.report(
          Code("W6004"), where,
          fmt::format("{}: {}", in_quotes(context.files.display_name(path)), problem.message));
    else
      texture->second =
          kept_texture({path, image.width, image.height, std::move(image.rgba)}, where);
  }
  asked->second = texture->second;
  return asked->second;
}

std::int32_t Builder::add_image(std::span<const std::int32_t> image, SourceSpan where) {
  if (!context.options.textures || image.size() < 4) return scene::kNone;
  const auto width = static_cast<std::uint32_t>(image[0]);
  const auto height = static_cast<std::uint32_t>(image[1]);
  const std::int32_t components = image[2];
  if (width > image::kMaxTextureSide || height > image::kMaxTextureSide || components == 0) {
    context.log.report(Code("W6004"), where, "an image of a size that is not used");
    return scene::kNone;
  }
  scene::Texture texture{"SFImage", width, height, {}};
  texture.rgba.resize(std::size_t{4} * width * height);
  for (std::uint32_t row = 0; row < height; ++row) {
    for (std::uint32_t column = 0; column < width; ++column) {
      const std::size_t from = std::size_t{height - 1 - row} * width + column;
      const auto bits = static_cast<std::uint32_t>(image[3 + from]);
      const auto byte = [&](int n) { return static_cast<std::uint8_t>(bits >> (8 * n)); };
      std::uint8_t* to = texture.rgba.data() + 4 * (std::size_t{row} * width + column);
      const bool grey = components <= 2;
      const bool alpha = components == 2 || components == 4;
      const int low = alpha ? 1 : 0;
      to[0] = byte(grey ? low : low + 2);
      to[1] = byte(grey ? low : low + 1);
      to[2] = byte(low);
      to[3] = alpha ? byte(0) : 255;
    }
  }
  return kept_texture(std::move(texture), where);
}

void Builder::add_instance(std::int32_t node, std::int32_t shape, std::int32_t material,
                           std::int32_t texture, SourceSpan where) {
  auto& instances = out_.scene.instances;
  if (instances.size() >= context.options.limits.nodes) throw OverLimit{"nodes", where};
  scene::Instance instance;
  instance.node = node;
  instance.shape = shape;
  instance.material = material;
  instance.texture = texture;
  instance.source = source_of(where);
  instances.push_back(std::move(instance));
}

void Builder::skipped(std::string_view type) {
  const auto place = skipped_.find(type);
  if (place != skipped_.end())
    ++place->second;
  else
    skipped_.emplace(type, 1);
}

void Builder::lost(std::string_view property, SourceSpan where) { lost_.add(property, where); }

bool Builder::enter(const Node& node) {
  if (std::find(open_nodes_.begin(), open_nodes_.end(), &node) != open_nodes_.end()) {
    context.log.report(Code("E6109"), node.where,
                       fmt::format("this {} contains itself", in_quotes(node.type)));
    return false;
  }
  if (open_nodes_.size() >= context.options.limits.depth) throw OverLimit{"depth", node.where};
  if (++visits_ > context.options.limits.nodes) throw OverLimit{"nodes", node.where};
  open_nodes_.push_back(&node);
  return true;
}

void Builder::leave(const Node&) { open_nodes_.pop_back(); }

bool Builder::enter(const Document& document, SourceSpan where) {
  if (std::find(open_documents_.begin(), open_documents_.end(), &document) !=
      open_documents_.end()) {
    context.log.report(
        Code("E6109"), where,
        fmt::format("{} contains itself", in_quotes(context.files.display_name(document.path))));
    return false;
  }
  open_documents_.push_back(&document);
  return true;
}

void Builder::leave(const Document&) { open_documents_.pop_back(); }

void Builder::lost_clamping(std::int32_t shape, bool repeat_s, bool repeat_t, SourceSpan where) {
  const auto* mesh =
      std::get_if<geometry::MeshShape>(&out_.scene.shapes[static_cast<std::size_t>(shape)]);
  if (mesh == nullptr) return;
  const auto leaves = [](double at) { return at < 0 || at > 1; };
  for (const Vec2& at : (*mesh)->texcoords)
    if ((!repeat_s && leaves(at.x)) || (!repeat_t && leaves(at.y)))
      return lost("textures that do not repeat", where);
}

Imported Builder::finished(Format format, std::string_view file_name) {
  out_.format = format;
  out_.scene.inputs = context.further_inputs;
  if (!skipped_.empty())
    context.log.report_file(Code("N6007"), file_name, fmt::format("skipped: {}", listed(skipped_)));
  lost_.report({}, context.log);
  return std::move(out_);
}

void build(Builder& builder, Document& document, std::int32_t parent) {
  if (document.format == Format::vrml1)
    build10(builder, document, parent);
  else
    build97(builder, document, parent);
}

}  // namespace panwright::importers::vrml
