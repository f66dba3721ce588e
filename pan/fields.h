// Records field by field, as the tables of the layout describe them: for what shows or compares
// every table alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "pan/model.h"

namespace panwright::pan {

inline const layout::SectionInfo& section_info(layout::SectionKind kind) {
  return layout::kSections[layout::place_of(static_cast<std::uint32_t>(kind))];
}
inline const layout::TableInfo& table_info(layout::SectionKind kind) {
  return layout::kTables[layout::place_of(static_cast<std::uint32_t>(kind))];
}

// A field that numbers a string, or a record of another table.
inline bool is_string(const layout::FieldRule& field) {
  return field.target == layout::SectionKind::string_offsets;
}
inline bool is_reference(const layout::FieldRule& field) {
  return !is_string(field) && (field.kind == layout::FieldRuleKind::reference ||
                               field.kind == layout::FieldRuleKind::reference_or_none);
}

// Fields of a section's records by their names, which stand with spaces between, in that order.
std::vector<const layout::FieldRule*> fields_of(layout::SectionKind kind, std::string_view names);
// All of them, in the order of the record.
std::vector<const layout::FieldRule*> fields_of(layout::SectionKind kind);

// The bytes of a record.
inline const std::byte* record_at(const Model& model, layout::SectionKind kind, std::size_t i) {
  return model.section(kind).data() + i * section_info(kind).stride;
}

// The number of a string or of a record; -1: none.
std::int64_t reference_of(const layout::FieldRule& field, const std::byte* record);

// Calls use(values) with the numbers of a field: std::vector<T>, T the field's type.
template <class Use>
auto with_values(const layout::FieldRule& field, const std::byte* record, Use use) {
  const auto as = [&]<class T>(T) {
    std::vector<T> values(field.count);
    std::memcpy(values.data(), record + field.offset, values.size() * sizeof(T));
    return use(values);
  };
  switch (field.type) {
    case layout::FieldType::u8:
      return as(std::uint8_t{});
    case layout::FieldType::u16:
      return as(std::uint16_t{});
    case layout::FieldType::i32:
      return as(std::int32_t{});
    case layout::FieldType::u64:
      return as(std::uint64_t{});
    case layout::FieldType::f32:
      return as(float{});
    case layout::FieldType::f64:
      return as(double{});
    case layout::FieldType::u32:
      break;
  }
  return as(std::uint32_t{});
}

// Returns a field's numbers with spaces between, or the name of its value in an enumeration. -0 is
// 0.
std::string value_words(const layout::FieldRule& field, const std::byte* record);

// Returns a record in messages, as the layout's `words` say: "node 'bus/panel'", "mesh 'hull' at
// node 'bus'"; -1: "none".
//
// Expects, this and info_line(): checked().
std::string record_words(const Model& model, layout::SectionKind kind, std::int64_t i);

// Returns a record's line in `panwright info`, as the layout's `info` says; empty: it has none.
std::string info_line(const Model& model, layout::SectionKind kind, std::size_t i);

}  // namespace panwright::pan
