// Instances of prototypes → copies of their bodies.
#include <fmt/core.h>

#include <unordered_map>

#include "base/text.h"
#include "importers/vrml/internal/reader_context.h"

namespace panwright::importers::vrml {

namespace {

constexpr std::uint32_t kMostSteps = 64;  // instances that are instances, externals of externals

}  // namespace

// What an EXTERNPROTO stands for: the prototype of its name ("#Name" of the URL) in the first of
// its files that has one, or the first of a file without a name given.
Prototype* ReaderContext::target_of(Prototype& prototype) {
  if (prototype.looked_for) return prototype.target;
  prototype.looked_for = true;
  std::string problem = "no file is named";
  Code code = Code("W6004");
  for (const std::string_view url : prototype.urls.strings()) {
    const SourceSpan where = prototype.urls_where;
    const Document* document = document_at(url, where, problem, code);
    if (document == nullptr) continue;
    const std::size_t hash = url.find('#');
    for (Prototype* candidate : document->prototypes) {
      const bool wanted =
          hash == url.npos ? !candidate->external : candidate->name == url.substr(hash + 1);
      if (!wanted || candidate == &prototype) continue;
      prototype.target = candidate->external ? target_of(*candidate) : candidate;
      return prototype.target;
    }
    problem = fmt::format("{} has no such prototype", in_quotes(url));
  }
  report_missing_part(prototype.where,
                      fmt::format("the prototype {}: {}", in_quotes(prototype.name), problem),
                      code);
  return nullptr;
}

// A copy of one node of a body, and of what stands below it, as far as values of the interface are
// used there; the rest is shared.
Node* ReaderContext::copied(Node* node, Node& instance, const Prototype& prototype,
                            std::unordered_map<const Node*, Node*>& done) {
  if (!node->has_is) return node;
  Node*& known = done[node];
  if (known != nullptr) return known;
  constexpr std::uint64_t kNodesEach = 8;  // of a document for one of the scene
  if (++copies_ > kNodesEach * options.limits.nodes) throw OverLimit{"nodes", instance.where};
  Node* out = arena_.make<Node>();
  known = out;
  *out = *node;
  out->owner = &instance;
  out->has_is = false;
  const auto all = [&](std::span<Node* const> nodes) {
    const std::span<Node*> list = arena_.copied(nodes);
    for (Node*& item : list) item = copied(item, instance, prototype, done);
    return list;
  };
  std::vector<Field> fields;
  for (Field field : node->fields) {
    if (field.is >= 0) {
      const Field* given = instance.find(prototype.fields[static_cast<std::size_t>(field.is)].name);
      if (given == nullptr) continue;
      field.value = given->value;
      field.where = given->where;
      field.is = -1;
    } else if (field.value.type == FieldType::sf_node || field.value.type == FieldType::mf_node) {
      field.value.data = all(field.value.nodes()).data();
    }
    fields.push_back(field);
  }
  out->fields = arena_.copied(std::span<const Field>(fields));
  out->children = all(node->children);
  return out;
}

void ReaderContext::expand(Node& instance) {
  instance.expanded = true;
  Prototype* prototype = instance.prototype;
  if (prototype->external) {
    prototype = target_of(*prototype);
    if (prototype == nullptr) return;
    // the values given, and the defaults of the prototype itself
    std::vector<Field> fields;
    for (const FieldSpec& spec : prototype->fields) {
      using Access = FieldSpec::Access;
      if (spec.access != Access::field && spec.access != Access::exposed_field) continue;
      const Field* given = instance.find(spec.name);
      const bool fits = given != nullptr && given->value.type == spec.type;
      fields.push_back(fits ? *given : Field{spec.name, spec.initial, prototype->where});
    }
    instance.fields = arena_.copied(std::span<const Field>(fields));
    instance.prototype = prototype;
  }
  for (const Node* outer = instance.owner; outer != nullptr; outer = outer->owner) {
    if (outer->prototype != prototype) continue;
    log.report(Code("E6109"), instance.where,
               fmt::format("the prototype {} contains itself", in_quotes(prototype->name)));
    return;
  }
  if (prototype->body.empty()) return;
  std::unordered_map<const Node*, Node*> done;
  instance.body = copied(prototype->body[0], instance, *prototype, done);
}

Node* ReaderContext::actual(Node* node) {
  for (std::uint32_t step = 0; node != nullptr && node->prototype != nullptr; ++step) {
    if (step > kMostSteps) {
      log.report(Code("E6109"), node->where,
                 fmt::format("the prototype {} contains itself", in_quotes(node->type)));
      return nullptr;
    }
    if (!node->expanded) expand(*node);
    node = node->body;
  }
  return node;
}

}  // namespace panwright::importers::vrml
