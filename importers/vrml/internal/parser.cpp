#include "importers/vrml/internal/parser.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/node_types.h"

namespace panwright::importers::vrml {

namespace {

constexpr std::ptrdiff_t kPiece = std::ptrdiff_t{4} << 20;  // bytes of a mapped text in memory
constexpr std::size_t kMostCandidates = 5000;               // for a suggestion

}  // namespace

Parser::Parser(ReaderContext& context, Document& document)
    : context_(context),
      document_(document),
      limits_(context.options.limits),
      arena_(*document.arena),
      begin_(document.text->data()),
      end_(document.text->data() + document.text->size()),
      p_(begin_),
      forgotten_(begin_),
      forget_at_(begin_ + std::min(kPiece, end_ - begin_)),
      vrml97_(document.format == Format::vrml97) {}

void Parser::run() {
  const std::size_t bad = first_not_utf8(*document_.text);
  document_.text.forget(0, document_.text->size());
  if (bad != std::string::npos) {
    latin1_ = true;
    context_.log.sources().set_encoding(document_.file, Encoding::latin1);
    report(Code("W6116"), span(begin_ + bad, begin_ + bad + 1),
           "the text is not UTF-8 from here on, and is read as Latin-1");
  }
  if (document_.text->starts_with("\xef\xbb\xbf")) p_ += 3;
  drop_padding();
  Scope scope;
  scope_ = &scope;
  for (skip_blanks(); !at_end(); skip_blanks()) statement(document_.nodes);
  document_.text.forget(0, document_.text->size());
  scope_ = nullptr;
}

void Parser::drop_padding() {
  const auto padding = [](char c) { return c == '\0' || c == '\x1a'; };  // ^Z ends texts of DOS
  const char* first = end_;
  for (const char* c = end_; c > p_ && (padding(c[-1]) || is_blank(c[-1])); --c)
    if (padding(c[-1])) first = c - 1;
  if (first == end_) return;
  report(Code("W6118"), span(first, first + 1),
         fmt::format("{} from here to the end are not text",
                     counted(static_cast<std::size_t>(end_ - first), "byte")));
  end_ = first;
}

// ---- tokens

void Parser::skip_blanks() {
  for (;;) {
    while (is_blank(*p_)) ++p_;
    if (*p_ != '#') return;
    while (p_ < end_ && *p_ != '\n' && *p_ != '\r') ++p_;
  }
}

bool Parser::at_number() const {
  const char* p = p_;
  if (*p == '+' || *p == '-') ++p;
  if (*p == '.') ++p;
  return *p >= '0' && *p <= '9';
}

bool Parser::at_word() const { return is_word(*p_) && !at_number(); }

std::string_view Parser::peek_word() {
  const char* p = p_;
  while (is_word(*p)) ++p;
  return {p_, static_cast<std::size_t>(p - p_)};
}

std::string_view Parser::word() {
  const std::string_view out = peek_word();
  p_ += out.size();
  return out;
}

std::string_view Parser::name() { return as_utf8(word()); }

// note: Part[1] and "Solar Panel" are names to those who write them
std::string_view Parser::given_name() {
  skip_blanks();
  const char* const at = p_;
  if (*p_ == '"') {
    std::string_view text;
    if (!string(text)) return {};
    report(Code("W6118"), span(at, p_), "a name without quotes");
    return text;
  }
  word();
  if (p_ > at && *p_ == '[') {
    const char* end = p_ + 1;
    while (is_word(*end)) ++end;
    if (*end == ']') {
      p_ = end + 1;
      word();
      report(Code("W6118"), span(at, p_), "a name has no brackets");
    }
  }
  return as_utf8({at, static_cast<std::size_t>(p_ - at)});
}

std::string_view Parser::as_utf8(std::string_view text) {
  if (!latin1_ || first_not_utf8(text) == text.npos) return text;
  return arena_.copied(std::string_view(to_utf8(text, Encoding::latin1)));
}

bool Parser::accept(char c) {
  skip_blanks();
  if (*p_ != c || at_end()) return false;
  ++p_;
  return true;
}

bool Parser::accept_word(std::string_view text) {
  skip_blanks();
  if (peek_word() != text) return false;
  p_ += text.size();
  return true;
}

bool Parser::brace_follows() {
  const char* const at = p_;
  word();
  skip_blanks();
  const bool out = *p_ == '{';
  p_ = at;
  return out;
}

std::string_view Parser::token_here() {
  if (at_end()) return {};
  std::string_view out = peek_word();
  if (out.empty()) out = std::string_view(p_, 1);
  return out;
}

SourceSpan Parser::span(const char* begin, const char* end) const {
  return {document_.file, static_cast<std::uint32_t>(begin - begin_),
          static_cast<std::uint32_t>(end - begin_)};
}

SourceSpan Parser::here() {
  const std::string_view token = token_here();
  return span(p_, p_ + token.size());
}

void Parser::forget() {
  context_.job.poll();
  document_.text.forget(static_cast<std::size_t>(forgotten_ - begin_),
                        static_cast<std::size_t>(p_ - begin_));
  forgotten_ = p_;
  forget_at_ = p_ + std::min(kPiece, end_ - p_);
}

// ---- messages

bool Parser::terse() {
  constexpr std::uint32_t kMany = 200;
  return problems_ > kMany;
}

void Parser::report(Code code, SourceSpan where, std::string message, std::string hint) {
  ++problems_;
  context_.log.report(code, where, std::move(message), std::move(hint));
}

// Says once, of the innermost, what the end of the text cuts off.
void Parser::text_ends(SourceSpan where, std::string_view what) {
  if (!std::exchange(end_reported_, true))
    report(Code("E6112"), where, fmt::format("the text ends inside this {}", what));
}

// ---- nodes

void Parser::statement(std::vector<Node*>& out) {
  if (at_word()) {
    if (vrml97_ && declaration()) return;
    bool there = false;
    Node* node = node_value(&there);
    if (node != nullptr) out.push_back(node);
    if (there) return;
  }
  skip_stray('\0');
}

bool Parser::declaration() {
  if (*p_ != 'P' && *p_ != 'E' && *p_ != 'R') return false;
  const std::string_view keyword = peek_word();
  if (keyword == "PROTO") {
    prototype();
  } else if (keyword == "EXTERNPROTO") {
    external_prototype();
  } else if (keyword == "ROUTE") {
    route();
  } else {
    return false;
  }
  return true;
}

Node* Parser::node_value(bool* there) {
  skip_blanks();
  *there = at_word();
  if (!*there) return nullptr;
  const std::string_view keyword = peek_word();
  if (keyword == "NULL") {
    word();
    return nullptr;
  }
  if (keyword == "USE") return use();
  if (keyword != "DEF") return typed_node({});
  word();
  skip_blanks();
  if (!is_word(*p_) && *p_ != '"') {
    report(Code("E6103"), here(), "a name is missing after DEF");
    return typed_node({});
  }
  const std::string_view def = given_name();
  return typed_node(def);
}

Node* Parser::use() {
  word();
  skip_blanks();
  if (!is_word(*p_) && *p_ != '"') {
    report(Code("E6103"), here(), "a name is missing after USE");
    return nullptr;
  }
  const char* const at = p_;
  const std::string_view text = given_name();
  const auto it = scope_->nodes.find(text);
  if (it != scope_->nodes.end()) {
    it->second->again = true;
    return it->second;
  }
  std::string hint;
  if (!terse() && scope_->nodes.size() < kMostCandidates) {
    std::vector<std::string_view> names;
    for (const auto& [other, node] : scope_->nodes) names.push_back(other);
    if (const auto near = nearest_name(text, names))
      hint = fmt::format("did you mean {}?", in_quotes(*near));
  }
  report(Code("E6108"), span(at, p_),
         fmt::format("nothing before it is called {}", in_quotes(text)), std::move(hint));
  return nullptr;
}

Node* Parser::typed_node(std::string_view def) {
  context_.job.poll();
  skip_blanks();
  if (!at_word()) {
    report(Code("E6103"), here(), "the type of a node is missing");
    if (*p_ == '{') skip_braces();
    return nullptr;
  }
  const char* const at = p_;
  std::string_view type = word();
  const SourceSpan where = span(at, p_);
  skip_blanks();
  if (*p_ != '{') {
    if (vrml97_ && (type == "ROUTE" || type == "PROTO" || type == "EXTERNPROTO")) p_ = at;
    report(Code("E6103"), where,
           fmt::format("{} is not a node: '{{' does not follow", in_quotes(type)));
    return nullptr;
  }
  Node* node = arena_.make<Node>();
  node->where = where;
  node->name = def;
  Body body{node, {}, true};
  node->prototype = vrml97_ ? prototype_named(type) : nullptr;
  if (node->prototype != nullptr) {
    body.specs = node->prototype->fields;
  } else {
    node->spec = spec_named(type, where);
    body.known = node->spec != nullptr;
    if (body.known) body.specs = node->spec->fields;
    body.script = vrml97_ && type == "Script";
  }
  node->type = type;
  if (!def.empty()) scope_->nodes[def] = node;
  if (++depth_ > limits_.depth) throw OverLimit{"depth", where};
  ++p_;
  const std::uint32_t unknown = body.known ? 0 : 1;
  unknown_depth_ += unknown;
  fill(*node, body);
  unknown_depth_ -= unknown;
  --depth_;
  declare_files(*node);
  return node;
}

// Files that a node names are the model's, also where nothing of it is used: in the branches of a
// Switch, for instance. Of prototypes any text may be such a name.
void Parser::declare_files(const Node& node) const {
  if (node.type == "Script") return;
  for (const Field& field : node.fields) {
    const bool text =
        field.value.type == FieldType::mf_string || field.value.type == FieldType::sf_string;
    const bool names = field.name == "url" || field.name.ends_with("Url") ||
                       field.name == "filename" || node.prototype != nullptr ||
                       (field.name == "name" && node.type == "WWWInline");
    if (!text || !names) continue;
    for (const std::string_view url : field.value.strings())
      declare(context_.files, document_.path, url, true);
  }
}

const NodeSpec* Parser::spec_named(std::string_view& name, SourceSpan where) {
  const NodeSpec* spec = vrml97_ ? spec97(name) : spec10(name);
  if (spec != nullptr) return spec;
  if (unknown_depth_ > 0) return nullptr;  // what is around it is skipped, and has been reported
  if (vrml97_ && is_transform10(name)) {
    report(Code("W6118"), where,
           fmt::format("{} is a node of VRML 1.0; it transforms the nodes after it in its group",
                       in_quotes(name)));
    return spec10(name);
  }
  std::vector<std::string_view> names;
  for (const NodeSpec& other : vrml97_ ? specs97() : specs10()) names.push_back(other.name);
  for (const Scope* scope = scope_; scope != nullptr; scope = scope->around)
    for (const auto& [other, prototype] : scope->prototypes) names.push_back(other);
  std::string hint;
  const auto near =
      terse() || names.size() > kMostCandidates ? std::nullopt : nearest_name(name, names);
  spec = near ? (vrml97_ ? spec97(*near) : spec10(*near)) : nullptr;
  if (spec != nullptr && same_but_for_case(name, *near)) {
    report(Code("W6118"), where,
           fmt::format("{} is read as '{}': case matters", in_quotes(name), *near));
    name = *near;
    return spec;
  }
  if (near)
    hint = fmt::format("did you mean {}?", in_quotes(*near));
  else if (vrml97_ ? spec10(name) != nullptr : spec97(name) != nullptr)
    hint = vrml97_ ? "it is a node of VRML 1.0" : "it is a node of VRML 97";
  report(Code("W6105"), where, fmt::format("unknown node {}; it is skipped", in_quotes(name)),
         std::move(hint));
  return nullptr;
}

Prototype* Parser::prototype_named(std::string_view text) const {
  for (const Scope* scope = scope_; scope != nullptr; scope = scope->around) {
    const auto it = scope->prototypes.find(text);
    if (it != scope->prototypes.end()) return it->second;
  }
  return nullptr;
}

}  // namespace panwright::importers::vrml
