// Model with its textures, ready for rays: the part independent of a world. Private to
// preview/reference.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job.h"
#include "geometry/ray/instances.h"
#include "pan/model.h"
#include "preview/reference/internal/placement.h"
#include "preview/reference/internal/scatter.h"
#include "preview/reference/internal/tangents.h"
#include "preview/reference/internal/texture.h"
#include "world/world.h"

namespace panwright::preview::reference {

// Hit point of a ray, in the model's frame.
struct Point {
  Vec3 start{0};    // origin of further rays: past the chord error, towards the smooth surface
  Vec3 normal{0};   // as shaded, unit, on the visible side
  Vec3 tangent{0};  // along u of the texture coordinates, unit and perpendicular to the normal;
                    // 0: none
  Vec3 tint{1};     // multiplies the diffuse colour
  const Scatter* scatter = nullptr;
  std::optional<Scatter> own;  // with maps of roughness and reflectance: replaces scatter
  Vec3 emitted{0};             // radiance for an irradiance of 1

  const Scatter& surface() const { return own ? *own : *scatter; }
};

// Placement of an instance in the model's frame.
struct Placement {
  Affine model_from_mesh;  // of float positions, the mesh's origin included
  Mat3 normals{1};         // maps outward normals to outward normals of any length
};

class TraceModel {
 public:
  // Fixed data of an instance. Numbered as in the model.
  struct Part {
    pan::MeshView mesh;
    std::uint32_t mesh_index = 0;
    std::uint32_t node = 0;
    std::uint32_t material = 0;
    Vec3 origin{0};        // of the mesh
    Vec3 low{0}, high{0};  // bounds of the float positions
    bool closed = false;   // its inside is invisible: closed, and without holes
    bool has_holes = false;
    const TangentField* tangents = nullptr;  // with a normal map, or an anisotropic BRDF
    double offset = 0;       // mesh metres: past its chord error and float's rounding
    double flat_offset = 0;  // past float's rounding
    Vec3 diffuse{0};         // colour of the material
    Vec3 emitted{0};         // radiance for an irradiance of 1
    std::uint32_t scatter = 0;
    std::uint32_t cell_parts = 0;        // of scatters_: cell, grid line, gap; 0: no solar cells
    bool diffuse_in_tint = false;        // the tint is the whole diffuse colour, decals over it
    std::array<Vec3, 2> part_diffuse{};  // then of cells and grid lines; weights included
    Vec2 repeat{1};                      // of the texture coordinates, for maps
    std::int32_t texture = -1, albedo = -1, normal = -1, roughness = -1, reflectance = -1,
                 cutout = -1;           // textures
    double threshold = 0;               // of the cutout
    std::vector<std::uint32_t> decals;  // from the lowest
    std::int32_t back = -1;             // into backs_; -1: both sides are alike
    bool is_back = false;               // material of a back
  };

  // Expects: checked. Cost: about 150 bytes a triangle; textures are read in place.
  TraceModel(world::ModelPtr model, const Job& job);
  TraceModel(const TraceModel&) = delete;
  TraceModel& operator=(const TraceModel&) = delete;

  const world::ModelPtr& model() const { return model_; }
  std::span<const Part> parts() const { return parts_; }
  // Returns the search mesh of a placed mesh; null for others.
  const geometry::SearchMesh& search_mesh(std::uint32_t mesh) const { return meshes_[mesh]; }
  Placement placement(std::uint32_t part, const PlacedNodes& nodes) const;

  // Returns false in a hole.
  bool is_there(std::uint32_t part, const geometry::InstanceHit& hit) const;

  // flat: by the triangles' own normals.
  Point point(std::uint32_t part, const Placement& placement, const geometry::InstanceHit& hit,
              bool flat) const;

  // Returns the normal on the visible side, without a normal map, in the model's frame: unit, or 0.
  Vec3 normal(std::uint32_t part, const Placement& placement, const geometry::InstanceHit& hit,
              bool flat) const;

 private:
  // Place of a hit in its triangle.
  struct Place {
    std::array<std::uint32_t, 3> corner{};
    Vec3 weight{0};
  };
  // Place on a mesh, in its own frame.
  struct Surface {
    Vec3 position;  // relative to the mesh's origin
    Vec3 facet;     // unit
    Vec3 smooth;    // interpolated; facet if flat
  };
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
  void add_meshes(const Job& job);
  void add_decals();
  Place place(const Part& part, const geometry::InstanceHit& hit) const;
  Surface surface(const Part& part, const Place& place, bool flat) const;
  // of a solar cell: 0, a cell or no cells at all, 1 a grid line, 2 a gap
  std::uint32_t cell_part_at(const Part& part, const Place& place) const;
  Vec2 texcoord(const Part& part, const Place& place) const;
  Vec3 bumped(const Part& part, const TangentField::At& tangent, const Vec3& normal, const Vec2& at,
              double& length) const;
  Vec3 texel_color(const Part& part, std::int32_t texture, const Vec2& at) const;
  Vec3 color(const Part& part, const Place& place) const;
  Vec3 decorated(const Part& part, const Vec3& position, const Vec3& normal, bool front,
                 Vec3 color) const;

  world::ModelPtr model_;
  std::vector<Texture> textures_;               // the model's
  std::vector<materials::Material> materials_;  // the model's
  // one for each of materials_, then the parts of solar cells and those of parts with decals
  std::vector<Scatter> scatters_;
  std::vector<std::uint32_t> parts_of_;  // Part::cell_parts of each of materials_
  std::vector<Part> parts_;
  std::vector<Part> backs_;
  std::vector<Decal> decals_;                            // the model's
  std::vector<std::unique_ptr<TangentField>> tangents_;  // one per mesh; null: none
  std::vector<geometry::SearchMesh> meshes_;             // one per mesh
};

}  // namespace panwright::preview::reference
