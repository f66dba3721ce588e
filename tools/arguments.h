// Options and arguments of a command, declared beside its code. The declarations are the table of
// the parser, the help, the manual pages and the completion of shells.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::tools {

// Declared option, flag or argument.
struct Option {
  // Check of a text, which may replace it by an equivalent one. Returns the accepted values; empty:
  // the text is accepted.
  using Check = std::function<std::string(std::string& text)>;

  std::vector<std::string> names;  // "-o", "--output"; of an argument: "input"
  std::string help;
  std::string type;   // "FILE"; empty: a flag
  std::string group;  // heading of the help; empty: "Options"
  bool argument = false;
  bool required = false;
  bool repeatable = false;
  bool may_be_empty = false;
  bool numbers = false;              // the value has several
  std::optional<std::string> bare;   // value of an option without one; see bare_value()
  std::vector<std::string> choices;  // all values; empty: others
  std::vector<const Option*> excluded;
  std::vector<Check> checks;                     // in order of execution
  std::function<bool(const std::string&)> take;  // false: not a value of its type
  std::string value_words;                       // values of take(): "a number"
  unsigned given = 0;                            // times, on the command line

  // Returns "--output", or the only name.
  const std::string& name() const { return names.back(); }
  bool is_flag() const { return type.empty(); }
};

// Builder of the declaration of one option.
class Argument {
 public:
  explicit Argument(Option& option) : option_(option) {}

  Argument& type(const char* name);  // "METRES", in the help
  Argument& group(const char* name);
  Argument& required();
  Argument& may_be_empty();  // "" is a value
  Argument& one_value();     // of a list: one per occurrence
  Argument& numbers();       // the value has several, in quotes
  Argument& excludes(const Argument& other);

  // Sets the value of the option alone. A following word is its value unless it looks like a file:
  // has a dot or a slash.
  Argument& bare_value(const char* value);
  // Sets values to complete and suggest; accepts, as of Option::Check, decides, or who takes them.
  Argument& some_of(std::initializer_list<const char*> values, Option::Check accepts);
  Argument& some_of(std::span<const std::string_view> values);

  Argument& one_of(std::initializer_list<const char*> values);
  Argument& range(double least, double most);
  Argument& finite();  // refuses numbers that are not finite
  Argument& positive();
  Argument& not_negative();
  Argument& bytes();  // "512MB"
  // Accepts "2mm", "30deg" as metres, degrees. For options of a number, before its bounds.
  Argument& length();
  Argument& angle();
  Argument& folder();  // existing, or creatable in an existing one

 private:
  Option& option_;
};

// Problem of a command line, in one sentence.
struct UsageError {
  std::string message;
};

// Options of one command. Bound values outlive the parsing, and keep their defaults unless given.
// Names: "-o,--output" for an option, "input" for an argument.
class Arguments {
 public:
  Arguments() = default;
  Arguments(const Arguments&) = delete;
  Arguments& operator=(const Arguments&) = delete;

  Argument add(const char* names, std::string& value, const char* help);
  Argument add(const char* names, std::optional<std::string>& value, const char* help);
  Argument add(const char* names, std::vector<std::string>& values, const char* help);
  Argument add(const char* names, std::uint32_t& value, const char* help);
  Argument add(const char* names, std::uint64_t& value, const char* help);
  Argument add(const char* names, double& value, const char* help);
  Argument add(const char* names, std::optional<double>& value, const char* help);
  Argument flag(const char* names, bool& value, const char* help);

  // Sets values from the words of a command line after the command.
  //
  //   command  "panwright render", for messages
  //   returns  the first problem; none: success
  std::optional<UsageError> parse(std::string_view command, const std::vector<std::string>& words);

  const std::deque<Option>& options() const { return options_; }

 private:
  Option& declare(const char* names, const char* help, const char* value_words);
  std::deque<Option> options_;  // in the order of declaration, at fixed addresses
};

}  // namespace panwright::tools
