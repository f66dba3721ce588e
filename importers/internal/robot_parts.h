// Common parts of the readers of robot descriptions, URDF and MJCF. Private to importers.
#pragma once

#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "importers/internal/mesh_parts.h"
#include "importers/internal/painter.h"
#include "importers/internal/xml_text.h"

namespace panwright::importers {

// Values of attributes, with reports at their places.
class XmlValues {
 public:
  XmlValues(const XmlText& text, meshes::ReaderContext& context) : text_(text), c_(context) {}

  void wrong(SourceSpan where, const std::string& message) const {
    c_.log.report(Code("E6220"), where, message);
  }
  void tolerated(SourceSpan where, const std::string& message) const {
    c_.log.report(Code("W6221"), where, message);
  }

  static constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);
  // Returns the least to most numbers of an attribute, for an element. Nothing if missing, or
  // invalid: E6220.
  std::optional<std::vector<double>> numbers(const pugi::xml_node& element,
                                             const pugi::xml_attribute& attribute,
                                             std::size_t least, std::size_t most) const;

 private:
  const XmlText& text_;
  meshes::ReaderContext& c_;
};

// Normalises a vector of any size; nothing for a zero vector.
std::optional<Vec3> unit_vector(const Vec3& v);

// Returns "did you mean 'NAME'?"; empty: no name is near.
std::string near_hint(std::string_view name, const std::vector<std::string_view>& names);

// Returns a name as scenes may have it: UTF-8 without slashes.
std::string scene_name(const std::string& name);

// Scene of a robot description, under construction.
class RobotScene {
 public:
  // The paints outlive this.
  RobotScene(const std::vector<Paint>& paints, meshes::ReaderContext& context, Format format)
      : assembly(context, format),
        meshes(context, assembly),
        painter(paints, context, assembly),
        c_(context) {}

  meshes::Assembly assembly;
  MeshParts meshes;
  Painter painter;

  scene::Scene& scene() { return assembly.out().scene; }
  scene::Node& node(std::int32_t index) { return scene().nodes[static_cast<std::size_t>(index)]; }

  // Adds a shape at a node; grey without a material. False: its sizes are out of range, which is
  // reported.
  bool add_shape(const geometry::Shape& shape, std::int32_t node, const Cover& cover,
                 SourceSpan where);
  // The same for a shape of the scene.
  void place_shape(std::int32_t shape, std::int32_t node, const Cover& cover, SourceSpan where);

  // Reports the collected problems and returns the result, in metres.
  Imported finished();

 private:
  meshes::ReaderContext& c_;
};

// Reads a robot description.
//
//   made   the scene of the text; nothing: the text has none
//   empty  message of a text without a scene and without another error
//
// Fails: E6002, E6220.
Result<Imported> read_robot_file(
    Files& files, const InputFile& file, const Options& options, DiagnosticLog& log,
    const std::function<std::optional<Imported>(XmlText&, meshes::ReaderContext&)>& made,
    const char* empty);

}  // namespace panwright::importers
