// Values between tags and in attributes, checked against their types and ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pxn/expression/expression.h"
#include "pxn/expression/scope.h"
#include "pxn/expression/units.h"
#include "pxn/text/reporter.h"
#include "pxn/text/xml.h"
#include "schemas/generated/pxn_schema.h"

namespace panwright::pxn {

// Reader of the values of one document. Unreadable values are reported and returned as empty or
// false.
//
// In files of level 1 a number may have a unit ("12mm"), and may be an expression in braces over
// the names of a scope ("{span/2 - 5mm}"); labels and paths may hold expressions in braces
// ("bolt{i}"), integers written without a point, lengths and angles in the root's units. Results
// are in metres and radians if the tables give a dimension. A bare number then has the root's unit,
// inside braces as outside: {5} is 5. A unit must be of the table's dimension, and so must an
// expression's value as far as known (Expressions). A value of an expression that leaves a range by
// 1e-15 of its limit, as {3*30deg} may, is clamped.
//
// Expects: elements have passed the grammar check, and their entry in the tables has the requested
// value. Attributes are named by their index in the tables (schemas::attribute).
//
// Reports, in all functions: E1201 to E1203, E1211, W1214; with level 1 E1212, E1213, E1221 to
// E1224.
class Values {
 public:
  Values(const xml::Document& document, const schemas::Language& language, Reporter& reporter)
      : doc_(document), language_(language), reporter_(reporter) {}

  // Sets units from now on. The scope outlives its use here; nullptr: no names.
  void set_units(const Units& units);
  void set_scope(const Scope* scope) { scope_ = scope; }
  const Scope* scope() const { return scope_; }

  bool has(std::uint32_t element, std::size_t attribute) const;

  // Reads the numbers between the tags, of the tables' count: out.size().
  bool numbers(std::uint32_t element, std::span<double> out);
  // The same for an attribute; one number stands for all if the tables allow it. False without a
  // report when the attribute is absent.
  bool numbers(std::uint32_t element, std::size_t attribute, std::span<double> out);

  // Returns true if an attribute is present and holds one of the tables' words in place of its
  // numbers.
  bool is_word(std::uint32_t element, std::size_t attribute);

  // Reads a list of numbers between the tags; replaces `out`. E1203 also for incomplete tuples, or
  // too few.
  bool list(std::uint32_t element, std::vector<double>& out);
  // Reads the one whole number between the tags.
  std::optional<std::uint64_t> integer(std::uint32_t element);
  // Reads a list of whole numbers, each below 2^32.
  bool integers(std::uint32_t element, std::vector<std::uint32_t>& out);
  // Returns the place of one of a list, for later diagnostics.
  SourceSpan place_of(std::uint32_t element, std::size_t number);

  // Reads a number; nothing, without a report, when the attribute is absent.
  std::optional<double> real(std::uint32_t element, std::size_t attribute);
  // Reads a number; the tables' default if absent or unreadable. Expects: there is one.
  double real_or_default(std::uint32_t element, std::size_t attribute) {
    const double initial = schema(element).attributes[attribute].initial[0];
    return real(element, attribute).value_or(initial);
  }
  std::optional<std::uint64_t> integer(std::uint32_t element, std::size_t attribute);
  std::uint64_t integer_or_default(std::uint32_t element, std::size_t attribute) {
    const double initial = schema(element).attributes[attribute].initial[0];
    return integer(element, attribute).value_or(static_cast<std::uint64_t>(initial));
  }
  // Reads a quantity; lengths in the root's unit, which it holds.
  std::optional<Quantity> quantity(std::uint32_t element, std::size_t attribute);

  // Reads a list of quantities, each of its own dimension, in SI: bare numbers have the root's unit
  // for it. As many as there are dimensions. False without a report when the attribute is absent.
  bool quantities(std::uint32_t element, std::size_t attribute,
                  std::span<const schemas::Dimension> dimensions, std::vector<double>& out);

  // Reads a word, path or label, as UTF-8 without control characters.
  //
  // Reports: E1103 (empty), E1204.
  std::optional<std::string> text(std::uint32_t element, std::size_t attribute);

  // Returns the tables' word or label for an absent attribute.
  std::string_view default_text(std::uint32_t element, std::size_t attribute) const {
    return schema(element).attributes[attribute].initial_word;
  }
  // Reads a text; the default if absent or unreadable.
  std::string text_or_default(std::uint32_t element, std::size_t attribute) {
    auto given = has(element, attribute) ? text(element, attribute) : std::nullopt;
    return given ? *std::move(given) : std::string(default_text(element, attribute));
  }

  // Returns the place of an attribute's value, or of the element's name when it is absent.
  SourceSpan value_place(std::uint32_t element, std::size_t attribute) const;

 private:
  // Text of one element or attribute, and the place of its bytes.
  struct Text {
    std::string_view text;
    std::uint32_t begin = 0;                              // of text[0] in the file
    const std::vector<std::uint32_t>* offsets = nullptr;  // of each byte, if decoding moved them
  };
  struct Token {
    std::string_view text;
    std::size_t at = 0;
  };

  const schemas::Element& schema(std::uint32_t element) const {
    return language_.elements[static_cast<std::size_t>(doc_.elements[element].id)];
  }
  Text text_of(std::uint32_t element);
  Text text_of(const xml::Attribute& attribute);
  // Meaning of a value's bare numbers: in a unit (nullptr: SI), or times a factor.
  struct Bare {
    const Unit* unit = nullptr;
    double factor = 1;
  };
  // Number as written.
  struct Amount {
    double value = 0;                                         // in SI
    schemas::Dimension dimension = schemas::Dimension::none;  // of its unit, or of an expression
    const Unit* unit = nullptr;                               // as written
    bool bare = false;                                        // the unit is the root's
    bool computed = false;                                    // by an expression
    Measured measured;                                        // by an expression of any dimension
  };

  bool next_token(const Text& text, std::size_t& at, Token& token) const;
  static Token trimmed(const Text& text);
  SourceSpan place(const Text& text, const Token& token) const;
  std::string written(const Text& text, const Token& token) const;

  Bare bare_of(const schemas::Value& value) const;
  bool read_plain(std::string_view text, const schemas::Value& value, std::span<double> out) const;
  bool read_plain_list(std::string_view text, const schemas::Value& value,
                       std::vector<double>& out) const;
  const char* read_plain_number(const char* at, const char* end, const Bare& bare,
                                const schemas::Number& limits, double& out) const;
  bool has_commas(std::uint32_t element, const Text& text, const schemas::Value& value);
  void check_radians(std::uint32_t element, const Text& text, const schemas::Value& value);
  bool read_all(std::uint32_t element, const Text& text, const schemas::Value& value,
                std::span<double> out, std::size_t& count);

  std::optional<Amount> read_amount(std::uint32_t element, const Text& text, const Token& token,
                                    const schemas::Value& value, std::size_t index);
  std::optional<Amount> read_computed(std::uint32_t element, const Text& text, const Token& token,
                                      const schemas::Value& value);
  std::optional<Measured> evaluate(std::uint32_t element, const Text& text, const Token& token,
                                   const std::optional<Need>& need);
  bool read_real(std::uint32_t element, const Text& text, const Token& token,
                 const schemas::Value& value, std::size_t index, double& out);
  bool read_integer(std::uint32_t element, const Text& text, const Token& token,
                    const schemas::Value& value, std::size_t index, std::uint64_t& out);
  bool read_computed_integer(std::uint32_t element, const Text& text, const Token& token,
                             const schemas::Value& value, std::size_t index, std::uint64_t& out);
  bool replace_expressions(std::uint32_t element, const Text& text, std::string& out);

  void bad_number(Code code, std::uint32_t element, const Text& text, const Token& token,
                  const schemas::Value& value, std::size_t index, const Amount& amount);
  std::string number_hint(const Token& token) const;
  void bad_kind(std::uint32_t element, const Text& text, const Token& token,
                schemas::Dimension needed, std::string_view got);
  std::string kinds_of_operands(const Token& token) const;
  void bad_unit(std::uint32_t element, const Text& text, const Token& token, std::size_t number);
  void bad_count(std::uint32_t element, const schemas::Value& value, std::string_view subject,
                 std::size_t count);
  void bad_tuples(std::uint32_t element, const schemas::Value& value, std::size_t count);
  std::string subject(std::uint32_t element, const schemas::Value& value, std::size_t index) const;
  std::string subject(std::uint32_t element, const schemas::Value& value) const;

  const xml::Document& doc_;
  const schemas::Language& language_;
  Reporter& reporter_;
  Units units_;
  const Unit* length_unit_ = nullptr;  // the root's
  const Unit* angle_unit_ = nullptr;
  const Scope* scope_ = nullptr;
  Expressions expressions_;
  std::string buffer_;
  std::vector<std::uint32_t> offsets_;
};

}  // namespace panwright::pxn
