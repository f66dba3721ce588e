#include "tools/arguments.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "workspace/views.h"

namespace panwright::tools {

namespace {

const CLI::Validator kFinite(
    [](std::string& text) {
      const auto number = workspace::parse_numbers(text, 1);
      return number && std::isfinite((*number)[0]) ? std::string()
                                                   : text + " is not a finite number";
    },
    "");

const CLI::Validator kNoMinus(
    [](std::string& text) { return text.starts_with('-') ? text + " is negative" : std::string(); },
    "");

}  // namespace

Argument& Argument::type(const char* name) {
  option_->type_name(name);
  return *this;
}
Argument& Argument::group(const char* name) {
  option_->group(name);
  return *this;
}
Argument& Argument::required() {
  option_->required();
  return *this;
}
Argument& Argument::one_value() {
  option_->allow_extra_args(false);
  return *this;
}
Argument& Argument::excludes(const Argument& other) {
  option_->excludes(other.option_);
  return *this;
}
Argument& Argument::one_of(std::initializer_list<const char*> values) {
  option_->check(CLI::IsMember(std::vector<std::string>(values.begin(), values.end())));
  return *this;
}
Argument& Argument::range(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}
Argument& Argument::range(unsigned least, unsigned most) {
  option_->check(CLI::Range(least, most));
  return *this;
}
Argument& Argument::range(double least, double most) {
  option_->check(CLI::Range(least, most));
  return *this;
}
Argument& Argument::finite() {
  option_->check(kFinite);
  return *this;
}
Argument& Argument::positive() {
  option_->check(CLI::PositiveNumber);
  return *this;
}
Argument& Argument::not_negative() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}
Argument& Argument::no_minus() {
  option_->check(kNoMinus);
  return *this;
}
Argument& Argument::bytes() {
  option_->transform(CLI::AsSizeValue(false));
  return *this;
}
Argument& Argument::folder() {
  option_->check(CLI::ExistingDirectory);
  return *this;
}

Argument Arguments::add(const char* names, std::string& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::add(const char* names, std::optional<std::string>& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::add(const char* names, std::vector<std::string>& values, const char* help) {
  return Argument(app_.add_option(names, values, help));
}
Argument Arguments::add(const char* names, std::uint32_t& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::add(const char* names, std::uint64_t& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::add(const char* names, double& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::add(const char* names, std::optional<double>& value, const char* help) {
  return Argument(app_.add_option(names, value, help));
}
Argument Arguments::flag(const char* names, bool& value, const char* help) {
  return Argument(app_.add_flag(names, value, help));
}
Argument Arguments::add(const char* names, std::function<void(const std::string&)> take,
                        const char* help) {
  return Argument(app_.add_option_function<std::string>(names, std::move(take), help));
}

Argument Arguments::find(const char* name) { return Argument(app_.get_option(name)); }

}  // namespace panwright::tools
