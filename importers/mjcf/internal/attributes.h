// Values of attributes, with defaults of classes and the units of <compiler>.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "importers/mjcf/internal/classes.h"
#include "importers/mjcf/internal/model.h"

namespace panwright::importers::mjcf {

// Settings of <compiler>; later ones override earlier ones.
struct Compiler {
  double angle = kDegree;  // radians of a number
  std::string euler = "xyz";
  bool limits_by_range = true;  // autolimits
  std::string mesh_folder, texture_folder;
  bool strip_path = false;
};

class Attributes : public XmlValues {
 public:
  Attributes(const XmlText& text, meshes::ReaderContext& context)
      : XmlValues(text, context), text_(text), classes_(text, context) {}

  Classes& classes() { return classes_; }
  void read_compiler(const pugi::xml_node& element);
  const Compiler& compiler() const { return compiler_; }

  // Reads an element's attribute with the defaults of its class: least to most numbers. Nothing if
  // missing, or invalid: E6220.
  std::optional<std::vector<double>> numbers(const pugi::xml_node& element, const char* name,
                                             std::size_t its_class, std::size_t least,
                                             std::size_t most);
  double number_or(const pugi::xml_node& element, const char* name, std::size_t its_class,
                   double otherwise);
  std::optional<Vec3> vector(const pugi::xml_node& element, const char* name,
                             std::size_t its_class);
  // Reads one of the words, as its index; `otherwise` if missing or another: E6220.
  std::size_t word(const pugi::xml_node& element, const char* name, std::size_t its_class,
                   std::initializer_list<std::string_view> words, std::size_t otherwise);
  std::string text(const pugi::xml_node& element, const char* name, std::size_t its_class);

  // Reads pos and one of quat, axisangle, xyaxes, zaxis and euler.
  Pose pose(const pugi::xml_node& element, std::size_t its_class);

  // Normalises a direction; nothing, with E6220 at the attribute, for a zero vector.
  std::optional<Vec3> direction(const Vec3& v, SourceSpan where, std::string_view what);

  SourceSpan at(const pugi::xml_node& element) const { return text_.at(element); }
  // Returns the place of a written attribute, else of its element.
  SourceSpan at(const pugi::xml_node& element, const char* name, std::size_t its_class) const;

 private:
  std::optional<Quat> rotation(const pugi::xml_node& element);
  std::optional<Quat> from_euler(const pugi::xml_node& element);
  std::optional<Quat> from_axes(const pugi::xml_node& element);

  const XmlText& text_;
  Classes classes_;
  Compiler compiler_;
};

// Returns the smallest rotation from z to a direction; half a turn about x for the opposite.
Quat z_towards(const Vec3& unit);

}  // namespace panwright::importers::mjcf
