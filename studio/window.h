// Window of `panwright view`.
#pragma once

#include <cstdint>
#include <string>

#include "base/diagnostic.h"
#include "studio/measure.h"
#include "studio/options.h"
#include "studio/render_thread.h"

namespace panwright::studio {

// Report of a run.
struct Report {
  Series spent{1 << 20};   // wall time of each frame on the window's thread, ms
  double busy = 0;         // largest processor time of a frame, ms
  double first_image = 0;  // seconds from the start to the first image; 0: no image
  Series saved{64};        // seconds from the modification of a file to its image
  SavedToImage last_saved;
  Series resident{64};  // bytes of memory after each frame of a script
  RenderThread::Status rendering;
  std::uint64_t readings = 0;  // of the models
  std::string command;         // of the last image
};

// Opens the window; returns when it is closed, or at the end of the script.
//
//   report   may be null
//   returns  false: no window, or a step of the script failed
// Fails: E5001 without a display, or OpenGL 3.3 in windows; E0203 where a step fails.
bool run(const Options& options, DiagnosticLog& log, Report* report = nullptr);

}  // namespace panwright::studio
