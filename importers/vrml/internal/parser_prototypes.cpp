#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/node_types.h"
#include "importers/vrml/internal/parser.h"

namespace panwright::importers::vrml {

namespace {

using Access = FieldSpec::Access;

std::optional<Access> access_named(std::string_view word) {
  if (word == "eventIn") return Access::event_in;
  if (word == "eventOut") return Access::event_out;
  if (word == "field") return Access::field;
  if (word == "exposedField") return Access::exposed_field;
  return std::nullopt;
}

bool has_value(Access access) { return access == Access::field || access == Access::exposed_field; }

// Whether two declarations take the same name: an exposed field has the events set_x and x_changed.
bool in_conflict(const FieldSpec& a, const FieldSpec& b) {
  if (a.name == b.name) return true;
  const auto taken = [](const FieldSpec& exposed, std::string_view name) {
    if (exposed.access != Access::exposed_field) return false;
    return (name.starts_with("set_") && name.substr(4) == exposed.name) ||
           (name.ends_with("_changed") && name.substr(0, name.size() - 8) == exposed.name);
  };
  return taken(a, b.name) || taken(b, a.name);
}

}  // namespace

// PROTO Name [ interface ] { body }
void Parser::prototype() {
  word();
  skip_blanks();
  const char* const at = p_;
  Prototype* prototype = arena_.make<Prototype>();
  prototype->name = name();
  prototype->where = span(at, p_);
  if (prototype->name.empty()) report(Code("E6103"), here(), "a name is missing after PROTO");
  if (++depth_ > limits_.depth) throw OverLimit{"depth", prototype->where};
  const Body* const outer = std::exchange(field_names_, nullptr);
  prototype->fields = interface(false);
  if (accept('{')) {
    Scope inner;
    inner.around = scope_;
    inner.prototype = prototype;
    scope_ = &inner;
    std::vector<Node*> body;
    for (;;) {
      skip_blanks();
      if (at_end()) {
        text_ends(prototype->where, "prototype");
        break;
      }
      if (accept('}')) break;
      statement(body);
    }
    scope_ = inner.around;
    prototype->body = arena_.copied(std::span<Node* const>(body));
  } else {
    report(Code("E6103"), here(), "expected '{' and the body of the prototype");
  }
  field_names_ = outer;
  --depth_;
  scope_->prototypes[prototype->name] = prototype;
  if (scope_->around == nullptr) document_.prototypes.push_back(prototype);
}

// EXTERNPROTO Name [ interface without values ] urls
void Parser::external_prototype() {
  word();
  skip_blanks();
  const char* const at = p_;
  Prototype* prototype = arena_.make<Prototype>();
  prototype->external = true;
  prototype->name = name();
  prototype->where = span(at, p_);
  if (prototype->name.empty()) report(Code("E6103"), here(), "a name is missing after EXTERNPROTO");
  const Body* const outer = std::exchange(field_names_, nullptr);
  prototype->fields = interface(true);
  Field urls;
  if (value(FieldType::mf_string, urls)) {
    prototype->urls = urls.value;
    prototype->urls_where = urls.where;
  }
  field_names_ = outer;
  scope_->prototypes[prototype->name] = prototype;
  if (scope_->around == nullptr) document_.prototypes.push_back(prototype);
}

std::span<FieldSpec> Parser::interface(bool external) {
  std::vector<FieldSpec> specs;
  if (!accept('[')) {
    report(Code("E6103"), here(), "expected '[' and an interface");
    return {};
  }
  const char* const open = p_ - 1;
  for (;;) {
    skip_blanks();
    if (at_end()) {
      text_ends(span(open, open + 1), "interface");
      break;
    }
    if (accept(']')) break;
    if (*p_ == '{' || *p_ == '}') {
      report(Code("E6103"), here(), "']' is missing before this");
      break;
    }
    const SourceSpan where = here();
    const auto access = access_named(peek_word());
    if (!access) {
      report(Code("E6103"), where,
             fmt::format("expected eventIn, eventOut, field or exposedField, found {}",
                         in_quotes(token_here())));
      while (!at_end() && !access_named(peek_word()) && *p_ != ']' && *p_ != '{' && *p_ != '}') {
        p_ += std::max<std::size_t>(1, token_here().size());
        skip_blanks();
      }
      continue;
    }
    FieldSpec spec;
    if (declared(*access, spec, !external)) add_declared(spec, where, specs);
  }
  return arena_.copied(std::span<const FieldSpec>(specs));
}

void Parser::add_declared(const FieldSpec& spec, SourceSpan where, std::vector<FieldSpec>& specs) {
  for (const FieldSpec& other : specs) {
    if (!in_conflict(spec, other)) continue;
    report(Code("E6110"), where,
           spec.name == other.name ? fmt::format("{} is declared twice", in_quotes(spec.name))
                                   : fmt::format("{} and {} name the same event",
                                                 in_quotes(spec.name), in_quotes(other.name)));
    return;
  }
  constexpr std::size_t kMostFields = 4000;  // an interface is searched from end to end
  if (specs.size() >= kMostFields) throw OverLimit{"fields of a prototype", where};
  specs.push_back(spec);
}

// access type name, and a value for fields. False: not usable, reported.
bool Parser::declared(FieldSpec::Access access, FieldSpec& spec, bool with_value) {
  word();
  skip_blanks();
  const SourceSpan type_at = here();
  const std::string_view type_word = at_word() ? word() : std::string_view();
  const auto type = field_type(type_word);
  skip_blanks();
  if (!type) {
    report(Code("E6110"), type_at,
           fmt::format("{} is not a type of field",
                       in_quotes(type_word.empty() ? token_here() : type_word)));
    if (at_word() && !access_named(peek_word())) word();
    if (with_value && has_value(access)) skip_value();
    return false;
  }
  if (!is_word(*p_)) {
    report(Code("E6103"), here(), "the name of a field is missing");
    return false;
  }
  spec.access = access;
  spec.type = *type;
  spec.name = name();
  spec.initial.type = *type;
  if (!with_value || !has_value(access)) return true;
  // names in a default value count for that value alone
  Scope inner;
  inner.around = scope_;
  scope_ = &inner;
  Field field;
  skip_blanks();
  const bool good = value(*type, field);
  scope_ = inner.around;
  if (good) {
    spec.initial = field.value;
  } else if (!is_list(*type) && *type != FieldType::sf_node) {
    spec.initial = zero_of(*type);
  }
  return true;
}

// What a field without a usable value has.
Value Parser::zero_of(FieldType type) {
  Value out;
  out.type = type;
  if (type == FieldType::sf_string) {
    const std::string_view empty;
    out.data = arena_.copied(std::span<const std::string_view>(&empty, 1)).data();
    out.size = 1;
  } else if (type == FieldType::sf_bool || type == FieldType::sf_int32 ||
             type == FieldType::sf_image) {
    constexpr std::int32_t kZero[3] = {};
    out.size = type == FieldType::sf_image ? 3 : 1;
    out.data = arena_.copied(std::span<const std::int32_t>(kZero, out.size)).data();
  } else if (width_of(type) > 0) {
    constexpr double kZero[16] = {};
    out.size = width_of(type);
    out.data = arena_.copied(std::span<const double>(kZero, out.size)).data();
  }
  return out;
}

// A declaration inside a Script: its value may be IS.
void Parser::script_field(Body& body) {
  const SourceSpan where = here();
  const Access access = *access_named(peek_word());
  if (access == Access::exposed_field)
    report(Code("E6110"), where, "a Script has no exposed fields");
  FieldSpec spec;
  if (!declared(access, spec, false)) {
    skip_value();
    return;
  }
  const std::size_t before = body.declared.size();
  add_declared(spec, where, body.declared);
  if (body.declared.size() == before) {
    if (has_value(access)) skip_value();
    return;
  }
  skip_blanks();
  Field field;
  field.name = spec.name;
  if (accept_word("IS")) {
    if (is_value(spec, field)) body.node->has_is = true;
    return;
  }
  if (!has_value(access)) return;
  if (value(spec.type, field)) add_field(field, body);
}

// The name after IS: a field of the prototype around, of the same type. True when it has a value.
bool Parser::is_value(const FieldSpec& spec, Field& field) {
  skip_blanks();
  const SourceSpan where = here();
  const std::string_view text = is_word(*p_) ? name() : std::string_view();
  if (text.empty()) {
    report(Code("E6103"), where, "a name is missing after IS");
    return false;
  }
  const Prototype* prototype = scope_->prototype;
  if (prototype == nullptr) {
    report(Code("E6110"), where, "IS outside of a prototype");
    return false;
  }
  for (std::size_t i = 0; i < prototype->fields.size(); ++i) {
    const FieldSpec& outer = prototype->fields[i];
    if (outer.name != text) continue;
    if (outer.type != spec.type) {
      report(Code("E6110"), where,
             fmt::format("{} is of type {}, and {} of type {}", in_quotes(spec.name),
                         type_name(spec.type), in_quotes(text), type_name(outer.type)));
      return false;
    }
    const bool both = has_value(outer.access) && has_value(spec.access);
    if (has_value(outer.access) != has_value(spec.access) &&
        outer.access != Access::exposed_field && spec.access != Access::exposed_field) {
      report(Code("E6110"), where,
             fmt::format("of {} and {} one is an event and the other a field", in_quotes(spec.name),
                         in_quotes(text)));
      return false;
    }
    field.is = both ? static_cast<std::int32_t>(i) : -1;
    field.value.type = spec.type;
    field.where = where;
    return both;
  }
  std::vector<std::string_view> names;
  for (const FieldSpec& outer : prototype->fields) names.push_back(outer.name);
  const auto near = nearest_name(text, names);
  report(
      Code("E6110"), where,
      fmt::format("the prototype {} has no field {}", in_quotes(prototype->name), in_quotes(text)),
      near ? fmt::format("did you mean {}?", in_quotes(*near)) : std::string());
  return false;
}

// ROUTE node.event TO node.event
void Parser::route() {
  word();
  skip_blanks();
  const SourceSpan from_at = here();
  const std::string_view from = is_word(*p_) ? name() : std::string_view();
  if (from.empty() || !accept_word("TO")) {
    report(Code("E6103"), here(), "expected ROUTE node.event TO node.event");
    return;
  }
  skip_blanks();
  const SourceSpan to_at = here();
  const std::string_view to = is_word(*p_) ? name() : std::string_view();
  if (to.empty()) {
    report(Code("E6103"), here(), "a node and its event are missing after TO");
    return;
  }
  const FieldSpec* source = route_end(from, from_at, true);
  const FieldSpec* sink = route_end(to, to_at, false);
  if (source != nullptr && sink != nullptr && source->type != sink->type)
    report(Code("E6117"), to_at,
           fmt::format("{} is of type {}, and {} of type {}", in_quotes(from),
                       type_name(source->type), in_quotes(to), type_name(sink->type)));
}

// One end of a route; nullptr where it is wrong (reported) or of a node that is not known.
const FieldSpec* Parser::route_end(std::string_view text, SourceSpan where, bool source) {
  const std::size_t point = text.rfind('.');
  if (point == text.npos || point == 0 || point + 1 == text.size()) {
    report(Code("E6103"), where, fmt::format("{} is not a node and an event", in_quotes(text)));
    return nullptr;
  }
  const std::string_view node_name = text.substr(0, point);
  const std::string_view event = text.substr(point + 1);
  const auto it = scope_->nodes.find(node_name);
  if (it == scope_->nodes.end()) {
    report(Code("E6117"), where,
           fmt::format("nothing before it is called {}", in_quotes(node_name)));
    return nullptr;
  }
  const Node& node = *it->second;
  if (node.prototype == nullptr && (node.spec == nullptr || node.spec == spec97("Script")))
    return nullptr;
  const auto fields = node.prototype != nullptr ? std::span<const FieldSpec>(node.prototype->fields)
                                                : node.spec->fields;
  const FieldSpec* other_way = nullptr;
  const std::string_view prefix = "set_";
  const std::string_view suffix = "_changed";
  for (const FieldSpec& spec : fields) {
    bool same = spec.name == event;
    if (source)
      same |= event == fmt::format("{}{}", spec.name, suffix) ||
              spec.name == fmt::format("{}{}", event, suffix);
    else
      same |= event == fmt::format("{}{}", prefix, spec.name) ||
              spec.name == fmt::format("{}{}", prefix, event);
    if (!same) continue;
    if (spec.access == Access::exposed_field ||
        spec.access == (source ? Access::event_out : Access::event_in))
      return &spec;
    other_way = &spec;
  }
  if (other_way != nullptr) {
    report(Code("W6118"), where,
           fmt::format("{} of {} is not an event that can be routed {}", in_quotes(event),
                       in_quotes(node.type), source ? "from" : "to"));
    return other_way;
  }
  report(Code("E6117"), where,
         fmt::format("{} has no event {} that can be routed {}", in_quotes(node.type),
                     in_quotes(event), source ? "from" : "to"));
  return nullptr;
}

// VRML 1.0: `fields [ SFString name, … ]` and `isA [ "Type" ]` of nodes that it does not have.
void Parser::fields_of_10(Body& body) {
  const std::string_view keyword = word();
  accept('[');
  for (skip_blanks(); !at_end(); skip_blanks()) {
    if (accept(']')) return;
    if (*p_ == '"') {
      std::string_view base;
      if (!string(base)) return;
      const NodeSpec* spec = spec10(base);
      if (keyword == "isA" && spec != nullptr && body.node->spec == nullptr) {
        body.node->spec = spec;
        body.specs = spec->fields;
        body.known = true;
      }
      continue;
    }
    if (!at_word()) {
      if (*p_ == '}') return;
      p_ += std::max<std::size_t>(1, token_here().size());
      continue;
    }
    const std::string_view type_word = word();
    skip_blanks();
    if (!at_word()) continue;
    FieldSpec spec;
    spec.name = word();
    if (const auto type = field_type(type_word)) {
      spec.type = *type;
      body.declared.push_back(spec);
    }
  }
}

}  // namespace panwright::importers::vrml
