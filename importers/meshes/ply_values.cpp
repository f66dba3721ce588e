#include "importers/meshes/ply_values.h"

#include <fmt/core.h>

#include <bit>
#include <charconv>
#include <utility>

#include "base/text.h"
#include "importers/meshes/text.h"

namespace panwright::importers::meshes {

namespace {

constexpr std::pair<std::string_view, PlyType> kTypes[] = {
    {"char", PlyType::int8},       {"uchar", PlyType::uint8},    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},   {"int", PlyType::int32},      {"uint", PlyType::uint32},
    {"float", PlyType::float32},   {"double", PlyType::float64}, {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},     {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},     {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
    {"float64", PlyType::float64},
};

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes)
      : lines_(bytes, bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n' ? '\r' : '\n') {}

  PlyHeader read() {
    std::string_view line;
    lines_.next(line);  // "ply"
    bool ended = false, has_format = false;
    while (out_.problem.empty() && !ended && lines_.next(line)) {
      std::string_view rest = line;
      const std::string_view key = next_word(rest);
      if (key == "end_header")
        ended = true;
      else if (key == "format")
        has_format = read_format(line, rest);
      else if (key == "comment")
        read_comment(rest);
      else if (key == "element")
        read_element(line, rest);
      else if (key == "property")
        read_property(line, rest);
      else if (key == "Created" && trimmed(rest).starts_with("by "))
        out_.credit = trimmed(line);
      else if (key != "obj_info" && !key.empty())
        wrong(key, fmt::format("{} is not a keyword of a PLY header", in_quotes(key)));
    }
    if (out_.problem.empty() && !ended) wrong(line, "the header has no 'end_header'");
    if (out_.problem.empty() && !has_format) wrong(line, "the header has no 'format'");
    out_.body = lines_.rest();
    return std::move(out_);
  }

 private:
  void wrong(std::string_view place, std::string message) {
    out_.problem = std::move(message);
    out_.place = place;
  }

  bool read_format(std::string_view line, std::string_view rest) {
    const std::string_view name = next_word(rest);
    if (name == "ascii")
      out_.order = PlyOrder::text;
    else if (name == "binary_little_endian")
      out_.order = PlyOrder::little;
    else if (name == "binary_big_endian")
      out_.order = PlyOrder::big;
    else
      wrong(name.empty() ? line : name,
            fmt::format("the format {} is not 'ascii', 'binary_little_endian' or "
                        "'binary_big_endian'",
                        in_quotes(name)));
    return true;
  }

  // what MeshLab writes
  void read_comment(std::string_view rest) {
    if (next_word(rest) == "TextureFile") out_.textures.emplace_back(trimmed(rest));
  }

  void read_element(std::string_view line, std::string_view rest) {
    PlyElement element;
    element.name = next_word(rest);
    const std::string_view count = next_word(rest);
    const auto [end, error] =
        std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size())
      return wrong(count.empty() ? line : count,
                   fmt::format("{} is not a number of elements", in_quotes(count)));
    out_.elements.push_back(std::move(element));
  }

  void read_property(std::string_view line, std::string_view rest) {
    if (out_.elements.empty()) return wrong(line, "a property before the first element");
    PlyProperty property;
    std::string_view type = next_word(rest);
    if (type == "list") {
      const std::string_view count = next_word(rest);
      property.count = ply_type_of(count);
      if (!property.count || is_float(*property.count))
        return wrong(count.empty() ? line : count,
                     fmt::format("{} is not a type of a list's length", in_quotes(count)));
      type = next_word(rest);
    }
    const auto found = ply_type_of(type);
    if (!found)
      return wrong(type.empty() ? line : type,
                   fmt::format("{} is not a PLY type", in_quotes(type)));
    property.type = *found;
    property.place = next_word(rest);
    property.name = property.place;
    out_.elements.back().properties.push_back(std::move(property));
  }

  Lines lines_;
  PlyHeader out_;
};

}  // namespace

std::optional<PlyType> ply_type_of(std::string_view name) {
  for (const auto& [known, type] : kTypes)
    if (name == known) return type;
  return std::nullopt;
}

std::size_t bytes_of(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

std::uint64_t PlyElement::least_bytes(bool text) const {
  std::uint64_t sum = 0;
  for (const PlyProperty& property : properties)
    sum += text ? 2 : bytes_of(property.count.value_or(property.type));
  return sum;
}

PlyHeader ply_header_of(std::string_view bytes) { return HeaderReader(bytes).read(); }

PlyValues::Got PlyValues::next(PlyType type, double& number) {
  if (order_ == PlyOrder::text) {
    std::string_view rest = body_.substr(at_);
    const std::string_view word = next_word(rest);
    begin_ = body_.size() - rest.size() - word.size();
    at_ = body_.size() - rest.size();
    if (word.empty()) return Got::end;
    const auto value = parse_double(word);
    if (!value) return Got::word;
    number = *value;
    return Got::number;
  }
  const std::size_t size = bytes_of(type);
  begin_ = at_;
  if (left() < size) return Got::end;
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const std::size_t i = order_ == PlyOrder::little ? size - 1 - k : k;
    bits = bits << 8 | static_cast<std::uint8_t>(body_[at_ + i]);
  }
  at_ += size;
  switch (type) {
    case PlyType::int8:
      number = static_cast<std::int8_t>(bits);
      break;
    case PlyType::int16:
      number = static_cast<std::int16_t>(bits);
      break;
    case PlyType::int32:
      number = static_cast<std::int32_t>(bits);
      break;
    case PlyType::uint8:
    case PlyType::uint16:
    case PlyType::uint32:
      number = static_cast<double>(bits);
      break;
    case PlyType::float32:
      number = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      break;
    case PlyType::float64:
      number = std::bit_cast<double>(bits);
      break;
  }
  return Got::number;
}

bool PlyValues::skip(std::uint64_t bytes) {
  if (left() < bytes) return false;
  at_ += bytes;
  return true;
}

void PlyValues::skip_line() {
  while (at_ < body_.size() && body_[at_] != '\n' && body_[at_] != '\r') ++at_;
}

}  // namespace panwright::importers::meshes
