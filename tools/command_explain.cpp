#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"

namespace panwright::tools {

namespace {

struct Options {
  CommonOptions common;
  std::string code;  // empty: lists all
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("code", options.code, "A code such as E1101").type("CODE");
  declare(arguments, options.common);
}

const char* word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

nlohmann::ordered_json as_json(const CodeInfo& info) {
  return {{"code", info.name},
          {"severity", word(info.severity)},
          {"title", info.title},
          {"explanation", info.explanation}};
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
    context.log().report(Code::E0204, {},
                         fmt::format("{} is not a diagnostic code", in_quotes(options.code)),
                         near ? fmt::format("did you mean '{}'?", *near) : std::string());
    return context.finish();
  }
  const CodeInfo& info = code_info(*code);
  if (options.common.json)
    context.result().update(as_json(info));
  else
    print("{} ({}): {}\n\n{}\n", info.name, word(info.severity), info.title, info.explanation);
  return context.finish();
}

}  // namespace

Command explain_command() {
  return command("explain", "Explain a diagnostic code, or list them all", declare_all, run);
}

}  // namespace panwright::tools
