#include "importers/vrml/internal/document.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>

namespace panwright::importers::vrml {

namespace {

constexpr std::size_t kBlock = std::size_t{64} << 10;  // bytes

struct TypeInfo {
  std::string_view name;
  std::size_t width;
};

constexpr TypeInfo kTypes[] = {
    {"", 0},         {"SFBool", 1},  {"SFInt32", 1},    {"SFFloat", 1},    {"SFTime", 1},
    {"SFVec2f", 2},  {"SFVec3f", 3}, {"SFColor", 3},    {"SFRotation", 4}, {"SFMatrix", 16},
    {"SFString", 0}, {"SFEnum", 0},  {"SFBitMask", 0},  {"SFImage", 0},    {"SFNode", 0},
    {"MFBool", 1},   {"MFInt32", 1}, {"MFFloat", 1},    {"MFTime", 1},     {"MFVec2f", 2},
    {"MFVec3f", 3},  {"MFColor", 3}, {"MFRotation", 4}, {"MFString", 0},   {"MFNode", 0},
};

}  // namespace

Arena::~Arena() {
  for (void* block : blocks_) std::free(block);
}

void Arena::count(std::size_t bytes) {
  if (bytes > limit_ || used_ > limit_ - bytes) throw OverLimit{"memory", {}};
  used_ += bytes;
}

void* Arena::allocate(std::size_t bytes, std::size_t alignment) {
  const auto misplaced = reinterpret_cast<std::uintptr_t>(at_) % alignment;
  const std::size_t gap = misplaced == 0 ? 0 : alignment - misplaced;
  if (at_ == nullptr || left_ < bytes + gap) {
    const std::size_t wanted = std::max(bytes, bytes > kBlock / 4 ? bytes : kBlock);
    count(wanted);
    blocks_.reserve(blocks_.size() + 1);
    void* block = std::malloc(wanted);
    if (block == nullptr) throw OverLimit{"memory", {}};
    blocks_.push_back(block);
    if (wanted == bytes && bytes > kBlock / 4) return block;  // the open block stays open
    at_ = static_cast<std::byte*>(block);
    left_ = wanted;
    return allocate(bytes, alignment);
  }
  at_ += gap;
  left_ -= gap;
  void* out = at_;
  at_ += bytes;
  left_ -= bytes;
  return out;
}

void Arena::adopt(void* block, std::size_t bytes) {
  blocks_.push_back(block);
  count(bytes);
}

bool Arena::release(const void* block, std::size_t bytes) {
  const auto it = std::find(blocks_.rbegin(), blocks_.rend(), block);
  if (it == blocks_.rend()) return false;
  std::free(*it);
  blocks_.erase(std::next(it).base());
  used_ -= bytes;
  return true;
}

std::string_view Arena::copied(std::string_view text) {
  if (text.empty()) return {};
  char* out = static_cast<char*>(allocate(text.size(), 1));
  std::memcpy(out, text.data(), text.size());
  return {out, text.size()};
}

std::string_view type_name(FieldType type) { return kTypes[static_cast<std::size_t>(type)].name; }

bool is_list(FieldType type) { return type >= FieldType::mf_bool; }

std::size_t width_of(FieldType type) { return kTypes[static_cast<std::size_t>(type)].width; }

const FieldSpec* NodeSpec::find(std::string_view field) const {
  for (const FieldSpec& spec : fields)
    if (spec.name == field) return &spec;
  return nullptr;
}

const Field* Node::find(std::string_view field) const {
  for (std::size_t i = fields.size(); i-- > 0;)
    if (fields[i].name == field) return &fields[i];
  return nullptr;
}

const Value& Node::value(std::string_view field) const {
  if (const Field* written = find(field)) return written->value;
  assert(spec != nullptr && spec->find(field) != nullptr);
  return spec->find(field)->initial;
}

Vec2 Node::vec2(std::string_view field) const {
  const auto v = numbers(field);
  return {v[0], v[1]};
}

Vec3 Node::vec3(std::string_view field) const {
  const auto v = numbers(field);
  return {v[0], v[1], v[2]};
}

std::string_view Node::string(std::string_view field) const {
  const auto v = strings(field);
  return v.empty() ? std::string_view() : v[0];
}

Node* Node::node(std::string_view field) const {
  const auto v = nodes(field);
  return v.empty() ? nullptr : v[0];
}

SourceSpan place_of_item(const SourceMap& sources, const Field& field, std::size_t index) {
  if (field.where.file == kNoFile) return field.where;
  const auto& bytes = sources.file(field.where.file).bytes;
  if (!bytes || field.where.end > bytes->size()) return field.where;
  const std::string_view text = *bytes;
  const auto blank = [](char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ',' || c == '[' || c == ']';
  };
  std::size_t left = index * std::max<std::size_t>(1, width_of(field.value.type));
  std::size_t at = field.where.begin;
  const std::size_t end = field.where.end;
  while (at < end) {
    if (text[at] == '#') {
      while (at < end && text[at] != '\n' && text[at] != '\r') ++at;
    } else if (blank(text[at])) {
      ++at;
    } else {
      const std::size_t begin = at;
      if (text[at] == '"') {
        for (++at; at < end && text[at] != '"'; ++at)
          if (text[at] == '\\') ++at;
        at = std::min(at + 1, end);
      } else {
        while (at < end && !blank(text[at]) && text[at] != '#' && text[at] != '"') ++at;
      }
      if (left == 0)
        return {field.where.file, static_cast<std::uint32_t>(begin),
                static_cast<std::uint32_t>(at)};
      --left;
    }
  }
  return field.where;
}

}  // namespace panwright::importers::vrml
