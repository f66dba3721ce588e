// Progress of a job on a terminal.
#pragma once

#include <memory>
#include <string>

#include "base/job.h"

namespace panwright::tools {

// Progress line of work longer than two seconds, on standard error, on a terminal only:
// "tessellating  42 %, 1.2k of 2.9k, 350/s, 5 s left", or "compile: 4 s" without a total. Cleared
// before other output.
class ProgressLine {
 public:
  // what: name of the whole work, "compile"
  explicit ProgressLine(std::string what);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress);

  // Clears the line and stops.
  void end();

 private:
  class Ticker;
  std::unique_ptr<Ticker> ticker_;  // null: no terminal
};

// Returns the line in words. seconds: since the phase began.
std::string progress_words(const Progress& progress, double seconds);

// Clears a visible line, for other output.
void wipe_progress();

}  // namespace panwright::tools
