// A subcommand: one file declares its options, parses nothing, and does the work.
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

// What the program that runs commands gives them.
struct Host {
  Job job;  // cancelled when the user stops the program
  // Called before work that polls the job: from then on, a signal cancels it. May be empty.
  std::function<void()> watch_signals;
};

// A command line that shows what a command is for.
struct Example {
  std::string_view command;  // "render"
  std::string_view words;    // what follows it
  std::string_view what;     // what it does
};

struct Command {
  std::string name;
  std::string help;  // one line
  std::function<void(Arguments&)> declare;
  std::function<int(const Host&)> run;  // the exit code
};

// A command whose options are a struct of its own: `declare` binds them, `run` gets them. Both are
// called once at most.
template <class Options>
Command command(std::string name, std::string help, void (*declare)(Arguments&, Options&),
                int (*run)(const Options&, const Host&)) {
  auto options = std::make_shared<Options>();
  return {std::move(name), std::move(help),
          [=](Arguments& arguments) { declare(arguments, *options); },
          [=](const Host& host) { return run(*options, host); }};
}

}  // namespace panwright::tools
