#include "pan/diff.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_diff {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string a;
  std::string b;
  bool all = false;  // provenance too
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("a", options.a, "Model: a .pan or .pxn file").required().type("A");
  arguments.add("b", options.b, "Model: a .pan or .pxn file").required().type("B");
  arguments.flag("--all", options.all, "Count differences of provenance and storage too");
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.common);
}

Json as_json(const std::vector<pan::Difference>& list) {
  Json out = Json::array();
  for (const pan::Difference& each : list)
    out.push_back({{"where", each.where}, {"what", each.what}});
  return out;
}

void print(const std::vector<pan::Difference>& list, const char* prefix) {
  for (const pan::Difference& each : list)
    tools::print("{}{}: {}\n", prefix, each.where, each.what);
}

// What equal models differ in all the same.
std::string unseen_words(const pan::Differences& differences) {
  if (differences.empty()) return {};
  const char* what = differences.provenance.empty() ? "storage"
                     : differences.storage.empty()  ? "provenance"
                                                    : "provenance and storage";
  return fmt::format(" (their {} differs: --all shows it)", what);
}

int run(const Options& options, const Host& host) {
  CommandContext context("diff", options.common, host);
  const auto read = options.read.opening(context.log());
  if (!read) return context.finish();
  const auto is_text = [](const std::string& file) {
    return workspace::extension_of(file) == ".pxn";
  };
  if (is_text(options.a) && is_text(options.b)) context.summarise_imports();
  workspace::OpenReport report;
  // parameters are of texts, whatever these are compared with
  workspace::OpenOptions bare = *read;
  if (is_text(options.a) || is_text(options.b)) bare.parameters.clear();
  const auto opened = [&](const std::string& file) {
    return workspace::open(file, is_text(file) ? *read : bare, context.log(), context.job(),
                           &report);
  };
  const auto a = opened(options.a);
  const auto b = opened(options.b);
  context.add_timings(report.steps);
  if (!a || !b) return context.finish();
  context.step("compare");
  const pan::Differences differences = pan::diff(**a, **b);
  const bool equal = options.all ? differences.empty() : differences.same_model();
  context.result()["equal"] = equal;
  context.result()["model"] = as_json(differences.model);
  context.result()["provenance"] = as_json(differences.provenance);
  context.result()["storage"] = as_json(differences.storage);
  if (!options.common.json) {
    print(differences.model, "");
    if (options.all || !differences.same_model()) {
      print(differences.provenance, "provenance: ");
      print(differences.storage, "storage: ");
    }
    if (differences.hidden > 0)
      tools::print("{} not shown\n", counted(differences.hidden, "more difference"));
    if (equal) tools::print("the models are equal{}\n", unseen_words(differences));
  }
  return context.finish(equal ? 0 : 1);
}

}  // namespace
}  // namespace command_diff

Command diff_command() {
  return command("diff", "Compare two models; exit code 1 when they differ",
                 command_diff::declare_all, command_diff::run);
}

}  // namespace panwright::tools
