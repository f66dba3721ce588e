#include "pxn/edit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "base/text.h"
#include "pxn/materials.h"
#include "pxn/text/grammar.h"
#include "pxn/text/xml.h"

namespace panwright::pxn {
namespace {

using schemas::ElementId;

bool is_separator(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

// Element of a preset.
struct PresetPart {
  std::string name;
  std::string text;
  std::vector<EditableNumber> numbers;  // at places in `text`
};

class Finder {
 public:
  Finder(const xml::Document& document, const DiagnosticLog& log) : doc_(document), log_(log) {}

  std::vector<EditableMaterial> foils() {
    std::vector<EditableMaterial> out;
    std::map<std::string, int> names;
    for (std::uint32_t element = 0; element < doc_.size(); ++element) {
      if (doc_.elements[element].id != ElementId::mli) continue;
      EditableMaterial foil;
      foil.name = attribute(element, "name");
      if (foil.name.empty()) foil.name = "foil";
      if (const int count = ++names[foil.name]; count > 1) foil.name += fmt::format(" {}", count);
      foil.line = log_.sources().position(doc_.file, doc_.elements[element].begin).line;
      add(element, foil.numbers);
      std::erase_if(foil.numbers, [](const EditableNumber& number) {
        for (const char* place : {"translate", "rotate", "quat", "scale"})
          if (number.attribute == place) return true;
        return false;
      });
      std::map<std::string, int> operations;
      for (std::uint32_t child = element + 1; child < doc_.elements[element].next; ++child) {
        if (doc_.elements[child].id == schemas::kNoElement) continue;
        const std::size_t first = foil.numbers.size();
        add(child, foil.numbers);
        if (first == foil.numbers.size()) continue;
        const std::string name = foil.numbers[first].element;
        if (const int count = ++operations[name]; count > 1)
          for (std::size_t i = first; i < foil.numbers.size(); ++i)
            foil.numbers[i].element = fmt::format("{} {}", name, count);
      }
      out.push_back(std::move(foil));
    }
    return out;
  }

  std::vector<EditableMaterial> materials() {
    std::vector<EditableMaterial> out;
    for (std::uint32_t element = 0; element < doc_.size(); ++element) {
      if (doc_.elements[element].id != ElementId::named_material) continue;
      EditableMaterial material;
      material.name = attribute(element, "name");
      material.preset = attribute(element, "preset");
      material.base = attribute(element, "base");
      material.line = log_.sources().position(doc_.file, doc_.elements[element].begin).line;
      for (std::uint32_t child = element + 1; child < doc_.elements[element].next; ++child)
        if (doc_.elements[child].id != schemas::kNoElement) add(child, material.numbers);
      if (const auto preset = preset_text(material.preset)) inherit(element, *preset, material);
      if (!material.name.empty()) out.push_back(std::move(material));
    }
    return out;
  }

  // Elements of the first material, with their numbers at places in them.
  std::vector<PresetPart> parts() {
    std::vector<PresetPart> out;
    std::uint32_t material = 0;
    while (material < doc_.size() && doc_.elements[material].id != ElementId::named_material)
      ++material;
    if (material == doc_.size()) return out;
    for (std::uint32_t child = material + 1; child < doc_.elements[material].next;
         child = doc_.elements[child].next) {
      PresetPart part{std::string(doc_.name(child)), {}, {}};
      for (std::uint32_t each = child; each < doc_.elements[child].next; ++each)
        if (doc_.elements[each].id != schemas::kNoElement) add(each, part.numbers);
      const std::uint32_t begin = doc_.elements[child].begin;
      part.text = doc_.bytes.substr(begin, doc_.elements[child].end - begin);
      // on one line: the lines of the text that it is written into stay where they are
      std::ranges::replace(part.text, '\n', ' ');
      for (EditableNumber& number : part.numbers) number.begin -= begin, number.end -= begin;
      out.push_back(std::move(part));
    }
    return out;
  }

 private:
  void inherit(std::uint32_t element, std::string_view preset, EditableMaterial& material) const;

  std::string attribute(std::uint32_t element, std::string_view name) const {
    const xml::Attribute* found = find_attribute(doc_, element, name);
    return found ? xml::decoded(doc_, found->value_begin, found->value_end) : "";
  }

  void add(std::uint32_t element, std::vector<EditableNumber>& out) const {
    const xml::Element& e = doc_.elements[element];
    const schemas::Element& known = schemas::kPxn.elements[static_cast<std::size_t>(e.id)];
    for (const schemas::Attribute& each : known.attributes)
      if (const xml::Attribute* found = find_attribute(doc_, element, each.name))
        add(known.name, each.name, each.value, found->value_begin, found->value_end, out);
    // of texts in several pieces, with comments between, none is taken
    const std::uint32_t first = e.first_run, last = doc_.elements[element + 1].first_run;
    if (last == first + 1 && doc_.runs[first].owner == element)
      add(known.name, "", known.text, doc_.runs[first].begin, doc_.runs[first].end, out);
  }

  void add(std::string_view element, std::string_view attribute, const schemas::Value& value,
           std::uint32_t begin, std::uint32_t end, std::vector<EditableNumber>& out) const {
    using schemas::ValueKind;
    if (value.kind != ValueKind::real && value.kind != ValueKind::integer &&
        value.kind != ValueKind::quantity)
      return;
    const std::string_view text = doc_.bytes.substr(begin, end - begin);
    if (text.find_first_of("{&") != std::string_view::npos) return;
    std::vector<EditableNumber> numbers;
    for (std::size_t at = 0; at < text.size();) {
      if (is_separator(text[at])) {
        ++at;
        continue;
      }
      std::size_t past = at;
      while (past < text.size() && !is_separator(text[past])) ++past;
      // the longest part of it that is a number; what is left is a unit
      std::size_t digits = past;
      while (digits > at && !parse_double(text.substr(at, digits - at))) --digits;
      if (digits == at) return;
      EditableNumber number;
      number.element = element;
      number.attribute = attribute;
      number.index = numbers.size();
      number.unit = text.substr(digits, past - digits);
      number.value = *parse_double(text.substr(at, digits - at));
      number.integer = value.kind == ValueKind::integer;
      number.begin = begin + static_cast<std::uint32_t>(at);
      number.end = begin + static_cast<std::uint32_t>(digits);
      numbers.push_back(std::move(number));
      at = past;
    }
    for (EditableNumber& number : numbers) {
      number.count = numbers.size();
      if (!value.numbers.empty()) {
        const schemas::Number& known =
            value.numbers[std::min(number.index, value.numbers.size() - 1)];
        number.name = known.name;
        if (number.unit.empty() && value.dimension == schemas::Dimension::none) {
          number.low = known.min;
          number.high = known.max;
          number.above = known.above;
        }
      }
      out.push_back(std::move(number));
    }
  }

  const xml::Document& doc_;
  const DiagnosticLog& log_;
};

// What `find` finds in a text.
template <class Found>
Result<std::vector<Found>> found_in(const std::string& name, std::string_view bytes,
                                    DiagnosticLog& log, std::vector<Found> (Finder::*find)()) {
  if (bytes.size() >= 0xffffffffu) {
    log.report_file(Code("E0104"), name, "the file has 4 GiB or more");
    return failed;
  }
  DiagnosticLog own;
  const auto copy = std::make_shared<const std::string>(bytes);
  const FileId file = own.sources().add({name, copy, Encoding::utf8, {}, false});
  xml::Document document = xml::scan(file, {}, own);
  const bool sound = !own.has_errors() && !document.empty();
  Reporter reporter(own);
  const bool read = sound && check_grammar(document, schemas::kPxn, reporter);
  if (!read) {
    for (const Diagnostic& each : own.entries())
      log.report_file(each.code, name, each.message, each.hint);
    return failed;
  }
  Finder finder(document, own);
  return (finder.*find)();
}

// Adds what the preset has and the text does not.
void Finder::inherit(std::uint32_t element, std::string_view preset,
                     EditableMaterial& material) const {
  DiagnosticLog ignored;
  const auto parts = found_in("preset", preset, ignored, &Finder::parts);
  if (!parts) return;
  const xml::Element& e = doc_.elements[element];
  const bool empty = e.start_tag_end == e.end;  // <material …/>
  const std::string before = empty ? ">" : "", after = empty ? "</material>" : "";
  const auto close = static_cast<std::uint32_t>(doc_.bytes.rfind('<', e.end - 1));
  for (const PresetPart& part : *parts) {
    bool present = part.name == "provenance";
    for (std::uint32_t child = element + 1; child < e.next; child = doc_.elements[child].next)
      present = present || doc_.name(child) == part.name;
    if (present) continue;
    for (EditableNumber number : part.numbers) {
      number.inserted = before + part.text + after;
      number.inserted_begin = number.begin + static_cast<std::uint32_t>(before.size());
      number.inserted_end = number.end + static_cast<std::uint32_t>(before.size());
      number.begin = empty ? e.end - 2 : close;
      number.end = empty ? e.end : close;
      material.inherited.push_back(std::move(number));
    }
  }
}

}  // namespace

Result<std::vector<EditableMaterial>> editable_materials(const std::string& name,
                                                         std::string_view bytes,
                                                         DiagnosticLog& log) {
  return found_in(name, bytes, log, &Finder::materials);
}

Result<std::vector<EditableMaterial>> editable_foils(const std::string& name,
                                                     std::string_view bytes, DiagnosticLog& log) {
  return found_in(name, bytes, log, &Finder::foils);
}

std::string with_number(std::string_view bytes, const EditableNumber& number, double value) {
  std::string out(bytes.substr(0, number.begin));
  out += number.inserted.substr(0, number.inserted_begin);
  out += number.integer ? fmt::format("{:.0f}", std::round(value)) : fmt::format("{:.6g}", value);
  out += number.inserted.substr(number.inserted_end);
  out += bytes.substr(number.end);
  return out;
}

}  // namespace panwright::pxn
