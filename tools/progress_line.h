// Progress of a job on a terminal.
#pragma once

#include <memory>
#include <string>

#include "base/job.h"

namespace panwright::tools {

// Shows on standard error, on a terminal only, what is done once that has taken two seconds:
// "tessellating  42 %, 1.2k of 2.9k, 350/s, 5 s left", or "compile: 4 s" where no phase says how
// much there is. The line goes before anything is printed.
class ProgressLine {
 public:
  // what: the work as a whole, "compile"
  explicit ProgressLine(std::string what);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress);

  // Shows no more from here on, and wipes what is there.
  void end();

 private:
  class Ticker;
  std::unique_ptr<Ticker> ticker_;  // null: no terminal
};

// The line in words. seconds: since the phase began.
std::string progress_words(const Progress& progress, double seconds);

// Wipes the line that is shown, if there is one, so that other text may be printed.
void wipe_progress();

}  // namespace panwright::tools
