// Reads the words of a command line. Each thing that can be wrong has a sentence of its own.

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "base/diagnostic.h"
#include "base/text.h"
#include "tools/arguments.h"
#include "tools/words.h"
#include "workspace/absent_options.h"
#include "workspace/quantities.h"

namespace panwright::tools {

namespace {

std::string failure_of_value(const Option& option, const std::string& text,
                             const std::string& expected) {
  std::string message =
      fmt::format("{} is {}, expected {}", option.argument ? option.type : option.name(),
                  in_quotes(text), expected);
  std::vector<std::string_view> choices(option.choices.begin(), option.choices.end());
  if (const auto near = nearest_name(text, choices))
    message += fmt::format("; did you mean '{}'?", *near);
  return message;
}

class Parser {
 public:
  Parser(std::string_view command, const std::vector<std::string>& words,
         std::deque<Option>& options)
      : command_(command), words_(words), options_(options) {}

  std::optional<UsageError> parse() {
    bool only_arguments = false;  // after "--"
    while (next_ < words_.size() && error_.empty()) {
      const std::string& word = words_[next_++];
      if (!only_arguments && word == "--")
        only_arguments = true;
      else if (only_arguments || word.size() < 2 || word[0] != '-')
        take_argument(word);
      else if (word[1] == '-')
        take_long(word);
      else
        take_short(word);
    }
    if (error_.empty()) check_whole();
    if (error_.empty()) return std::nullopt;
    return UsageError{error_};
  }

 private:
  Option* named(std::string_view name) {
    for (Option& option : options_)
      if (!option.argument &&
          std::find(option.names.begin(), option.names.end(), name) != option.names.end())
        return &option;
    return nullptr;
  }

  void fail(std::string message) {
    if (error_.empty()) error_ = std::move(message);
  }

  void unknown(const std::string& name) {
    std::vector<std::string_view> names{"--help"};
    for (const Option& option : options_)
      if (!option.argument) names.insert(names.end(), option.names.begin(), option.names.end());
    // "-output" is meant as "--output"
    const bool single = name.size() > 2 && name[1] != '-';
    const auto near = nearest_name(single ? "-" + name : name, names);
    if (std::isdigit(static_cast<unsigned char>(name[1])) || name[1] == '.')
      return fail(fmt::format(
          "{} belongs to no option; quote several numbers of one option, as in --sun \"1 -1 0.5\"",
          in_quotes(name)));
    const std::size_t letters = std::min(name.find_first_not_of('-'), name.size());
    const auto instead = workspace::instead_of(std::string_view(name).substr(letters));
    if (!instead.empty() && named("--camera") != nullptr)
      return fail(
          fmt::format("{} is not an option of '{}'; {}", in_quotes(name), command_, instead));
    fail(fmt::format("{} is not an option of '{}'; {}", in_quotes(name), command_,
                     near ? fmt::format("did you mean '{}'?", *near)
                          : fmt::format("`{} --help` lists them", command_)));
  }

  void set(Option& option, std::string text) {
    if (++option.given > 1 && !option.repeatable && !option.is_flag())
      return fail(fmt::format("{} is given twice; it takes one value",
                              option.argument ? option.type : option.name()));
    if (text.empty() && !option.is_flag() && !option.may_be_empty) {
      const std::string expected =
          option.choices.empty() ? option.type : listed(option.choices, "or");
      return fail(fmt::format("{} has an empty value, expected {}",
                              option.argument ? "an argument" : option.name(), expected));
    }
    const std::string typed = text;
    for (const Option::Check& check : option.checks) {
      const std::string expected = check(text);
      if (!expected.empty()) return fail(failure_of_value(option, typed, expected));
    }
    if (!option.take(text)) fail(failure_of_value(option, typed, option.value_words));
  }

  // Numbers after the first one, which the shell has taken apart: "--camera 0 0 3".
  void check_quotes(const Option& option, const std::string& value) {
    const auto is_number = [](std::string_view word) {
      while (word.ends_with(',')) word.remove_suffix(1);
      return workspace::parse_length(word) || workspace::parse_angle(word);
    };
    const std::size_t begin = option.repeatable ? value.find('=') + 1 : 0;  // npos + 1 is 0
    std::string all = value.substr(begin);
    if (!option.numbers || !is_number(all)) return;
    std::size_t end = next_;
    for (; end < words_.size() && is_number(words_[end]); ++end) all += " " + words_[end];
    if (end == next_) return;
    error_ = fmt::format("put quotes around the {} numbers of {}: {} {}\"{}\"", end - next_ + 1,
                         option.name(), option.name(), value.substr(0, begin), all);
  }

  // What follows an option is its value, unless it is another option: "-1,0,0" is a value.
  void set_from_next(Option& option) {
    const std::string* next = next_ < words_.size() ? &words_[next_] : nullptr;
    const bool value = next != nullptr &&
                       (next->size() < 2 || (*next)[0] != '-' ||
                        std::isdigit(static_cast<unsigned char>((*next)[1])) || (*next)[1] == '.');
    if (option.bare) {
      const bool file = value && next->find_first_of("./") != std::string::npos;
      return value && !file ? set(option, words_[next_++]) : set(option, *option.bare);
    }
    if (value) {
      set(option, words_[next_++]);
      return check_quotes(option, words_[next_ - 1]);
    }
    fail(fmt::format(
        "{} needs a value: {} {}{}", option.name(), option.name(), option.type,
        next == nullptr ? std::string() : fmt::format("; {} follows it", in_quotes(*next))));
  }

  void take_long(const std::string& word) {
    const std::size_t sign = std::min(word.find('='), word.size());
    const std::string name = word.substr(0, sign);
    Option* option = named(name);
    if (option == nullptr) return unknown(name);
    if (option->is_flag()) {
      if (sign < word.size()) return fail(fmt::format("{} takes no value", name));
      return set(*option, {});
    }
    if (sign == word.size()) return set_from_next(*option);
    set(*option, word.substr(sign + 1));
    check_quotes(*option, word.substr(sign + 1));
  }

  // "-q", "-qj 2", "-j2", "-o=FILE".
  void take_short(const std::string& word) {
    for (std::size_t i = 1; i < word.size() && error_.empty(); ++i) {
      Option* option = named(std::string{'-', word[i]});
      // note: a flag before it is no reason to read "-question" as one
      if (option == nullptr) return unknown(word);
      if (option->is_flag()) {
        set(*option, {});
        continue;
      }
      std::string rest = word.substr(i + 1);
      if (rest.empty()) return set_from_next(*option);
      if (rest[0] == '=') rest.erase(0, 1);
      // "-output" is a misspelling rather than the value "utput"
      if (rest.size() > 2 && named("-" + word) != nullptr) return unknown(word);
      return set(*option, std::move(rest));
    }
  }

  void take_argument(const std::string& word) {
    for (Option& option : options_)
      if (option.argument && (option.repeatable || option.given == 0)) return set(option, word);
    const bool is_model = word.find('=') != std::string::npos && named("--target") != nullptr;
    fail(fmt::format("{} is one argument too many: {}{}{}", in_quotes(word), command_, arguments(),
                     is_model ? "; models of targets are --target " + word : ""));
  }

  // " FILE FILE"
  std::string arguments() const {
    std::string all;
    for (const Option& option : options_)
      if (option.argument) all += " " + option.type;
    return all;
  }

  void check_whole() {
    for (const Option& option : options_) {
      if (option.required && option.given == 0)
        return fail(option.argument
                        ? fmt::format("{} is missing: {}{}", option.type, command_, arguments())
                        : fmt::format("{} {} is missing: `{} --help` lists the options",
                                      option.names.front(), option.type, command_));
      if (option.given == 0) continue;
      for (const Option* other : option.excluded)
        if (other->given > 0)
          return fail(fmt::format("{} cannot be combined with {}", option.name(), other->name()));
    }
  }

  std::string_view command_;
  const std::vector<std::string>& words_;
  std::deque<Option>& options_;
  std::size_t next_ = 0;
  std::string error_;
};

}  // namespace

std::optional<UsageError> Arguments::parse(std::string_view command,
                                           const std::vector<std::string>& words) {
  return Parser(command, words, options_).parse();
}

}  // namespace panwright::tools
