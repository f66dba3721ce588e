// Report of `render` on its images, and its stream of views.
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>

#include "tools/command_context.h"
#include "workspace/session.h"

namespace panwright::tools {

// Reporter: one line per image, and the entries of --json.
class RenderReport {
 public:
  // many: of --views, which ends with a summary; explain: describes the drawing of each target
  RenderReport(CommandContext& context, bool many, bool explain)
      : context_(context), many_(many), explain_(explain) {}
  workspace::RunListener listener();
  void summary() const;

 private:
  void image(const workspace::Written& image);
  CommandContext& context_;
  bool many_;
  bool explain_;
  std::size_t images_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Adds measurements and choices as members of an object.
void describe_image(const workspace::Written& image, nlohmann::ordered_json& entry);

// Reads views from standard input, one a line, and answers each with one line on standard output,
// until the input ends. An invalid line has errors in its answer.
//
//   defaults  values of omitted members
//   returns   the exit code: 0, or that of the worst answer
int serve_views(workspace::ViewSession& session, const workspace::Settings& defaults,
                const workspace::RunListener& listener, CommandContext& context);

}  // namespace panwright::tools
