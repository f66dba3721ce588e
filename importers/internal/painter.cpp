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
  cad.where = from.where;
  Cover& cover = known->second;
  if (!from.texture.empty()) {
    FileName name{.text = from.texture, .including = from.including};
    if (name.including.empty()) name.including.push_back(c_.file.path);
    cover.texture = assembly_.texture(name, false, from.texture_at);
  }
  cad.textured = cover.texture != scene::kNone;
  if (cad.textured) material.diffuse = Vec3(1);
  if (from.rgba) {
    const auto& rgba = *from.rgba;
    for (int k = 0; k < 3; ++k)
      material.diffuse[k] = std::clamp(rgba[static_cast<std::size_t>(k)], 0.0, 1.0);
    cad.opacity = std::clamp(rgba[3], 0.0, 1.0);
    if (Vec3(rgba[0], rgba[1], rgba[2]) != material.diffuse || rgba[3] != cad.opacity)
      cad.lost.push_back({"values outside of 0 to 1", from.where});
  }
  cad.base_color = material.diffuse;
  cover.material = assembly_.add_material(std::move(material), std::move(cad));
  return cover;
}

}  // namespace panwright::importers
