#include "tools/command_context.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "tools/print.h"
#include "tools/words.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

bool wants_color(const std::string& when) {
  if (when != "auto") return when == "always";
  const char* no_color = std::getenv("NO_COLOR");
  if (no_color != nullptr && no_color[0] != '\0') return false;
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
}

// What importers find in a file whichever command reads it. note: not what was assumed or is
// missing, which the result shows
constexpr Code kOfImports[] = {Code("N6007"), Code("W6008"), Code("W6215"), Code("N6301"),
                               Code("W6302"), Code("W6303"), Code("N6304"), Code("W6305")};

// A log for people without some notes.
DiagnosticLog without(const DiagnosticLog& log, std::span<const Code> codes) {
  DiagnosticLog out;
  out.sources() = log.sources();
  for (const Diagnostic& entry : log.entries())
    if (std::find(codes.begin(), codes.end(), entry.code) == codes.end())
      out.report(entry.code, entry.where, entry.message, entry.hint, entry.object);
  return out;
}

// A log for people with one line in the place of what importers found; quiet: and of what `check`
// says of foil.
DiagnosticLog summarised(const DiagnosticLog& log, bool quiet) {
  DiagnosticLog out;
  out.sources() = log.sources();
  std::size_t warnings = 0;
  std::string codes;
  for (const Diagnostic& entry : log.entries()) {
    // of the text itself, as of cells that are off: shown
    const bool of_text =
        entry.where.file != kNoFile && log.sources().file(entry.where.file).name.ends_with(".pxn");
    const bool of_import =
        std::find(std::begin(kOfImports), std::end(kOfImports), entry.code) != std::end(kOfImports);
    const bool of_foil = quiet && entry.code == Code("W7002");
    if ((of_text || !of_import) && !of_foil) {
      out.report(entry.code, entry.where, entry.message, entry.hint, entry.object);
      continue;
    }
    if (entry.severity() != Severity::warning) continue;
    ++warnings;
    const std::string name(code_info(entry.code).name);
    if (codes.find(name) == codes.npos) codes += (codes.empty() ? "" : ", ") + name;
  }
  if (warnings > 0)
    out.report_file(
        Code("N6301"), {},
        fmt::format("{} of imported files{} not shown ({})", counted(warnings, "warning"),
                    codes.find("W7002") == codes.npos ? "" : " and foil", codes),
        "'panwright check' of the same file shows them");
  return out;
}

}  // namespace

CommandContext::CommandContext(std::string command, const CommonOptions& options, const Host& host)
    : command_(std::move(command)),
      options_(options),
      watch_signals_(host.watch_signals),
      progress_(command_),
      job_(host.job.with({options.threads, [this](const Progress& p) { progress_.show(p); }})),
      result_(std::make_unique<Json>()) {
  (*result_)["schema"] = 1;  // the number that schema_id ends with
  (*result_)["schema_id"] = fmt::format("panwright/{}/1", command_);
  (*result_)["command"] = command_;
  log_.set_files(std::make_shared<FileUses>(job_));
  if (!options.sarif.empty())
    files().will_write(options.sarif, "--sarif", log_, FileUses::Output::diagnostics);
}

CommandContext::~CommandContext() = default;

const Job& CommandContext::job() {
  if (watch_signals_) std::exchange(watch_signals_, nullptr)();
  return job_;
}

void CommandContext::end_step() {
  if (!step_.empty()) timings_.emplace_back(step_, seconds_since(step_start_));
}

void CommandContext::step(std::string name) {
  end_step();
  step_ = std::move(name);
  step_start_ = Clock::now();
}

void CommandContext::add_timing(std::string name, double seconds) {
  timings_.emplace_back(std::move(name), seconds);
}

void CommandContext::add_timings(const std::vector<workspace::Step>& steps) {
  for (const workspace::Step& step : steps) add_timing(step.name, step.seconds);
}

void CommandContext::add_work(const WorkCounts& work) {
  Json& out = (*result_)["cache"];
  work_.clear();
  for (std::size_t i = 0; i < kWorks; ++i) {
    const WorkCounts::Count& count = work.of[i];
    const std::string name(work_name(static_cast<Work>(i)));
    out[name] = {{"reused", count.reused}, {"made", count.made}};
    if (const std::uint64_t all = count.reused + count.made; all > 0)
      work_ += fmt::format("{}{}: {} of {}", work_.empty() ? "" : ", ", name, count.reused, all);
  }
}

void CommandContext::wrote(const std::string& path, std::string detail) {
  if (path.empty() || path == "-") return;
  (*result_)["written"].push_back(path);
  written_.emplace_back(path, std::move(detail));
}

void CommandContext::say_what_was_written() const {
  if (left_out_)
    print(stderr, "nothing is written; {}\n",
          *left_out_ == LeftOut::unnamed ? "-o FILE writes the readable part in spite of errors"
                                         : "terrain is tiled where its text has no errors");
  for (const auto& [path, detail] : written_) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) continue;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) continue;
    print(stderr, "wrote {} ({}{}{}){}\n", path, bytes_words(bytes), detail.empty() ? "" : ", ",
          detail, log_.has_errors() ? " without the parts that failed" : "");
  }
}

int CommandContext::finish(int clean) {
  end_step();
  step_.clear();
  progress_.end();
  log_.sort_by_place();
  // which may be standard output: after what was printed there
  std::fflush(stdout);
  if (!options_.sarif.empty() && write_file(options_.sarif, as_bytes(to_sarif(log_)), log_))
    wrote(options_.sarif, counted(log_.entries().size(), "diagnostic"));
  const int code = log_.has_errors() ? exit_code(log_) : clean;
  if (options_.json) {
    Json& out = *result_;
    out["exit_code"] = code;
    if (options_.timings)
      for (const auto& [name, seconds] : timings_) out["timings_ms"][name] = 1e3 * seconds;
    Json diagnostics = Json::parse(to_json(log_));
    for (const char* key : {"errors", "warnings", "notes", "hidden", "diagnostics"})
      out[key] = std::move(diagnostics[key]);
    print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    // a log that is full has left out an unknown number
    const bool whole = log_.hidden() == 0;
    const DiagnosticLog told = whole ? without(log_, left_out_codes_) : log_;
    print(stderr, "{}",
          to_text(whole && summarises_imports_ ? summarised(told, options_.quiet) : told,
                  {.color = wants_color(options_.color), .notes = !options_.quiet}));
    if (log_.errors() > 1)
      print(stderr, "panwright: {}{}\n", counted(log_.errors(), "error"),
            log_.warnings() > 0 ? ", " + counted(log_.warnings(), "warning") : "");
    if (!options_.quiet) say_what_was_written();
    if (options_.timings)
      for (const auto& [name, seconds] : timings_)
        print(stderr, "{:>10.3f} ms  {}\n", 1e3 * seconds, name);
    if (options_.timings && !work_.empty()) print(stderr, "from the cache: {}\n", work_);
  }
  return code;
}

}  // namespace panwright::tools
