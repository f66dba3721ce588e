#include "importers/mjcf/internal/mesh_vertices.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/mesh/convex_hull.h"

namespace panwright::importers::mjcf {

namespace {

using geometry::Mesh;
using pugi::xml_node;

constexpr std::size_t kMostHullPoints = 100'000;
constexpr const char* kLeftOut = "; the mesh is left out";

class VertexMesh {
 public:
  VertexMesh(const xml_node& element, std::size_t its_class, Attributes& attributes,
             meshes::ReaderContext& context)
      : element_(element), class_(its_class), a_(attributes), c_(context) {}

  std::shared_ptr<const Mesh> read() {
    if (!given("vertex")) {
      wrong("file", "<mesh> has neither a file nor a vertex");
      return nullptr;
    }
    if (!read_vertices() || !(given("face") ? read_faces() : make_hull())) return nullptr;
    read_normals();
    read_texcoords();
    meshes::drop_unused(mesh_);
    meshes::finish_normals(mesh_, c_.options.crease_angle);
    return std::make_shared<const Mesh>(std::move(mesh_));
  }

 private:
  bool given(const char* name) const { return !a_.classes().find(element_, name, class_).empty(); }

  void wrong(const char* name, const std::string& message) {
    a_.wrong(a_.at(element_, name, class_), message + kLeftOut);
  }

  // Numbers of an attribute, `width` for each item. Nothing: reported, or over the limit.
  std::optional<std::vector<double>> list(const char* name, std::size_t width) {
    const auto attribute = a_.classes().find(element_, name, class_);
    // a number has two bytes at least, and takes eight; items are copied once more
    if (!c_.charge(12 * std::string_view(attribute.value()).size())) return std::nullopt;
    auto out = a_.numbers(element_, name, class_, 1, XmlValues::kAnyNumber);
    if (!out || out->size() % width == 0) return out;
    wrong(name, fmt::format("{} of <mesh> has {}, expected a multiple of {}", name,
                            counted(out->size(), "number"), width));
    return std::nullopt;
  }

  bool read_vertices() {
    const auto numbers = list("vertex", 3);
    if (!numbers) return false;
    for (std::size_t i = 0; i < numbers->size(); i += 3)
      mesh_.positions.emplace_back((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
    if (std::ranges::all_of(mesh_.positions, meshes::is_usable)) return true;
    wrong("vertex", "a vertex of <mesh> is out of range");
    return false;
  }

  bool read_faces() {
    const auto numbers = list("face", 3);
    if (!numbers) return false;
    const auto size = static_cast<double>(mesh_.positions.size());
    for (std::size_t i = 0; i < numbers->size(); i += 3) {
      geometry::Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        const double index = (*numbers)[i + k];
        if (!(index >= 0 && index < size && index == std::floor(index))) {
          wrong("face", fmt::format("face {} has vertex {} of {}", i / 3, format_double(index),
                                    mesh_.positions.size()));
          return false;
        }
        t[k] = static_cast<std::uint32_t>(index);
      }
      mesh_.triangles.push_back(t);
    }
    return true;
  }

  bool make_hull() {
    if (mesh_.positions.size() > kMostHullPoints) {
      wrong("vertex", fmt::format("{} points and no face, expected at most {} for a hull",
                                  mesh_.positions.size(), kMostHullPoints));
      return false;
    }
    auto hull = geometry::convex_hull(mesh_.positions, c_.file.job);
    if (!hull) {
      wrong("vertex", "the vertices lie in one plane and have no face, expected those of a body");
      return false;
    }
    mesh_.triangles = std::move(*hull);
    return true;
  }

  void read_normals() {
    if (!given("normal")) return;
    const auto numbers = list("normal", 3);
    if (!numbers || !fits("normal", numbers->size() / 3)) return;
    for (std::size_t i = 0; i < numbers->size(); i += 3)
      mesh_.normals.emplace_back((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
  }

  // MuJoCo counts v from the top of the image.
  void read_texcoords() {
    if (!given("texcoord")) return;
    const auto numbers = list("texcoord", 2);
    if (!numbers || !fits("texcoord", numbers->size() / 2)) return;
    for (std::size_t i = 0; i < numbers->size(); i += 2)
      mesh_.texcoords.emplace_back((*numbers)[i], 1 - (*numbers)[i + 1]);
  }

  bool fits(const char* name, std::size_t items) {
    if (items == mesh_.positions.size()) return true;
    a_.wrong(a_.at(element_, name, class_),
             fmt::format("{} of <mesh> has {} for {}; it is not used", name, counted(items, "item"),
                         mesh_.positions.size()));
    return false;
  }

  xml_node element_;
  std::size_t class_;
  Attributes& a_;
  meshes::ReaderContext& c_;
  Mesh mesh_;
};

}  // namespace

std::shared_ptr<const Mesh> mesh_of_vertices(const xml_node& element, std::size_t its_class,
                                             Attributes& attributes,
                                             meshes::ReaderContext& context) {
  return VertexMesh(element, its_class, attributes, context).read();
}

}  // namespace panwright::importers::mjcf
