#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

const char* word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

nlohmann::ordered_json as_json(const CodeInfo& info) {
  return {{"code", info.name},
          {"severity", word(info.severity)},
          {"title", info.title},
          {"explanation", info.explanation}};
}

}  // namespace

int explain(const ExplainOptions& options) {
  Session session("explain", options.common);
  if (options.code.empty()) {
    for (const CodeInfo& info : all_codes()) {
      if (options.common.json)
        session.result()["codes"].push_back(as_json(info));
      else
        fmt::print("{}  {}\n", info.name, info.title);
    }
    return session.finish();
  }
  const auto code = code_from_name(options.code);
  if (!code) {
    std::vector<std::string_view> names;
    for (const CodeInfo& info : all_codes()) names.push_back(info.name);
    const auto near = nearest_name(options.code, names);
    session.log().report(Code::E0204, {},
                         fmt::format("{} is no diagnostic code", in_quotes(options.code)),
                         near ? fmt::format("did you mean '{}'?", *near) : std::string());
    return session.finish();
  }
  const CodeInfo& info = code_info(*code);
  if (options.common.json)
    session.result().update(as_json(info));
  else
    fmt::print("{} ({}): {}\n\n{}\n", info.name, word(info.severity), info.title, info.explanation);
  return session.finish();
}

}  // namespace panwright::tools
