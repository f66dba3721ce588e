#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pan/diff.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

int diff(const DiffOptions& options) {
  Session session("diff", options.common);
  const auto a = load_model(options.a, options.read, session);
  const auto b = load_model(options.b, options.read, session);
  if (!a || !b) return session.finish();
  session.step("compare");
  const pan::Difference difference = pan::diff(*a, *b);
  const bool equal = difference.model.empty() && (!options.all || difference.provenance.empty());
  session.result()["equal"] = equal;
  session.result()["model"] = difference.model;
  session.result()["provenance"] = difference.provenance;
  if (!options.common.json) {
    for (const std::string& line : difference.model) fmt::print("{}\n", line);
    for (const std::string& line : difference.provenance)
      if (options.all || !difference.model.empty()) fmt::print("provenance: {}\n", line);
    if (equal)
      fmt::print("the models are equal{}\n", difference.provenance.empty()
                                                 ? ""
                                                 : " (their provenance differs: --all shows it)");
  }
  const int code = session.finish();
  return code != 0 ? code : equal ? 0 : 1;
}

}  // namespace panwright::tools
