// Options and arguments of a command, declared beside its code. The declarations are the table that
// the parser, the help, the manual pages and the completion of shells read.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::tools {

// One option, flag or argument as it is declared.
struct Option {
  // Replaces nothing, or the text by another one of the same meaning. Returns what would be
  // accepted; empty: the text is.
  using Check = std::function<std::string(std::string& text)>;

  std::vector<std::string> names;  // "-o", "--output"; of an argument: "input"
  std::string help;
  std::string type;   // "FILE"; empty: a flag
  std::string group;  // the heading of the help; empty: "Options"
  bool argument = false;
  bool required = false;
  bool repeatable = false;
  bool may_be_empty = false;
  std::optional<std::string> bare;   // what it takes when no value follows; see bare_value()
  std::string alias_of;              // another spelling of this option: left out of lists
  std::vector<std::string> choices;  // all values there are; empty: others
  std::vector<const Option*> excluded;
  std::vector<Check> checks;                     // in the order in which they run
  std::function<bool(const std::string&)> take;  // false: not a value of its type
  std::string value_words;                       // what take() accepts: "a number"
  unsigned given = 0;                            // times, on the command line

  // "--output", or the only name there is.
  const std::string& name() const { return names.back(); }
  bool is_flag() const { return type.empty(); }
};

// Completes the declaration of one option.
class Argument {
 public:
  explicit Argument(Option& option) : option_(option) {}

  Argument& type(const char* name);  // "METRES", in the help
  Argument& group(const char* name);
  Argument& required();
  Argument& may_be_empty();  // "" is a value
  Argument& one_value();     // of a list: each occurrence brings one
  Argument& excludes(const Argument& other);
  Argument& alias_of(const Argument& other);  // which the help lists in its place

  // The option may stand alone and then has this value. A word after it is its value unless it
  // looks like a file: has a dot or a slash.
  Argument& bare_value(const char* value);
  // Values that are shown, completed and suggested; accepts, as of Option::Check, says which are
  // taken.
  Argument& some_of(std::initializer_list<const char*> values, Option::Check accepts);

  Argument& one_of(std::initializer_list<const char*> values);
  Argument& range(double least, double most);
  Argument& finite();  // what is no finite number is refused
  Argument& positive();
  Argument& not_negative();
  Argument& bytes();  // "512MB"
  // "2mm", "30deg": metres, degrees. Of options that take a number, before its bounds.
  Argument& length();
  Argument& angle();
  Argument& folder();  // that exists, or can be made in one that does

 private:
  Option& option_;
};

// What is wrong with a command line, in one sentence.
struct UsageError {
  std::string message;
};

// The options of one command. Values that are bound outlive the parsing, and stay as they are where
// the user says nothing. Names: "-o,--output" for an option, "input" for an argument.
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

  // Expects: it is there.
  Argument find(const char* name);

  // Sets the values that words of a command line give, the words after the command.
  //
  //   command  "panwright render", for messages
  //   returns  the first thing that is wrong; none: all is well
  std::optional<UsageError> parse(std::string_view command, const std::vector<std::string>& words);

  const std::deque<Option>& options() const { return options_; }

 private:
  Option& declare(const char* names, const char* help, const char* value_words);
  std::deque<Option> options_;  // in the order of declaration, at places that stay
};

}  // namespace panwright::tools
