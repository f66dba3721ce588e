// Readers of single elements: frames, shapes.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "base/job.h"
#include "base/work_cache.h"
#include "geometry/tessellate/shape.h"
#include "mli/form.h"
#include "mli/trim.h"
#include "pxn/expression/values.h"
#include "pxn/reader/part.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Reads a <frame_s>: its origin and axes.
//
// Fails (nullopt): E1201 to E1203, E1207. Reports: N1208.
std::optional<PartFrame> read_frame_axes(const xml::Document& document, std::uint32_t element,
                                         Values& values, Reporter& reporter);

// Returns node_from_frame of a frame that looks along a direction, with another at the top of its
// image (x right, y down, z forward). Any lengths; nothing when they are 0 or within 1e-6 rad of
// parallel.
std::optional<Quat> looking(Vec3 forward, Vec3 up);

// Returns a vector of length 1 in a direction; none for 0. One of unit length keeps its bits.
std::optional<Vec3> unit_vector(const Vec3& v);

// Returns true if a text can be a name in expressions. Reports E1221 otherwise, and E1210 for that
// of a constant or a function.
bool check_name(const xml::Document& document, std::uint32_t element, SourceSpan where,
                const std::string& name, Reporter& reporter);

// Reads a shape that is not a mesh.
//
//   returns  valid by geometry::problem_of; nothing if something is missing or invalid
//
// Reports: E1201 to E1203, E1212 to E1224, E2001, E2002, E2010 to E2018, E2026, E2027, W2006,
// W2007, W2009, W2019, W2028.
std::optional<geometry::Shape> read_exact_shape(const xml::Document& document,
                                                std::uint32_t element, const Units& units,
                                                Values& values, Reporter& reporter);

// Reads a <mesh>: strips to triangles, normals made unit or computed.
//
//   returns  valid by scene::check, with at least one triangle; null if too little is readable
//
// Reports: E1201 to E1203, W1205, E2001, E2002, E2004, N2005, W2006 to W2009.
// Cost: O(bytes + T log(triangles at a vertex)).
std::shared_ptr<const geometry::Mesh> read_mesh_shape(const xml::Document& document,
                                                      std::uint32_t element, double crease_angle,
                                                      Values& values, Reporter& reporter);

// Sheet of foil as written.
struct FoilSheet {
  mli::Recipe recipe;
  mli::Form form;
  mli::Trim trim;
  mli::RecipePlaces places;
  bool levels = true;

  // Returns a key; equal for equal sheets.
  std::vector<double> key() const;
};

// Reads an <mli>.
//
// Reports: E1201 to E1203, E1212 to E1224, E7001.
std::optional<FoilSheet> read_foil(const xml::Document& document, std::uint32_t element,
                                   Values& values, Reporter& reporter);

// Reads an <mli> of type wrap.
//
// Reports: as read_foil().
std::optional<PartWrap> read_wrap(const xml::Document& document, std::uint32_t element,
                                  Values& values, Reporter& reporter);

// Returns a key; equal for equal blankets.
std::vector<double> key_of(const Blanket& blanket);

// Returns the preset of that name, empty for another ("none").
std::string_view foil_named(std::string_view name);

// Limit of vertices of all sheets of a model, about 90 bytes each.
inline constexpr double kMaxFoilVertices = 20e6;

// Meshes of a sheet, with normals.
struct FoilMeshes {
  struct Part {
    std::shared_ptr<const geometry::Mesh> finest;  // at the recipe's own detail; null: none
    std::vector<scene::FoilLevel> levels;
  };
  std::array<Part, mli::kCovers> parts;  // by mli::Cover
  mli::Statistics statistics;            // of the flat sheet
  double vertices = 0;                   // of all
};

// Makes the meshes; nothing on failure.
//
//   room   vertices that may still be made
//   cache  null: none
//
// Reports: E7001, W7002. Throws Cancelled. Cost: O(vertices · operations).
std::optional<FoilMeshes> make_foil(const xml::Document& document, std::uint32_t element,
                                    const FoilSheet& foil, double crease_angle, double room,
                                    const WorkCache* cache, Reporter& reporter, const Job& job);

}  // namespace panwright::pxn
