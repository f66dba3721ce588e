// Default values of attributes: nested classes.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "importers/internal/xml_text.h"

namespace panwright::importers::mjcf {

class Classes {
 public:
  Classes(const XmlText& text, meshes::ReaderContext& context) : text_(text), c_(context) {}

  // Reads a <default> below the root; several continue each other. Reports E6220.
  void read(const pugi::xml_node& element);

  // Returns the class named by an element, else the surrounding one. Reports E6220 for an unknown
  // name.
  std::size_t of(const pugi::xml_node& element, std::size_t around,
                 const char* attribute = "class");

  // Returns the attribute of an element, else that of its class or a surrounding one; else empty.
  pugi::xml_attribute find(const pugi::xml_node& element, const char* attribute,
                           std::size_t its_class) const;

  // Returns the element itself, then those of its name in its class and the classes around, nearest
  // first.
  std::vector<pugi::xml_node> levels(const pugi::xml_node& element, std::size_t its_class) const;

 private:
  static constexpr std::size_t kTop = 0;
  struct Class {
    std::size_t outer = kTop;  // itself for the outermost
    std::vector<pugi::xml_node> sections;
  };
  void add(const pugi::xml_node& element, std::size_t its_class, std::uint32_t depth);

  const XmlText& text_;
  meshes::ReaderContext& c_;
  std::vector<Class> classes_{1};
  std::unordered_map<std::string, std::size_t> by_name_{{"main", kTop}};
};

}  // namespace panwright::importers::mjcf
