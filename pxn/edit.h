// Numbers of materials and foil at their places in a text, for editors that change one of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright::pxn {

// Number as written: of the text of an element inside a material, or of its attribute.
struct EditableNumber {
  std::string element;    // "diffuse"
  std::string attribute;  // "shine"; empty: of the element's text
  std::size_t index = 0;  // there
  std::size_t count = 1;  // numbers there
  std::string name;       // in the language: "red"; may be empty
  std::string unit;       // behind it: "deg"; may be empty
  double value = 0;       // as written, in that unit
  // range in the language, without a unit
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above = false;  // low itself is not allowed
  bool integer = false;
  std::uint32_t begin = 0;  // bytes of the text, without the unit
  std::uint32_t end = 0;
  // Of a preset: the element that takes the place of these bytes, and the number's bytes in it.
  std::string inserted;
  std::uint32_t inserted_begin = 0, inserted_end = 0;
};

// Named material of one file, or a sheet of foil.
struct EditableMaterial {
  std::string name;
  std::string preset;  // base preset; may be empty
  std::string base;    // base material of the same text; may be empty
  std::uint32_t line = 1;
  std::vector<EditableNumber> numbers;  // in the order of the text
  // Of the preset, without elements that the text has: a change writes their element into the text.
  std::vector<EditableNumber> inherited;
};

// Returns the named materials of a text, with their literal numbers: no expressions, and none in
// texts with references.
//
//   name, bytes  of the file
// Fails: E0104 for 4 GiB or more, E1001 to E1008, E1107. Grammar errors are not reported. Cost:
// O(bytes).
Result<std::vector<EditableMaterial>> editable_materials(const std::string& name,
                                                         std::string_view bytes,
                                                         DiagnosticLog& log);

// The same for sheets of foil: the numbers of <mli> except its placement, of its settings and of
// its operations, in order; the second <crease> is named "crease 2". name: that of the sheet, else
// "foil", "foil 2" …
Result<std::vector<EditableMaterial>> editable_foils(const std::string& name,
                                                     std::string_view bytes, DiagnosticLog& log);

// Returns the text with another number, rounded to six digits: nothing else differs.
//
// Expects: a number of this text; a finite value.
std::string with_number(std::string_view bytes, const EditableNumber& number, double value);

}  // namespace panwright::pxn
