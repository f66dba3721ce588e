#include "pan/diff.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "pan/place_diff.h"
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
  bool all = false;       // provenance too
  bool geometry = false;  // surfaces by place alone
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("a", options.a, "Model: a .pan or .pxn file").required().type("A");
  arguments.add("b", options.b, "Model: a .pan or .pxn file").required().type("B");
  arguments.flag("--all", options.all, "Count differences of provenance and storage too");
  arguments.flag("--geometry", options.geometry,
                 "Compare the triangles by their place alone, whatever tree, names and materials");
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

bool same_places(const pan::Model& a, const pan::Model& b, const Options& options,
                 CommandContext& context) {
  const pan::PlaceDifferences found = pan::diff_by_place(a, b);
  constexpr std::size_t kMost = 200;
  Json parts = Json::array();
  for (const pan::UnmatchedPart& part : found.parts) {
    if (parts.size() == kMost) break;
    parts.push_back({{"where", part.where},
                     {"in", part.in_a ? "a" : "b"},
                     {"unmatched", part.unmatched},
                     {"triangles", part.triangles}});
  }
  if (!options.common.json) {
    for (const Json& part : parts)
      tools::print("{}: {} of {} only in {}\n", part["where"].get<std::string>(),
                   part["unmatched"].get<std::uint64_t>(),
                   counted(part["triangles"].get<std::uint64_t>(), "triangle"),
                   part["in"].get<std::string>());
    if (found.parts.size() > kMost)
      tools::print("{} not shown\n", counted(found.parts.size() - kMost, "more part"));
    if (found.same())
      tools::print("the surfaces are equal: {} within {:.3g} m (tolerance {:.3g} m)\n",
                   counted(found.triangles_a, "triangle"), found.largest, found.tolerance);
  }
  context.result()["equal"] = found.same();
  context.result()["geometry"] = {{"triangles_a", found.triangles_a},
                                  {"triangles_b", found.triangles_b},
                                  {"tolerance", found.tolerance},
                                  {"largest_distance", found.largest},
                                  {"parts", std::move(parts)}};
  return found.same();
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
  if (options.geometry) return context.finish(same_places(**a, **b, options, context) ? 0 : 1);
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
