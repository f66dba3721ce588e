// Rules that all tables have in common: of fields, order, numbers of records.
#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "base/text.h"
#include "pan/fields.h"
#include "pan/internal/report.h"

namespace panwright::pan::internal {

namespace {

using layout::FieldRule;
using layout::FieldRuleKind;
using layout::FieldType;
using layout::SectionKind;

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

// ---- field rules

bool number_holds(FieldRuleKind kind, double value) {
  if (!std::isfinite(value)) return false;
  return kind == FieldRuleKind::finite || kind == FieldRuleKind::unit ||
         (kind == FieldRuleKind::nonzero && value != 0) ||
         (kind == FieldRuleKind::not_negative && value >= 0);
}

bool holds(const FieldRule& rule, const std::byte* at, std::uint64_t limit) {
  if (rule.type == FieldType::f64) return number_holds(rule.kind, load<double>(at));
  if (rule.type == FieldType::f32) {
    const float value = load<float>(at);
    // products of few parameters stay within single precision
    const bool fits = rule.section != SectionKind::materials ||
                      std::fabs(value) <= static_cast<float>(layout::kMaxNumber);
    return fits && number_holds(rule.kind, value);
  }
  const auto value = load<std::uint32_t>(at);
  switch (rule.kind) {
    case FieldRuleKind::zero:
      return value == 0;
    case FieldRuleKind::range:
      return value >= rule.low && value <= rule.high;
    case FieldRuleKind::mask:
      return (value & ~rule.high) == 0;
    case FieldRuleKind::reference_or_none:
      return value == 0xffffffffu || value < limit;
    default:
      return value < limit;
  }
}

std::string number_words(const FieldRule& rule, const std::byte* at) {
  if (rule.type == FieldType::f64) return fmt::format("{}", load<double>(at));
  if (rule.type == FieldType::f32) return fmt::format("{}", load<float>(at));
  if (rule.type == FieldType::i32) return fmt::format("{}", load<std::int32_t>(at));
  return fmt::format("{}", load<std::uint32_t>(at));
}

std::string rule_words(const FieldRule& rule, std::uint64_t limit) {
  const bool strings = rule.target == SectionKind::string_offsets;
  switch (rule.kind) {
    case FieldRuleKind::finite:
    case FieldRuleKind::unit:
      return "expected a finite number";
    case FieldRuleKind::not_negative:
      return "expected a finite number of at least 0";
    case FieldRuleKind::nonzero:
      return "expected a finite number other than 0";
    case FieldRuleKind::zero:
      return "expected 0";
    case FieldRuleKind::range:
      return fmt::format("expected {} to {}", rule.low, rule.high);
    case FieldRuleKind::mask:
      return fmt::format("expected no bits other than {:#x}", rule.high);
    default:
      return strings ? "but the file has " + counted(limit, "string")
                     : fmt::format("but '{}' has {}", section_info(rule.target).name,
                                   counted(limit, "element"));
  }
}

void check_rule(const Model& model, const FieldRule& rule, Problems& problems) {
  const auto bytes = model.section(rule.section);
  const std::uint32_t stride = section_info(rule.section).stride;
  const std::uint64_t limit = count_of(model, rule.target);
  const std::size_t width = rule.type == FieldType::f64 ? 8 : 4;
  for (std::size_t record = 0; record < bytes.size() / stride; ++record) {
    for (std::uint32_t k = 0; k < rule.count; ++k) {
      const std::byte* at = bytes.data() + record * stride + rule.offset + k * width;
      if (holds(rule, at, limit)) continue;
      const bool reference =
          rule.kind == FieldRuleKind::reference || rule.kind == FieldRuleKind::reference_or_none;
      const std::string part = rule.count > 1 ? fmt::format("[{}]", k) : std::string();
      problems.push_back(
          {reference ? Code("E4010") : Code("E4012"),
           fmt::format("{}[{}].{}{} is {}, {}", section_info(rule.section).name, record, rule.name,
                       part, number_words(rule, at), rule_words(rule, limit))});
      return;
    }
  }
}

// ---- across fields and records

bool is_unit(const FieldRule& rule, const std::byte* record) {
  double squared = 0;
  for (std::uint32_t k = 0; k < rule.count; ++k) {
    const auto value = load<double>(record + rule.offset + 8 * k);
    squared += value * value;
  }
  return std::fabs(squared - 1.0) <= kUnitQuaternionTolerance;
}

void check_unit(const Model& model, const FieldRule& rule, Problems& problems) {
  const std::size_t count = model.section(rule.section).size() / section_info(rule.section).stride;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = record_at(model, rule.section, i);
    if (is_unit(rule, record)) continue;
    problems.push_back({Code("E4012"), fmt::format("{}[{}].{} is {}, expected a unit {}",
                                                   section_info(rule.section).name, i, rule.name,
                                                   value_words(rule, record),
                                                   rule.count == 4 ? "quaternion" : "vector")});
    return;
  }
}

// Below 0: a record stands before the one behind it.
int compared(const std::vector<const FieldRule*>& fields, const std::byte* a, const std::byte* b) {
  for (const FieldRule* field : fields) {
    const int order = with_values(*field, a, [&](const auto& first) {
      return with_values(*field, b, [&](const auto& second) {
        const auto x = static_cast<double>(first.front()), y = static_cast<double>(second.front());
        return x < y ? -1 : x > y ? 1 : 0;
      });
    });
    if (order != 0) return order;
  }
  return 0;
}

void check_order(const Model& model, SectionKind kind, Problems& problems) {
  const auto fields = fields_of(kind, table_info(kind).order);
  const std::size_t count = model.section(kind).size() / section_info(kind).stride;
  for (std::size_t i = 1; i < count; ++i) {
    if (compared(fields, record_at(model, kind, i - 1), record_at(model, kind, i)) < 0) continue;
    std::string names = fields.front()->name;
    for (std::size_t k = 1; k < fields.size(); ++k)
      names += fmt::format(", then by {}", fields[k]->name);
    problems.push_back(
        {Code("E4012"),
         fmt::format("{}[{}] is out of order, expected them ascending by {}{}",
                     section_info(kind).name, i, names, fields.size() == 1 ? ", each once" : "")});
    return;
  }
}

void check_count(const Model& model, SectionKind kind, Problems& problems) {
  const layout::TableInfo& table = table_info(kind);
  const std::uint64_t count = count_of(model, kind);
  if (table.most > 0 && (count < table.least || count > table.most))
    problems.push_back(
        {Code("E4012"),
         fmt::format("section '{}' has {} records, expected {}{}", section_info(kind).name, count,
                     table.least == table.most ? "" : "at most ", table.most)});
  const std::uint64_t others = count_of(model, table.each);
  if (table.each != kind && count != 0 && count != others)
    problems.push_back(
        {Code("E4010"),
         fmt::format("section '{}' has {}, but section '{}' has {}", section_info(kind).name,
                     counted(count, "element"), section_info(table.each).name, others)});
}

}  // namespace

std::uint64_t count_of(const Model& model, SectionKind kind) {
  const layout::DirectoryEntry* entry = model.entry(kind);
  const std::uint64_t count = entry ? entry->count : 0;
  // offsets enclose strings, so there is one more of them
  return kind == SectionKind::string_offsets && count > 0 ? count - 1 : count;
}

Problems rule_problems(const Model& model) {
  Problems problems;
  for (const FieldRule& rule : layout::kFieldRules)
    if (rule.kind != FieldRuleKind::any) check_rule(model, rule, problems);
  for (const FieldRule& rule : layout::kFieldRules)
    if (rule.kind == FieldRuleKind::unit) check_unit(model, rule, problems);
  for (const layout::SectionInfo& info : layout::kSections) {
    check_count(model, info.kind, problems);
    if (table_info(info.kind).order[0] != '\0') check_order(model, info.kind, problems);
  }
  return problems;
}

}  // namespace panwright::pan::internal
