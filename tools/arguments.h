// Options and arguments of a command, declared beside its code. What parses them is known to one
// file only, as it is slow to compile.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace panwright::tools {

// One option or argument. Checks run in the order in which they are added.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  Argument& type(const char* name);  // "METRES", in the help
  Argument& group(const char* name);
  Argument& required();
  Argument& one_value();  // of a list: each occurrence brings one
  Argument& excludes(const Argument& other);

  Argument& one_of(std::initializer_list<const char*> values);
  Argument& range(int least, int most);
  Argument& range(unsigned least, unsigned most);
  Argument& range(double least, double most);
  Argument& finite();  // what is no finite number is refused: ranges let "nan" pass
  Argument& positive();
  Argument& not_negative();
  // note: CLI11 reads "-1" as the largest unsigned number
  Argument& no_minus();
  Argument& bytes();  // "512MB"
  Argument& folder();

 private:
  CLI::Option* option_;
};

// The options of one command. Values that are bound outlive the parsing, and stay as they are where
// the user says nothing. Names: "-o,--output" for an option, "input" for an argument.
class Arguments {
 public:
  explicit Arguments(CLI::App& app) : app_(app) {}

  Argument add(const char* names, std::string& value, const char* help);
  Argument add(const char* names, std::optional<std::string>& value, const char* help);
  Argument add(const char* names, std::vector<std::string>& values, const char* help);
  Argument add(const char* names, std::uint32_t& value, const char* help);
  Argument add(const char* names, std::uint64_t& value, const char* help);
  Argument add(const char* names, double& value, const char* help);
  Argument add(const char* names, std::optional<double>& value, const char* help);
  Argument flag(const char* names, bool& value, const char* help);
  // Calls a function with the text.
  Argument add(const char* names, std::function<void(const std::string&)> take, const char* help);

  // Expects: it is there.
  Argument find(const char* name);

 private:
  CLI::App& app_;
};

}  // namespace panwright::tools
