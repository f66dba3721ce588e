#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/text.h"
#include "pxn/format.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

class Formatting {
 public:
  Formatting(const FmtOptions& options, Session& session) : options_(options), session_(session) {}

  void one(const std::string& input) {
    DiagnosticLog& log = session_.log();
    const bool standard = input == "-";
    const std::string name = standard ? "<standard input>" : input;
    session_.step("format " + name);
    auto bytes = read_file(standard ? "/dev/stdin" : input, options_.max_input, log);
    if (!bytes) return;
    const auto original = std::make_shared<const std::string>(std::move(*bytes));
    pxn::Limits limits;
    limits.bytes = options_.max_input;
    const auto text = pxn::formatted(name, original, limits, log);
    if (!text) return;
    const bool changed = *text != *original;
    session_.result()["files"].push_back({{"file", name}, {"changed", changed}});
    any_changed_ = any_changed_ || changed;
    if (options_.check) {
      if (changed && !options_.common.json) fmt::print("{}\n", name);
      return;
    }
    const std::string output = options_.output.empty() ? input : options_.output;
    // a file that is as it should be keeps its time
    if (!changed && output == input && !standard) return;
    write_file(output, as_bytes(*text), log);
  }

  bool any_changed() const { return any_changed_; }

 private:
  const FmtOptions& options_;
  Session& session_;
  bool any_changed_ = false;
};

}  // namespace

int format(const FmtOptions& options) {
  Session session("fmt", options.common);
  if (!options.output.empty() && (options.inputs.size() > 1 || options.check)) {
    session.log().report(Code::E0201, {},
                         options.check ? "--check writes nothing, so there is no -o with it"
                                       : "-o takes one file; several are formatted in place");
    return session.finish();
  }
  Formatting formatting(options, session);
  for (const std::string& input : options.inputs) formatting.one(input);
  return session.finish(options.check && formatting.any_changed() ? 1 : 0);
}

}  // namespace panwright::tools
