// Parser of text into a document, for both versions: they share tokens and values, not the nesting
// of nodes.
#pragma once

#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "importers/vrml/internal/document.h"
#include "importers/vrml/internal/reader_context.h"

namespace panwright::importers::vrml {

// Growing list of numbers that does not copy large blocks, and is then given to an arena.
template <class T>
class Growing {
 public:
  Growing() = default;
  Growing(const Growing&) = delete;
  Growing& operator=(const Growing&) = delete;
  ~Growing() { std::free(data_); }

  std::size_t size() const { return size_; }
  void resize_down(std::size_t size) { size_ = size; }
  T& operator[](std::size_t i) { return data_[i]; }
  void push(T value) {
    if (size_ == capacity_) grow();
    data_[size_++] = value;
  }

  std::span<const T> given_to(Arena& arena) {
    constexpr std::size_t kLarge = std::size_t{16} << 10;  // bytes: larger blocks are not copied
    const std::size_t count = std::exchange(size_, 0);
    if (count * sizeof(T) < kLarge) return arena.copied(std::span<const T>(data_, count));
    void* block = std::realloc(data_, count * sizeof(T));
    if (block == nullptr) block = data_;
    data_ = nullptr;
    capacity_ = 0;
    arena.adopt(block, count * sizeof(T));
    return {static_cast<const T*>(block), count};
  }

 private:
  void grow() {
    const std::size_t wanted = capacity_ == 0 ? 256 : 2 * capacity_;
    void* block = std::realloc(data_, wanted * sizeof(T));
    if (block == nullptr) throw OverLimit{"memory", {}};
    data_ = static_cast<T*>(block);
    capacity_ = wanted;
  }
  static_assert(std::is_trivially_copyable_v<T>);
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

class Parser {
 public:
  // Expects: document with path, file, format, text (its header checked), arena.
  Parser(ReaderContext& context, Document& document);
  // Reads the whole text into the document. Reports E6103 to E6118. Throws OverLimit.
  void run();

 private:
  // Names, from where they are defined to the end of a file or prototype.
  struct Scope {
    Scope* around = nullptr;
    Prototype* prototype = nullptr;  // of this body
    std::map<std::string_view, Node*> nodes;
    std::map<std::string_view, Prototype*> prototypes;
  };
  // Permitted contents of a node being read.
  struct Body {
    Node* node;
    std::span<const FieldSpec> specs;  // of its fields
    bool known;                        // true: there are no other fields
    bool script = false;
    std::vector<FieldSpec> declared{};  // of a script, or by `fields` of VRML 1.0
  };

  // ---- tokens
  void skip_blanks();  // with commas and comments
  bool at_end() const { return p_ >= end_; }
  bool at_number() const;
  bool at_word() const;
  std::string_view peek_word();   // of this place; may be empty
  std::string_view word();        // moves on
  std::string_view name();        // a word as UTF-8
  std::string_view given_name();  // after DEF or USE
  std::string_view as_utf8(std::string_view text);
  bool accept(char c);  // after blanks
  bool accept_word(std::string_view text);
  bool brace_follows();  // "{" follows the word
  std::string_view token_here();
  SourceSpan span(const char* begin, const char* end) const;
  SourceSpan here();  // the token at this place

  // ---- messages
  void report(Code code, SourceSpan where, std::string message, std::string hint = {});
  void text_ends(SourceSpan where, std::string_view what);
  bool terse();  // many problems already: skip details

  // ---- nodes
  void drop_padding();  // NUL bytes and the like at the end
  void statement(std::vector<Node*>& out);
  bool declaration();  // PROTO, EXTERNPROTO or ROUTE, if next
  // Reads a node: DEF, USE, NULL or a type. *there: false if none is next.
  Node* node_value(bool* there);
  Node* use();
  Node* typed_node(std::string_view def);
  void fill(Node& node, Body& body);
  void declare_files(const Node& node) const;
  bool field_of_97(Body& body);
  bool item_of_10(Body& body);
  void unknown_item();
  void known_field(Body& body, const FieldSpec& spec);
  void unknown_field(Body& body, std::string_view name, SourceSpan where);
  void misplaced_node(Body& body);
  void script_field(Body& body);
  void fields_of_10(Body& body);
  const FieldSpec* spec_of(const Body& body, std::string_view name) const;
  std::optional<FieldSpec> event_of(const Body& body, std::string_view event);
  void add_field(const Field& field, Body& body);
  std::span<Field> interface_values(const Prototype& prototype, std::size_t first);
  Prototype* prototype_named(std::string_view name) const;
  const NodeSpec* spec_named(std::string_view& name, SourceSpan where);

  void forget();  // the text so far need not stay in memory

  // ---- values
  bool value(FieldType type, Field& field);
  bool numbers(FieldType type, Value& value);
  bool integers(FieldType type, Value& value);
  bool image(Value& value);
  bool booleans(FieldType type, Value& value);
  bool strings(FieldType type, Value& value);
  bool words10(FieldType type, Value& value);
  bool nodes(FieldType type, Value& value);
  bool string(std::string_view& out);
  bool one_number(double& out);
  bool one_number(std::int32_t& out);
  double odd_number(bool whole);
  bool in_list(const char* open, bool* zero);
  void not_finite();
  void report_not_finite();
  template <class T>
  void read_list(Growing<T>& out, const char* open);
  template <class T>
  void read_some(Growing<T>& out, std::size_t most);
  template <class T>
  bool read_numbers(FieldType type, Growing<T>& out);

  // ---- prototypes and routes
  void prototype();
  void external_prototype();
  std::span<FieldSpec> interface(bool external);
  bool declared(FieldSpec::Access access, FieldSpec& spec, bool with_value);
  void add_declared(const FieldSpec& spec, SourceSpan where, std::vector<FieldSpec>& specs);
  Value zero_of(FieldType type);
  bool is_value(const FieldSpec& spec, Field& field);
  void route();
  const FieldSpec* route_end(std::string_view text, SourceSpan where, bool source);

  // ---- recovery
  void skip_value();            // of an unknown field
  void skip_braces();           // from "{" or "[" to its closing one
  void skip_stray(char close);  // unexpected tokens, with one message
  void skip_string();

  ReaderContext& context_;
  Document& document_;
  const Limits& limits_;
  Arena& arena_;
  const char* begin_;
  const char* end_;
  const char* p_;
  const char* forgotten_;  // up to here
  const char* forget_at_;  // worthwhile from here on
  bool vrml97_;
  bool latin1_ = false;
  Scope* scope_ = nullptr;
  std::uint32_t depth_ = 0;
  std::uint32_t unknown_depth_ = 0;  // of unknown nodes
  std::uint32_t problems_ = 0;
  bool whole_reported_ = false;
  bool end_reported_ = false;
  std::size_t nonfinite_ = 0;  // in the current list; position of the first
  SourceSpan nonfinite_at_;
  const Body* field_names_ = nullptr;  // of the current node
  Growing<double> doubles_;
  Growing<std::int32_t> integers_;
  std::vector<std::string_view> strings_;
  std::vector<Node*> node_stack_;
  std::vector<Field> field_stack_;
};

}  // namespace panwright::importers::vrml
