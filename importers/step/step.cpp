#include "importers/step/step.h"

#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "base/child_process.h"
#include "base/text.h"
#include "importers/step/internal/wire.h"

namespace panwright::importers::step {

namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "PANWRIGHT_STEP_READER";
constexpr const char* kProgram = "panwright-step";
// what its libraries take of the address space before it reads
constexpr std::uint64_t kLibraries = 1ull << 30;
// seconds on the clock for each of processor time: other programs run too
constexpr double kPatience = 4;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

fs::path given_reader() {
  const char* given = std::getenv(kVariable);
  return given == nullptr ? fs::path() : fs::path(given);
}

std::optional<fs::path> reader() {
  if (fs::path given = given_reader(); !given.empty())
    return is_file(given) ? std::optional(given) : std::nullopt;
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder :
       {self, self / PANWRIGHT_LIBEXEC_FROM_BIN, fs::path(PANWRIGHT_LIBEXEC)})
    if (is_file(folder / kProgram)) return folder / kProgram;
  return std::nullopt;
}

// Reports for a file, at the place that names it where there is one.
class Reporter {
 public:
  Reporter(const InputFile& file, DiagnosticLog& log) : file_(file), log_(log) {}

  void operator()(Code code, const std::string& message, std::string hint = {}) const {
    if (file_.included_at.file == kNoFile)
      log_.report_file(code, file_.name, message, std::move(hint));
    else
      log_.report(code, file_.included_at, message, std::move(hint));
  }

 private:
  const InputFile& file_;
  DiagnosticLog& log_;
};

std::string signal_text(int signal) {
  const char* text = strsignal(signal);
  return fmt::format("signal {}, {}", signal, text == nullptr ? "unknown" : text);
}

void report_end(const ProcessEnd& end, const fs::path& program, const Limits& limits,
                const Reporter& report) {
  using How = ProcessEnd::How;
  switch (end.how) {
    case How::satisfied:
      return;
    case How::not_started:
      return report(Code("E6001"),
                    fmt::format("{}, which reads STEP files, cannot be started: {}",
                                in_quotes(program.string()), std::strerror(end.code)),
                    fmt::format("install it again, or name it in {}", kVariable));
    case How::out_of_time:
      return report(Code("E6002"),
                    fmt::format("the model needs more time than the limit allows: {:g} s of "
                                "processor time, {:g} s in all",
                                limits.seconds, kPatience * limits.seconds),
                    "--max-seconds raises it; a larger --deflection needs less");
    case How::killed:
      return report(Code("E6601"),
                    fmt::format("the reader of STEP files crashed ({}); the program goes on",
                                signal_text(end.code)),
                    "another program may read the file and export it again, as STEP or glTF");
    case How::exited:
      if (end.code == kOutOfMemory)
        return report(Code("E6002"), "the model needs more memory than the limit allows",
                      "a larger --deflection needs less");
      return report(
          Code("E6601"),
          fmt::format("the reader of STEP files ended without an answer (exit code {})", end.code),
          "another program may read the file and export it again, as STEP or glTF");
  }
}

}  // namespace

bool is_available() { return reader().has_value(); }

Result<Imported> read(const InputFile& file, const Options& options, DiagnosticLog& log) {
  const Reporter report(file, log);
  const auto program = reader();
  if (!program) {
    const fs::path given = given_reader();
    report(
        Code("E6001"),
        given.empty()
            ? fmt::format("STEP is read by {}, which is not installed here", in_quotes(kProgram))
            : fmt::format("{} names {}, which is not a file", kVariable, in_quotes(given.string())),
        "build Panwright where OpenCASCADE is installed (scripts/setup), or export glTF from a "
        "CAD program, as FreeCAD");
    return failed;
  }
  SourceFile source;
  source.name = file.name;
  source.bytes = file.bytes;
  source.included_at = file.included_at;
  const FileId id = log.sources().add(source);

  const Request request{file.path, file.name, options.limits, options.deflection,
                        file.bytes->size()};
  const std::string head = request_head(request);
  const std::string_view input[] = {head, *file.bytes};
  const ProcessLimits limits{options.limits.memory + kLibraries, options.limits.seconds,
                             kPatience * options.limits.seconds};
  AnswerReader answer(request, id, log);
  const ProcessEnd end = run_process(
      *program, input, limits,
      [&](std::string_view bytes) { return answer.take(bytes) == AnswerReader::State::open; },
      file.job);
  switch (answer.state()) {
    case AnswerReader::State::open:
      report_end(end, *program, options.limits, report);
      return failed;
    case AnswerReader::State::damaged:
      report(Code("E6601"),
             fmt::format("the answer of the reader of STEP files is damaged: {}", answer.damage()));
      return failed;
    case AnswerReader::State::complete:
      break;
  }
  auto out = answer.finished();
  if (!out) return failed;
  return std::move(*out);
}

}  // namespace panwright::importers::step
