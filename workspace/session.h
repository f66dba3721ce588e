// Views as text → images, one call after the other: what `render --views` does.
#pragma once

#include <list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "workspace/run.h"

namespace panwright::workspace {

// Keeps models, contexts and what was uploaded from call to call: the models of the last four
// sets of targets and parameters.
class ViewSession {
 public:
  // open: its parameters are those of the views.
  ViewSession(OpenOptions open, preview::ContextKind context)
      : open_(std::move(open)), context_(context) {}

  // Renders views, in order. All views are checked as far as their models are not needed, then
  // those of one model after the other.
  //
  //   listener  Written::view is the index in `views`
  //   returns   the number of images: all of them
  // Expects: targets and an output in each view.
  // Fails: E0201, E0203; as open_world(), ViewMaker and run_views().
  Result<std::size_t> run(std::span<const ViewText> views, const RunListener& listener,
                          DiagnosticLog& log, const Job& job = {});

  // Files as records have them, where they are not those that are opened.
  void set_recorded_files(std::vector<std::string> files) { recorded_ = std::move(files); }

  // The world of a view: opened, or known. Null: failed, and reported.
  const world::World* world(const ViewText& view, const RunListener& listener, DiagnosticLog& log,
                            const Job& job = {});

 private:
  struct Opened {
    std::string key;
    world::World world;
    RecordSource source;
    std::unique_ptr<ViewMaker> maker;  // of world
  };
  Opened* opened(const ViewText& view, const RunListener& listener, DiagnosticLog& log,
                 const Job& job);

  OpenOptions open_;
  preview::ContextKind context_;
  std::vector<std::string> recorded_;
  std::list<Opened> worlds_;  // the last used first
  Runner runner_;
};

}  // namespace panwright::workspace
