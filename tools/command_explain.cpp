#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/explain_examples.h"
#include "tools/print.h"
#include "tools/words.h"

namespace panwright::tools {

namespace command_explain {
namespace {

struct Options {
  CommonOptions common;
  std::string code;  // empty: lists all
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("code", options.code, "Code to explain, as E1101 (default: lists all)")
      .type("CODE");
  declare(arguments, options.common);
}

const char* word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

nlohmann::ordered_json as_json(const CodeInfo& info) {
  nlohmann::ordered_json out{{"code", info.name},
                             {"severity", word(info.severity)},
                             {"title", info.title},
                             {"explanation", info.explanation}};
  if (const CodeExample* example = example_of(*code_from_name(info.name))) {
    out["example"] = example->example;
    out["cure"] = example->cure;
  }
  return out;
}

// Lines of a text, set in.
std::string set_in(std::string_view text) {
  std::string out = "    ";
  for (const char c : text) {
    out.push_back(c);
    if (c == '\n') out += "    ";
  }
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("explain", options.common, host);
  if (options.code.empty()) {
    for (const CodeInfo& info : all_codes()) {
      if (options.common.json)
        context.result()["codes"].push_back(as_json(info));
      else
        print("{}  {}\n", info.name, info.title);
    }
    return context.finish();
  }
  const auto code = code_from_name(options.code);
  if (!code) {
    std::vector<std::string_view> names;
    for (const CodeInfo& info : all_codes()) names.push_back(info.name);
    const auto near = nearest_name(options.code, names);
    context.log().report(Code("E0204"), {},
                         fmt::format("{} is not a diagnostic code", in_quotes(options.code)),
                         near ? fmt::format("did you mean '{}'?", *near) : std::string());
    return context.finish();
  }
  const CodeInfo& info = code_info(*code);
  if (options.common.json) {
    context.result().update(as_json(info));
    return context.finish();
  }
  print("{} ({}): {}\n\n{}\n", info.name, word(info.severity), info.title,
        wrapped(info.explanation, 100, 0));
  if (const CodeExample* example = example_of(*code))
    print("\nExample:\n{}\nCure:\n{}\n", set_in(example->example), set_in(example->cure));
  return context.finish();
}

}  // namespace
}  // namespace command_explain

Command explain_command() {
  return command("explain",
                 "Explain a diagnostic code with an example and its cure, or list them all",
                 command_explain::declare_all, command_explain::run);
}

}  // namespace panwright::tools
