// VRML file as read: nodes and their fields, before conversion. Both versions.
//
//   Transform { translation 1 0 0 children [ DEF A Shape { … } USE A ] }
//   → Node Transform, fields: translation = {1, 0, 0}, children = {p, p}; p → Node Shape, name "A".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/math.h"
#include "base/source.h"
#include "importers/import.h"

namespace panwright::importers::vrml {

// Exceeded limit; vrml::read() makes E6002 of it.
struct OverLimit {
  std::string what;  // "memory", "nodes"…; empty: already reported
  SourceSpan where;
};

// Memory that lives as long as a document. Throws OverLimit past the budget.
class Arena {
 public:
  // used: bytes taken so far by all arenas of a reading.
  Arena(std::uint64_t& used, std::uint64_t limit) : used_(used), limit_(limit) {}
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  void* allocate(std::size_t bytes, std::size_t alignment);
  // Takes over a block of std::malloc.
  void adopt(void* block, std::size_t bytes);
  void count(std::size_t bytes);
  // Frees an adopted block; false: it is none.
  bool release(const void* block, std::size_t bytes);

  template <class T>
  T* make() {
    return new (allocate(sizeof(T), alignof(T))) T();
  }
  template <class T>
  std::span<std::remove_const_t<T>> copied(std::span<T> items) {
    using Item = std::remove_const_t<T>;
    static_assert(std::is_trivially_copyable_v<Item>);
    if (items.empty()) return {};
    Item* out = static_cast<Item*>(allocate(items.size_bytes(), alignof(Item)));
    std::uninitialized_copy(items.begin(), items.end(), out);
    return {out, items.size()};
  }
  std::string_view copied(std::string_view text);

 private:
  std::uint64_t& used_;
  std::uint64_t limit_;
  std::vector<void*> blocks_;
  std::byte* at_ = nullptr;
  std::size_t left_ = 0;
};

enum class FieldType : std::uint8_t {
  none,
  sf_bool,
  sf_int32,
  sf_float,
  sf_time,
  sf_vec2f,
  sf_vec3f,
  sf_color,
  sf_rotation,
  sf_matrix,  // VRML 1.0
  sf_string,
  sf_enum,     // VRML 1.0
  sf_bitmask,  // VRML 1.0
  sf_image,
  sf_node,
  mf_bool,
  mf_int32,
  mf_float,
  mf_time,
  mf_vec2f,
  mf_vec3f,
  mf_color,
  mf_rotation,
  mf_string,
  mf_node,
};

std::string_view type_name(FieldType type);  // "SFVec3f"
bool is_list(FieldType type);                // MF…
// Returns the numbers of one item: 3 for sf_vec3f and mf_vec3f; 0 for other items.
std::size_t width_of(FieldType type);

struct Node;

// Value of a field. Plain view of memory in an arena or in the text.
struct Value {
  FieldType type = FieldType::none;
  const void* data = nullptr;
  std::size_t size = 0;  // of the span below for the type

  // sf/mf_float, time, vec2f, vec3f, color, rotation (axis, angle), matrix (as written): flat
  std::span<const double> numbers() const { return {static_cast<const double*>(data), size}; }
  // sf/mf_bool (0 or 1), int32; image: width, height, components, pixels (their 32 bits)
  std::span<const std::int32_t> integers() const {
    return {static_cast<const std::int32_t*>(data), size};
  }
  // sf/mf_string, without quotes and escapes; enum and bitmask: the words. UTF-8
  std::span<const std::string_view> strings() const {
    return {static_cast<const std::string_view*>(data), size};
  }
  // sf_node (NULL: none), mf_node; never null
  std::span<Node* const> nodes() const { return {static_cast<Node* const*>(data), size}; }
};

struct FieldSpec {
  enum class Access : std::uint8_t { field, exposed_field, event_in, event_out };
  std::string_view name;
  FieldType type = FieldType::none;
  Access access = Access::exposed_field;
  Value initial;  // the standard's default
};

// Node type of the standard.
struct NodeSpec {
  std::string_view name;
  std::span<const FieldSpec> fields;
  bool group = false;  // VRML 1.0: has children without a field
  const FieldSpec* find(std::string_view field) const;
};

// Returns node types by name; nullptr: none of that version.
const NodeSpec* spec97(std::string_view name);
const NodeSpec* spec10(std::string_view name);
std::span<const NodeSpec> specs97();  // 54 of VRML 97, by name
std::span<const NodeSpec> specs10();  // of VRML 1.0, by name

struct Field {
  std::string_view name;
  Value value;
  SourceSpan where;      // of the value
  std::int32_t is = -1;  // in the body of a prototype: field of its interface; else −1
};

struct Node;

// PROTO or EXTERNPROTO.
struct Prototype {
  std::string_view name;
  SourceSpan where;             // its name
  std::span<FieldSpec> fields;  // the interface; of an EXTERNPROTO without defaults
  std::span<Node*> body;        // the first gives the type of instances; the values have `is`
  bool external = false;        // EXTERNPROTO
  Value urls;                   // of an external one
  SourceSpan urls_where;
  Prototype* target = nullptr;  // of an external one, once resolved
  bool looked_for = false;
};

struct Node {
  std::string_view type;           // as written
  const NodeSpec* spec = nullptr;  // nullptr: unknown, or an instance of a prototype
  std::string_view name;           // of its DEF; may be empty. UTF-8
  SourceSpan where;                // its type
  std::span<Field> fields;         // those written, in order; of instances the whole interface
  std::span<Node*> children;       // VRML 1.0, and nodes inside unknown ones
  Prototype* prototype = nullptr;  // of an instance
  Node* owner = nullptr;           // the instance in whose body this is a copy
  Node* body = nullptr;            // of an instance: see ReaderContext::actual
  bool expanded = false;           // body was resolved
  bool again = false;              // a USE names it
  bool has_is = false;             // it or a descendant takes values of an interface

  // Returns the last written field; nullptr: not written.
  const Field* find(std::string_view field) const;

  // Returns the written value, or the standard's default.
  // Expects: the node type has such a field, of a fitting type.
  const Value& value(std::string_view field) const;
  std::span<const double> numbers(std::string_view field) const { return value(field).numbers(); }
  std::span<const std::int32_t> integers(std::string_view field) const {
    return value(field).integers();
  }
  std::span<const std::string_view> strings(std::string_view field) const {
    return value(field).strings();
  }
  std::span<Node* const> nodes(std::string_view field) const { return value(field).nodes(); }
  double number(std::string_view field) const { return numbers(field)[0]; }
  std::int32_t integer(std::string_view field) const { return integers(field)[0]; }
  bool flag(std::string_view field) const { return integer(field) != 0; }
  Vec2 vec2(std::string_view field) const;
  Vec3 vec3(std::string_view field) const;
  std::string_view string(std::string_view field) const;
  Node* node(std::string_view field) const;  // nullptr: NULL
};

// One file.
struct Document {
  std::string path;  // as in Files
  FileId file = kNoFile;
  Format format = Format::vrml97;
  SharedText text;
  std::vector<Node*> nodes;  // top level
  std::unique_ptr<Arena> arena;
  std::vector<Prototype*> prototypes;  // of the top level, in order of definition
};

// Returns the place of item `index` of a list of numbers or strings, by reading the text again. The
// whole value for items not in the text.
SourceSpan place_of_item(const SourceMap& sources, const Field& field, std::size_t index);

}  // namespace panwright::importers::vrml
