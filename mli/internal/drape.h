// Draping of a group of faces, finely or coarsely.
#pragma once

#include <vector>

#include "mli/corners.h"
#include "mli/internal/groups.h"
#include "mli/internal/piece.h"
#include "mli/internal/surface.h"
#include "mli/sheet.h"
#include "mli/wrap.h"

namespace panwright::mli {

// Target of blankets of one detail: the finest ones, or a level.
struct Cloth {
  geometry::Mesh mesh;
  std::vector<Vec3> roots, below;  // per position: the places on the faces, unit normals there
  std::vector<Cover> covers;       // per triangle
  double longest = 0;              // metres: longest edge on the faces
};

class Draper {
 public:
  // corners: of all faces with blankets; owner: the group's index there
  Draper(const Faces& faces, const WrapOptions& options, const Corners& corners,
         std::uint32_t owner, const Job& job)
      : faces_(faces), options_(options), corners_(corners), owner_(owner), job_(job) {}

  // Adds a group. False: more triangles than `left`.
  bool add(const Group& members, const Surface& surface, const Sheet& sheet, double left,
           WrapGroup& group, Cloth& cloth) const;
  // Adds the same group with longer edges than the sheet's cells; heights and normals are those of
  // the finest blanket at its vertices.
  bool add_level(const Group& members, const Surface& surface, const Sheet& sheet, double left,
                 const WrapGroup& group, Cloth& level) const;

 private:
  struct Draped;
  class Appender;

  bool cut(Draped& draped, const Group& members, double longest, double left) const;
  double height_at(const Draped& draped, const Vec3& place) const;
  void set_heights(Draped& draped, WrapGroup& group, bool level) const;
  double hold(const Draped& draped, std::vector<double>& heights) const;
  double share(const Draped& draped, std::vector<double>& heights) const;
  Vec3 normal_at(const Draped& draped, std::size_t v, const WrapGroup& group, double inwards) const;
  void add_seams(const Draped& draped, std::uint32_t base, const std::vector<Vec3>& tops,
                 bool level, Appender& out) const;
  void append(const Draped& draped, WrapGroup& group, Cloth& cloth, bool level) const;

  const Faces& faces_;
  const WrapOptions& options_;
  const Corners& corners_;
  std::uint32_t owner_;
  const Job& job_;
};

}  // namespace panwright::mli
