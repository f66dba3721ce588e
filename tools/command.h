// Subcommand: one file declares its options and does the work.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/job.h"
#include "tools/arguments.h"

namespace panwright::tools {

// Host program of a command.
struct Host {
  Job job;  // cancelled when the user stops the program
  // Called before work that polls the job: from then on, a signal cancels it. May be empty.
  std::function<void()> watch_signals;
};

// Example of a command line.
struct Example {
  std::string_view command;  // "render"
  std::string_view words;    // after the command
  std::string_view what;     // its effect
};

struct Command {
  std::string name;
  std::string help;  // one line
  std::function<void(Arguments&)> declare;
  std::function<int(const Host&)> run;  // the exit code
};

// Makes a command whose options are a struct of its own: `declare` binds them, `run` gets them.
// Both are called once at most.
template <class Options>
Command command(std::string name, std::string help, void (*declare)(Arguments&, Options&),
                int (*run)(const Options&, const Host&)) {
  auto options = std::make_shared<Options>();
  return {std::move(name), std::move(help),
          [=](Arguments& arguments) { declare(arguments, *options); },
          [=](const Host& host) { return run(*options, host); }};
}

}  // namespace panwright::tools
