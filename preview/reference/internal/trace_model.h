// Materials, textures and decals of a model, ready for paths: the part independent of a world.
// Private to preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "pan/model.h"
#include "preview/reference/internal/facets.h"
#include "preview/reference/internal/scatter.h"
#include "preview/reference/internal/tangents.h"
#include "trace/model.h"
#include "trace/scene.h"

namespace panwright::preview::reference {

// Hit point of a ray, in the model's frame.
struct Point {
  Vec3 start{0};    // origin of further rays: past the chord error, towards the smooth surface
  Vec3 normal{0};   // as shaded, unit, on the visible side
  Vec3 tangent{0};  // along u of the texture coordinates, unit and perpendicular to the normal;
                    // 0: none
  Vec3 tint{1};     // multiplies the diffuse colour
  const Scatter* scatter = nullptr;
  std::optional<Facets> facets;  // relief of terrain that its triangles leave out
  std::optional<Scatter> own;    // with maps of roughness and reflectance: replaces scatter
  Vec3 emitted{0};               // radiance for an irradiance of 1

  const Scatter& surface() const { return own ? *own : *scatter; }
};

class TraceModel {
 public:
  // Fixed data of an instance. Numbered as in the model.
  struct Part : trace::Model::Part {
    std::uint32_t material = 0;
    const TangentField* tangents = nullptr;  // with a normal map, or an anisotropic BRDF
    double offset = 0;       // mesh metres: past its chord error and float's rounding
    double flat_offset = 0;  // past float's rounding
    Vec3 diffuse{0};         // colour of the material
    Vec3 emitted{0};         // radiance for an irradiance of 1
    std::uint32_t scatter = 0;
    std::uint32_t cell_parts = 0;        // of scatters_: cell, grid line, gap; 0: no solar cells
    bool diffuse_in_tint = false;        // the tint is the whole diffuse colour, decals over it
    std::array<Vec3, 2> part_diffuse{};  // then of cells and grid lines; weights included
    std::int32_t texture = -1, albedo = -1, normal = -1, roughness = -1,
                 reflectance = -1;      // textures
    std::vector<std::uint32_t> decals;  // from the lowest
    std::int32_t back = -1;             // into backs_; -1: both sides are alike
    bool is_back = false;               // material of a back
    bool plain = false;                 // of plain_scatter()
  };

  // Textures are read in place.
  TraceModel(std::shared_ptr<const trace::Model> traced, const Job& job);
  TraceModel(const TraceModel&) = delete;
  TraceModel& operator=(const TraceModel&) = delete;

  // The model itself, held by its tracer.
  const std::shared_ptr<const trace::Model>& traced() const { return traced_; }

  // flat: by the triangles' own normals.
  Point point(const trace::Placement& placement, const trace::Hit& hit, bool flat) const;

  // Expects: a hit on terrain of the target. flat: as point().
  //   size  metres of the ground that albedo maps are a mean of; 0: the finest
  Point ground_point(const trace::Target& target, const trace::Hit& hit, bool flat,
                     double size) const;

  // Scatters of materials, cells and parts with decals.
  std::span<const Scatter> scatters() const { return scatters_; }
  // Returns the number of the scatter of a hit where the angle of incidence alone decides the light
  // that returns to its source: no maps, decals, cells, colours of vertices or directions; -1:
  // other surfaces.
  std::int32_t plain_scatter(const trace::Hit& hit) const {
    if (hit.part == trace::Hit::kGround) return -1;
    const Part& part = seen(hit.part, parts_[hit.part].closed || hit.front);
    return part.plain ? static_cast<std::int32_t>(part.scatter) : -1;
  }

  // Returns whether a part, or a cell of it, has mirrors or a smooth coat on one of its sides.
  bool may_mirror(std::uint32_t part) const;

 private:
  struct Decal {
    Mat4 decal_from_mesh;  // the mesh's coordinates, its origin added
    Vec3 size;             // width, height, depth
    std::uint32_t texture;
  };

  void add_parts();
  void wear(Part& part, const pan::layout::Instance& instance, std::uint32_t material, bool back);
  void lay_decals_over(Part& part);
  // Returns the visible side of a part.
  const Part& seen(std::uint32_t part, bool front) const {
    const Part& outside = parts_[part];
    return front || outside.back < 0 ? outside : backs_[static_cast<std::size_t>(outside.back)];
  }
  void add_tangents(const Job& job);
  void add_decals();
  // of a solar cell: 0, a cell or no cells at all, 1 a grid line, 2 a gap
  std::uint32_t cell_part_at(const Part& part, const trace::Place& place) const;
  Vec3 bumped(const Part& part, const TangentField::At& tangent, const Vec3& normal, const Vec2& at,
              double& length) const;
  Vec3 texel_color(const Part& part, std::int32_t texture, const Vec2& at) const;
  Vec3 color(const Part& part, const trace::Place& place) const;
  Vec3 decorated(const Part& part, const Vec3& position, const Vec3& normal, bool front,
                 Vec3 color) const;

  std::shared_ptr<const trace::Model> traced_;
  const pan::Model* model_;
  std::span<const trace::Texture> textures_;    // the model's
  std::vector<materials::Material> materials_;  // the model's
  // one for each of materials_, then the parts of solar cells and those of parts with decals
  std::vector<Scatter> scatters_;
  std::vector<std::uint32_t> parts_of_;  // Part::cell_parts of each of materials_
  std::vector<Part> parts_;
  std::vector<Part> backs_;
  std::vector<Decal> decals_;                            // the model's
  std::vector<std::unique_ptr<TangentField>> tangents_;  // one per mesh; null: none
};

}  // namespace panwright::preview::reference
