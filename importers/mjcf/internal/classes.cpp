#include "importers/mjcf/internal/classes.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"

namespace panwright::importers::mjcf {

using pugi::xml_attribute;
using pugi::xml_node;

void Classes::read(const xml_node& element) {
  const std::string name = element.attribute("class").value();
  if (!name.empty()) by_name_.try_emplace(name, kTop);
  add(element, kTop, 1);
}

void Classes::add(const xml_node& element, std::size_t its_class, std::uint32_t depth) {
  classes_[its_class].sections.push_back(element);
  for (const xml_node child : element.children("default")) {
    const std::string name = child.attribute("class").value();
    if (depth >= c_.options.limits.depth)
      return c_.limit(fmt::format("classes are nested more than {} deep", c_.options.limits.depth),
                      text_.at(child));
    if (name.empty()) {
      c_.log.report(Code("E6220"), text_.at(child),
                    "a <default> inside another one has no class; it is left out");
      continue;
    }
    const auto [known, is_new] = by_name_.try_emplace(name, classes_.size());
    if (is_new) {
      classes_.push_back({its_class, {}});
    } else if (classes_[known->second].outer != its_class || known->second == kTop) {
      c_.log.report(Code("E6220"), text_.at(child),
                    fmt::format("duplicate class {}; the second one is left out", in_quotes(name)));
      continue;
    }
    add(child, known->second, depth + 1);
  }
}

std::size_t Classes::of(const xml_node& element, std::size_t around, const char* attribute) {
  const xml_attribute given = element.attribute(attribute);
  if (!given) return around;
  const auto known = by_name_.find(given.value());
  if (known != by_name_.end()) return known->second;
  std::vector<std::string_view> names;
  for (const auto& [name, index] : by_name_) names.push_back(name);
  std::ranges::sort(names);
  const auto near = nearest_name(given.value(), names);
  c_.log.report(Code("E6220"), text_.at(given),
                fmt::format("there is no class {}; the enclosing defaults are used",
                            in_quotes(given.value())),
                near ? fmt::format("did you mean {}?", in_quotes(*near)) : std::string());
  return around;
}

std::vector<xml_node> Classes::levels(const xml_node& element, std::size_t its_class) const {
  std::vector<xml_node> out{element};
  for (std::size_t at = its_class;; at = classes_[at].outer) {
    const auto& sections = classes_[at].sections;
    for (auto section = sections.rbegin(); section != sections.rend(); ++section)
      if (const xml_node found = section->child(element.name())) out.push_back(found);
    if (at == kTop) return out;
  }
}

xml_attribute Classes::find(const xml_node& element, const char* attribute,
                            std::size_t its_class) const {
  if (const xml_attribute own = element.attribute(attribute)) return own;
  for (std::size_t at = its_class;; at = classes_[at].outer) {
    const auto& sections = classes_[at].sections;
    for (auto section = sections.rbegin(); section != sections.rend(); ++section)
      if (const auto found = section->child(element.name()).attribute(attribute)) return found;
    if (at == kTop) return {};
  }
}

}  // namespace panwright::importers::mjcf
