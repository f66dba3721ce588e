#include "importers/internal/painter.h"

#include <algorithm>
#include <utility>

#include "base/text.h"

namespace panwright::importers {

Cover Painter::cover_of(std::int32_t paint) {
  if (paint == scene::kNone) return {};
  const auto [known, is_new] = covers_.try_emplace(paint);
  if (!is_new) return known->second;
  const Paint& from = paints_[static_cast<std::size_t>(paint)];
  materials::Material material;
  material.name = from.name.empty() ? "none" : to_utf8(from.name, Encoding::utf8);
  CadMaterial cad;
  cad.name = from.name;
  Cover& cover = known->second;
  if (!from.texture.empty()) cover.texture = texture_of(from);
  cad.textured = cover.texture != scene::kNone;
  if (cad.textured) material.diffuse = Vec3(1);
  if (from.rgba) {
    const auto& rgba = *from.rgba;
    for (int k = 0; k < 3; ++k)
      material.diffuse[k] = std::clamp(rgba[static_cast<std::size_t>(k)], 0.0, 1.0);
    if (Vec3(rgba[0], rgba[1], rgba[2]) != material.diffuse)
      cad.lost.emplace_back("colours outside of 0 to 1");
    cad.opacity = std::clamp(rgba[3], 0.0, 1.0);
  }
  cad.base_color = material.diffuse;
  cover.material = assembly_.add_material(std::move(material), std::move(cad));
  return cover;
}

std::int32_t Painter::texture_of(const Paint& paint) {
  std::string_view name = paint.texture;
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    name.remove_prefix(scheme.size());
    const std::size_t slash = name.find('/');
    if (slash != name.npos && !c_.has_named(name, c_.file.path) &&
        c_.has_named(name.substr(slash + 1), c_.file.path))
      name.remove_prefix(slash + 1);
  }
  return assembly_.texture(name, c_.file.path, false, paint.texture_at);
}

}  // namespace panwright::importers
