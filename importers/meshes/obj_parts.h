// Meshes from the faces of an OBJ file. Private to importers/meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "importers/internal/reader_context.h"

namespace panwright::importers::meshes {

// One corner: places in the lists of v, vt and vn from 0; −1: none.
struct ObjCorner {
  std::int32_t point = -1;
  std::int32_t texcoord = -1;
  std::int32_t normal = -1;
};

struct ObjFace {
  std::uint32_t end = 0;    // of its corners; they begin at the end of the previous face's
  std::uint32_t where = 0;  // byte of the file
};

// Smoothing of faces whose corners have no normals: the number of a group, or by crease angle. Also
// for "s off", which Blender writes by default, and which rarely means facets.
inline constexpr std::int64_t kByCrease = 0;

struct ObjLists {
  std::vector<Vec3> points;     // not finite: invalid
  std::vector<Vec3> colors;     // linear; as many as points, or none
  std::vector<Vec2> texcoords;  // (0,0) the image's bottom left
  std::vector<Vec3> normals;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
};

// Maker of the meshes of successive parts, which keeps its lists between them.
class ObjMesher {
 public:
  ObjMesher(ReaderContext& context, ObjLists& lists);

  struct Range {
    std::size_t begin = 0;
    std::size_t end = 0;  // of faces
    std::int64_t smoothing = kByCrease;
  };
  // Vertices are distinct (v, vt, vn, smoothing). Faces of one smoothing group share normals
  // whatever their angle, those of different ones none. After the last part the lists of faces are
  // cleared. Reports E6501, W6502.
  geometry::Mesh mesh_of(const std::vector<Range>& ranges, bool last);

 private:
  struct Key {
    ObjCorner corner;
    std::int64_t smoothing;  // kOwn: the normal is the file's
    bool operator==(const Key& other) const;
  };

  bool take_face(std::size_t face, std::vector<ObjCorner>& corners);
  std::uint32_t vertex(const Key& key);
  void add_face(const std::vector<ObjCorner>& corners, std::int64_t smoothing);
  geometry::Mesh finished();
  geometry::Mesh by_smoothing();
  void complete(geometry::Mesh& mesh, std::span<const Key> keys) const;

  ReaderContext& s_;
  ObjLists& l_;
  std::vector<std::uint32_t> first_;  // of each point, its newest vertex
  std::vector<Key> keys_;             // of each vertex
  std::vector<std::uint32_t> next_;   // of the same point
  geometry::Mesh mesh_;               // positions and triangles
  FaceCutter cutter_;
  std::vector<std::uint32_t> outline_;
  bool texcoords_ = false;  // some corner has some
  bool bare_ = false;       // some corner has none
};

}  // namespace panwright::importers::meshes
