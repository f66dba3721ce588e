// A model with its pictures, ready for rays. Private to preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "geometry/instances.h"
#include "pan/model.h"
#include "preview/internal/decals.h"
#include "preview/internal/draw_list.h"
#include "preview/internal/map_levels.h"
#include "preview/internal/tangents.h"
#include "preview/reference/internal/scatter.h"

namespace panwright::preview::reference {

// A point of the model that a ray has hit, in the model's frame.
struct Point {
  Vec3 start{0};    // where rays leave it: past the chord error, towards the smooth surface
  Vec3 normal{0};   // as shaded, unit, on the side that is seen
  Vec3 tangent{0};  // along u of the texture coordinates, unit and square to the normal; 0: none
  Vec3 tint{1};     // multiplies the diffuse colour
  const Scatter* scatter = nullptr;
  std::optional<Scatter> own;  // of maps of roughness and reflectance, in the place of scatter
  Vec3 emitted{0};             // radiance for an irradiance of 1

  const Scatter& surface() const { return own ? *own : *scatter; }
};

// Everything in the model's frame.
class Stage {
 public:
  explicit Stage(const pan::Model& model);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  std::span<const DrawItem> items() const { return items_; }

  // What the camera sees: not the back faces of closed meshes, and through holes.
  std::optional<geometry::InstanceHit> seen(const geometry::Ray& ray) const;
  // The nearest surface, holes apart; insides of closed meshes count.
  std::optional<geometry::InstanceHit> closest(const geometry::Ray& ray) const;
  bool any(const geometry::Ray& ray) const;

  bool is_inside(const geometry::InstanceHit& hit) const {
    return items_[hit.instance].closed && !hit.front;
  }

  // flat: by the triangles' own normals.
  Point point(const geometry::InstanceHit& hit, bool flat) const;

 private:
  // What of an instance rays ask for.
  struct Item {
    pan::MeshView mesh;
    const Tangents* tangents = nullptr;  // with a normal map, or a law that has a direction
    double offset = 0;                   // mesh metres: past its chord error and float's rounding
    double flat_offset = 0;              // past float's rounding
    Vec3 diffuse{0};                     // colour of the material
    Vec3 emitted{0};                     // radiance for an irradiance of 1
    std::uint32_t scatter = 0;
    std::uint32_t cell_parts = 0;        // of scatters_: cell, grid line, gap; 0: no solar cells
    bool diffuse_in_tint = false;        // the tint is the whole diffuse colour, decals over it
    std::array<Vec3, 2> part_diffuse{};  // then of cells and grid lines; weights included
    std::int32_t texture = -1, albedo = -1, normal = -1, roughness = -1, reflectance = -1,
                 cutout = -1;           // pictures
    std::vector<std::uint32_t> decals;  // from the lowest
    std::vector<std::uint32_t> decal_pictures;
  };
  // Where a hit lies in its triangle.
  struct Place {
    std::array<std::uint32_t, 3> corner{};
    Vec3 weight{0};
  };
  using PictureKey = std::tuple<std::int32_t, TextureRole, float>;

  std::int32_t picture(std::int32_t texture, TextureRole role, float threshold);
  Item make_item(const DrawItem& item);
  void add_meshes();
  Place place(const Item& item, const geometry::InstanceHit& hit) const;
  // of a solar cell: 0, a cell or no cells at all, 1 a grid line, 2 a gap
  std::uint32_t part_at(const DrawItem& draw, const Item& item, const Place& place) const;
  Vec2 plain_texcoord(const Item& item, const Place& place) const;
  Vec2 map_texcoord(const DrawItem& draw, const Item& item, const Place& place) const;
  bool is_there(const geometry::InstanceHit& hit) const;
  Vec4 tangent(const Item& item, const geometry::InstanceHit& hit, const Place& place) const;
  Vec3 bumped(const DrawItem& draw, const Item& item, const Vec4& tangent, const Vec3& normal,
              const Vec2& at, double& length) const;
  Vec3 texel_colour(const DrawItem& draw, std::int32_t picture, const Vec2& at) const;
  Vec3 colour(const DrawItem& draw, const Item& item, const Place& place, const Vec2& at) const;
  Vec3 decorated(const Item& item, const Vec3& position, const Vec3& normal, bool front,
                 Vec3 colour) const;
  static bool hole_filter(const void* stage, const geometry::InstanceHit& hit);
  static bool seen_filter(const void* stage, const geometry::InstanceHit& hit);

  const pan::Model& model_;
  std::vector<DrawItem> items_;
  std::vector<Item> placed_;                    // one for each of items_
  std::vector<materials::Material> materials_;  // the model's
  // one for each of materials_, then the parts of solar cells and those of items with decals
  std::vector<Scatter> scatters_;
  std::vector<std::uint32_t> parts_of_;  // Item::cell_parts of each of materials_
  std::vector<TextureLevel> pictures_;
  std::map<PictureKey, std::int32_t> picture_of_;
  std::vector<PlacedDecal> decals_;
  std::vector<std::optional<Tangents>> tangents_;  // one for each mesh
  geometry::InstanceCaster caster_;
  bool has_holes_ = false;
};

}  // namespace panwright::preview::reference
