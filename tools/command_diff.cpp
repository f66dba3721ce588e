#include "pan/diff.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/commands.h"
#include "tools/load.h"
#include "tools/session.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;

Json as_json(const std::vector<pan::Difference>& list) {
  Json out = Json::array();
  for (const pan::Difference& each : list)
    out.push_back({{"where", each.where}, {"what", each.what}});
  return out;
}

void print(const std::vector<pan::Difference>& list, const char* prefix) {
  for (const pan::Difference& each : list) fmt::print("{}{}: {}\n", prefix, each.where, each.what);
}

// What equal models differ in all the same.
std::string unseen_words(const pan::Differences& differences) {
  if (differences.empty()) return {};
  const char* what = differences.provenance.empty() ? "storage"
                     : differences.storage.empty()  ? "provenance"
                                                    : "provenance and storage";
  return fmt::format(" (their {} differs: --all shows it)", what);
}

}  // namespace

int diff(const DiffOptions& options) {
  Session session("diff", options.common);
  const auto a = load_model(options.a, options.read, session);
  const auto b = load_model(options.b, options.read, session);
  if (!a || !b) return session.finish();
  session.step("compare");
  const pan::Differences differences = pan::diff(*a, *b);
  const bool equal = options.all ? differences.empty() : differences.same_model();
  session.result()["equal"] = equal;
  session.result()["model"] = as_json(differences.model);
  session.result()["provenance"] = as_json(differences.provenance);
  session.result()["storage"] = as_json(differences.storage);
  if (!options.common.json) {
    print(differences.model, "");
    if (options.all || !differences.same_model()) {
      print(differences.provenance, "provenance: ");
      print(differences.storage, "storage: ");
    }
    if (differences.hidden > 0)
      fmt::print("{} not shown\n", counted(differences.hidden, "more difference"));
    if (equal) fmt::print("the models are equal{}\n", unseen_words(differences));
  }
  return session.finish(equal ? 0 : 1);
}

}  // namespace panwright::tools
