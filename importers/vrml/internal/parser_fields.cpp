// Contents of a node: fields, and nodes that stand where fields do.
#include <fmt/core.h>

#include "base/text.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/node_types.h"
#include "importers/vrml/internal/parser.h"

namespace panwright::importers::vrml {

void Parser::fill(Node& node, Body& body) {
  const std::size_t first_node = node_stack_.size();
  const std::size_t first_field = field_stack_.size();
  for (;;) {
    skip_blanks();
    if (p_ >= forget_at_) forget();
    if (at_end()) {
      text_ends(node.where, in_quotes(node.type));
      break;
    }
    if (*p_ == '}') {
      ++p_;
      break;
    }
    if (!at_word()) {
      if (!body.known && *p_ == '"')
        skip_string();
      else if (!body.known && *p_ == '{')
        skip_braces();
      else if (!body.known && *p_ != '\0')
        p_ += token_here().size();
      else
        skip_stray('}');
    } else if (!(vrml97_ ? field_of_97(body) : item_of_10(body))) {
      unknown_item();
    }
  }
  if (node.prototype != nullptr) {
    node.fields = interface_values(*node.prototype, first_field);
  } else {
    node.fields = arena_.copied(std::span<const Field>(field_stack_).subspan(first_field));
  }
  node.children = arena_.copied(std::span<Node* const>(node_stack_).subspan(first_node));
  for (const Node* child : node.children) node.has_is |= child->has_is;
  node_stack_.resize(first_node);
  field_stack_.resize(first_field);
  if (body.script) {
    NodeSpec* spec = arena_.make<NodeSpec>();
    *spec = *node.spec;
    body.declared.insert(body.declared.end(), body.specs.begin(), body.specs.end());
    spec->fields = arena_.copied(std::span<const FieldSpec>(body.declared));
    node.spec = spec;
  }
}

// What an instance has: every field of the interface that has a value, as written or by default.
std::span<Field> Parser::interface_values(const Prototype& prototype, std::size_t first) {
  const std::size_t end = field_stack_.size();
  std::vector<Field> out;
  for (const FieldSpec& spec : prototype.fields) {
    Field field{spec.name, spec.initial, prototype.where};
    bool written = false;
    for (std::size_t i = first; i < end; ++i) {
      if (field_stack_[i].name != spec.name) continue;
      field = field_stack_[i];
      written = true;
    }
    using Access = FieldSpec::Access;
    const bool has_value = spec.access == Access::field || spec.access == Access::exposed_field;
    if (written || (has_value && !prototype.external)) out.push_back(field);
  }
  return arena_.copied(std::span<const Field>(out));
}

const FieldSpec* Parser::spec_of(const Body& body, std::string_view field) const {
  for (const FieldSpec& spec : body.specs)
    if (spec.name == field) return &spec;
  for (const FieldSpec& spec : body.declared)
    if (spec.name == field) return &spec;
  return nullptr;
}

// set_x and x_changed of an exposed field x, which a body may connect by IS.
std::optional<FieldSpec> Parser::event_of(const Body& body, std::string_view event) {
  using Access = FieldSpec::Access;
  for (const FieldSpec& spec : body.specs) {
    if (spec.access != Access::exposed_field) continue;
    const bool in = event.starts_with("set_") && event.substr(4) == spec.name;
    const bool out = event.ends_with("_changed") && event.substr(0, event.size() - 8) == spec.name;
    if (!in && !out) continue;
    const char* const at = p_;
    p_ += event.size();
    const bool is = accept_word("IS");
    p_ = at;
    if (!is) return std::nullopt;
    FieldSpec found = spec;
    found.name = event;
    found.access = in ? Access::event_in : Access::event_out;
    return found;
  }
  return std::nullopt;
}

bool Parser::field_of_97(Body& body) {
  if (declaration()) return true;
  const std::string_view text = peek_word();
  if (body.script &&
      (text == "eventIn" || text == "eventOut" || text == "field" || text == "exposedField")) {
    script_field(body);
    return true;
  }
  const FieldSpec* spec = spec_of(body, text);
  if (spec != nullptr) {
    p_ += text.size();
    known_field(body, *spec);
    return true;
  }
  if (const auto event = event_of(body, text)) {
    p_ += text.size();
    known_field(body, *event);
    return true;
  }
  if (!body.known) return false;
  if (text == "DEF" || text == "USE" || brace_follows()) {
    misplaced_node(body);
    return true;
  }
  const SourceSpan where = here();
  p_ += text.size();
  unknown_field(body, text, where);
  return true;
}

bool Parser::item_of_10(Body& body) {
  const std::string_view text = peek_word();
  if (text == "fields" || text == "isA") {
    const char* const at = p_;
    p_ += text.size();
    skip_blanks();
    if (*p_ == '[') {
      p_ = at;
      fields_of_10(body);
      return true;
    }
    p_ = at;
  }
  const bool is_node = text == "DEF" || text == "USE" || brace_follows();
  const FieldSpec* spec = is_node ? nullptr : spec_of(body, text);
  if (spec != nullptr) {
    p_ += text.size();
    known_field(body, *spec);
    return true;
  }
  if (!body.known) return false;
  if (is_node) {
    bool there = false;
    Node* child = node_value(&there);
    if (child != nullptr) node_stack_.push_back(child);
    return true;
  }
  const SourceSpan where = here();
  p_ += text.size();
  unknown_field(body, text, where);
  return true;
}

// Inside a node that is not known: nodes are read for their names, the rest is skipped.
void Parser::unknown_item() {
  const std::string_view text = peek_word();
  if (text != "DEF" && text != "USE" && !brace_follows()) {
    p_ += text.size();
    return;
  }
  bool there = false;
  Node* child = node_value(&there);
  if (child != nullptr) node_stack_.push_back(child);
}

void Parser::known_field(Body& body, const FieldSpec& spec) {
  using Access = FieldSpec::Access;
  Field field;
  field.name = spec.name;
  const char* const name_end = p_;
  skip_blanks();
  if (vrml97_ && accept_word("IS")) {
    if (is_value(spec, field)) {
      body.node->has_is = true;
      add_field(field, body);
    }
    return;
  }
  if (spec.access == Access::event_in || spec.access == Access::event_out) {
    report(Code("E6104"), span(name_end - spec.name.size(), name_end),
           fmt::format("{} is an event, which has no value", in_quotes(spec.name)));
    skip_value();
    return;
  }
  const Body* const outer = std::exchange(field_names_, &body);
  if (value(spec.type, field)) add_field(field, body);
  field_names_ = outer;
}

void Parser::add_field(const Field& field, Body& body) {
  if (field.value.type == FieldType::sf_node || field.value.type == FieldType::mf_node)
    for (const Node* node : field.value.nodes()) body.node->has_is |= node->has_is;
  field_stack_.push_back(field);
}

void Parser::unknown_field(Body& body, std::string_view text, SourceSpan where) {
  // names of X3D, and of those who remember them wrongly
  constexpr std::string_view kOthers[][3] = {{"LOD", "children", "level"},
                                             {"LOD", "levels", "level"},
                                             {"Switch", "children", "choice"},
                                             {"Switch", "choices", "choice"}};
  for (const auto& [type, other, meant] : kOthers) {
    const FieldSpec* spec =
        vrml97_ && type == body.node->type && other == text ? spec_of(body, meant) : nullptr;
    if (spec == nullptr) continue;
    report(Code("W6118"), where, fmt::format("{} is read as '{}'", in_quotes(text), meant));
    return known_field(body, *spec);
  }
  std::string hint;
  if (!terse()) {
    std::vector<std::string_view> names;
    for (const FieldSpec& spec : body.specs) {
      using Access = FieldSpec::Access;
      const bool has_value = spec.access == Access::field || spec.access == Access::exposed_field;
      if (has_value) names.push_back(spec.name);
    }
    if (const auto near = nearest_name(text, names)) {
      if (same_but_for_case(text, *near)) {
        report(Code("W6118"), where,
               fmt::format("{} is read as '{}': case matters", in_quotes(text), *near));
        known_field(body, *spec_of(body, *near));
        return;
      }
      hint = fmt::format("did you mean {}?", in_quotes(*near));
    }
    for (const FieldSpec& spec : body.specs)
      if (text == fmt::format("set_{}", spec.name) || text == fmt::format("{}_changed", spec.name))
        hint = fmt::format("events have no value; the field is '{}'", spec.name);
  }
  report(Code("E6104"), where,
         fmt::format("{} has no field {}", in_quotes(body.node->type), in_quotes(text)),
         std::move(hint));
  skip_value();
}

void Parser::misplaced_node(Body& body) {
  const SourceSpan where = here();
  bool there = false;
  report(Code("E6103"), where,
         fmt::format("a node, expected the name of a field of {}", in_quotes(body.node->type)));
  Node* child = node_value(&there);
  if (child != nullptr) node_stack_.push_back(child);
}

}  // namespace panwright::importers::vrml
