#include "pan/fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>

#include "base/text.h"

namespace panwright::pan {

namespace {

using layout::FieldRule;
using layout::SectionKind;

// Replaces each {field} or {field:format} of a text by value(field, format).
template <class Value>
std::string filled(std::string_view text, SectionKind kind, Value value) {
  std::string out;
  while (!text.empty()) {
    const std::size_t open = std::min(text.find('{'), text.size());
    out += text.substr(0, open);
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    const std::string_view inner = text.substr(open + 1, close - open - 1);
    const std::size_t colon = std::min(inner.find(':'), inner.size());
    out += value(*fields_of(kind, inner.substr(0, colon)).front(), inner.substr(colon));
    text.remove_prefix(close + 1);
  }
  return out;
}

}  // namespace

std::vector<const FieldRule*> fields_of(SectionKind kind) {
  std::vector<const FieldRule*> out;
  for (const FieldRule& field : layout::kFieldRules)
    if (field.section == kind) out.push_back(&field);
  return out;
}

std::vector<const FieldRule*> fields_of(SectionKind kind, std::string_view names) {
  const std::vector<const FieldRule*> all = fields_of(kind);
  std::vector<const FieldRule*> out;
  while (!names.empty()) {
    const std::size_t space = std::min(names.find(' '), names.size());
    const auto found = std::ranges::find_if(
        all, [&](const FieldRule* field) { return names.substr(0, space) == field->name; });
    assert(found != all.end());
    out.push_back(*found);
    names.remove_prefix(std::min(space + 1, names.size()));
  }
  return out;
}

std::int64_t reference_of(const FieldRule& field, const std::byte* record) {
  std::uint32_t value;
  std::memcpy(&value, record + field.offset, sizeof value);
  return value == 0xffffffffu ? -1 : std::int64_t{value};
}

std::string value_words(const FieldRule& field, const std::byte* record) {
  if (field.names != nullptr)
    return field.names[static_cast<std::size_t>(reference_of(field, record))];
  return with_values(field, record, []<class T>(std::vector<T>& values) {
    for (T& value : values) value = static_cast<T>(value + T(0));  // -0 is 0
    return fmt::format("{}", fmt::join(values, " "));
  });
}

std::string record_words(const Model& model, SectionKind kind, std::int64_t i) {
  if (i < 0) return "none";
  const auto index = static_cast<std::size_t>(i);
  if (kind == SectionKind::nodes) return "node " + in_quotes(model.node_path(index));
  const std::string_view words = table_info(kind).words;
  if (words.empty()) return fmt::format("{}[{}]", section_info(kind).name, i);
  const std::byte* record = record_at(model, kind, index);
  return filled(words, kind, [&](const FieldRule& field, std::string_view) {
    if (is_string(field))
      return in_quotes(model.string(static_cast<std::uint32_t>(reference_of(field, record))));
    if (is_reference(field)) return record_words(model, field.target, reference_of(field, record));
    return value_words(field, record);
  });
}

std::string info_line(const Model& model, SectionKind kind, std::size_t i) {
  const std::byte* record = record_at(model, kind, i);
  return filled(table_info(kind).info, kind, [&](const FieldRule& field, std::string_view format) {
    if (is_string(field))
      return std::string(model.string(static_cast<std::uint32_t>(reference_of(field, record))));
    if (is_reference(field)) return record_words(model, field.target, reference_of(field, record));
    if (format.empty()) return value_words(field, record);
    return with_values(field, record, [&](const auto& values) {
      return fmt::format(fmt::runtime(fmt::format("{{{}}}", format)), values.front());
    });
  });
}

}  // namespace panwright::pan
