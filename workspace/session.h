// Session of rendering views, one call after the other, as in `render --views`.
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

// Session that keeps models, contexts and uploads between calls: the models of the last four sets
// of targets and parameters.
class ViewSession {
 public:
  // open: its parameters are replaced by those of the views.
  ViewSession(OpenOptions open, preview::ContextKind context)
      : open_(std::move(open)), context_(context) {}

  // Renders views, in order. First checks all views as far as possible without their models, then
  // those of one model after the other.
  //
  //   listener  Written::frame is the index in `views`
  //   returns   the number of images: all of them
  // Expects: targets and an output in each view.
  // Fails: E0201, E0203; as open_world(), FrameMaker and run_frames().
  Result<std::size_t> run(std::span<const View> views, const RunListener& listener,
                          DiagnosticLog& log, const Job& job = {});

  // Sets the files to record, if they differ from the opened ones.
  void set_recorded_files(std::vector<std::string> files) { recorded_ = std::move(files); }

  // Returns the world of a view: opened, or cached. Null: failed, and reported.
  const world::World* world(const View& view, const RunListener& listener, DiagnosticLog& log,
                            const Job& job = {});

  // Makes the frame of a view without drawing it, for its mistakes; maps and catalogues that it
  // reads are kept for run(). Fails: as FrameMaker.
  Result<Frame> frame(const View& view, DiagnosticLog& log);

 private:
  struct Opened {
    std::string key;
    world::World world;
    RecordSource source;
    std::unique_ptr<FrameMaker> maker;  // of world
  };
  Opened* opened(const View& view, const RunListener& listener, DiagnosticLog& log, const Job& job);

  OpenOptions open_;
  preview::ContextKind context_;
  std::vector<std::string> recorded_;
  std::list<Opened> worlds_;  // most recently used first
  Runner runner_;
};

}  // namespace panwright::workspace
