// `render --views -`: views as lines of JSON, answered line by line.
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/clock.h"
#include "tools/print.h"
#include "tools/render_report.h"
#include "workspace/sky_settings.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// Lines of standard input, of bounded length.
class Lines {
 public:
  enum class Next { line, too_long, end, cancelled };
  explicit Lines(const Job& job) : job_(job) {}

  // A line without its end. The last one needs none.
  Next next(std::string& line) {
    line.clear();
    bool too_long = false;
    for (;;) {
      const std::size_t end = buffer_.find('\n', at_);
      const bool found = end != buffer_.npos;
      const std::size_t stop = found ? end : buffer_.size();
      too_long = too_long || line.size() + (stop - at_) > workspace::kMaxViewLine;
      if (!too_long) line.append(buffer_, at_, stop - at_);
      at_ = found ? end + 1 : stop;
      if (found) return too_long ? Next::too_long : Next::line;
      if (ended_) return too_long ? Next::too_long : line.empty() ? Next::end : Next::line;
      if (!fill()) return Next::cancelled;
    }
  }

 private:
  // False: cancelled.
  bool fill() {
    buffer_.resize(kBlock);
    at_ = 0;
    for (;;) {
      if (job_.cancelled()) return false;
      // not read() alone, which signals do not end; and they may come before poll()
      pollfd input{STDIN_FILENO, POLLIN, 0};
      constexpr int kMilliseconds = 200;
      const int ready = poll(&input, 1, kMilliseconds);
      if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
      const ssize_t count = read(STDIN_FILENO, buffer_.data(), buffer_.size());
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      buffer_.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
      ended_ = count <= 0;
      return true;
    }
  }

  static constexpr std::size_t kBlock = 1 << 16;
  const Job& job_;
  std::string buffer_;
  std::size_t at_ = 0;
  bool ended_ = false;
};

// The first of the order of exit_code() that occurs.
int worse(int a, int b) {
  constexpr int kOrder[] = {130, 70, 2, 3, 4, 1, 0};
  for (const int code : kOrder)
    if (a == code || b == code) return code;
  return a;
}

// One view of the stream.
class Answer {
 public:
  Answer(std::size_t index, Clock::time_point start) : index_(index), start_(start) {}

  void take(const workspace::Written& image) { image_ = image; }

  void print_line(const workspace::View& view, const DiagnosticLog& log) const {
    Json reply;
    reply["index"] = index_;
    if (view.settings.name) reply["name"] = *view.settings.name;
    reply["ok"] = image_.has_value() && !log.has_errors();
    reply["outputs"] = Json::array();
    if (image_) {
      reply["outputs"] = image_->outputs;
      describe_image(*image_, reply);
      reply["settings"] = Json::parse(image_->record)["view"];
    }
    // all of it, from the line to the files
    reply["ms"] = 1e3 * seconds_since(start_);
    reply["errors"] = log.errors();
    reply["warnings"] = log.warnings();
    reply["diagnostics"] = Json::array();
    const Json all = Json::parse(to_json(log));
    for (const Json& each : all["diagnostics"]) {
      Json entry;
      for (const char* key : {"code", "severity", "message", "hint"})
        if (each.contains(key) && each[key] != "") entry[key] = each[key];
      reply["diagnostics"].push_back(std::move(entry));
    }
    print("{}\n", reply.dump(-1, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
  }

 private:
  std::size_t index_;
  Clock::time_point start_;
  std::optional<workspace::Written> image_;
};

}  // namespace

int serve_views(workspace::ViewSession& session, const workspace::Settings& defaults,
                const workspace::RunListener& listener, CommandContext& context) {
  const Job& job = context.job();
  // a model that cannot be opened is known before the first line
  if (defaults.targets && session.world(defaults, listener, context.log(), job) == nullptr)
    return 0;
  Lines lines(job);
  std::string line;
  std::shared_ptr<FileUses> files = context.log().files();
  int code = 0;
  for (std::size_t index = 0;;) {
    const Lines::Next next = lines.next(line);
    if (next == Lines::Next::end) return code;
    if (next == Lines::Next::cancelled) {
      report_cancelled(context.log());
      return code;
    }
    if (next == Lines::Next::line && line.find_first_not_of(" \t\r") == line.npos) continue;
    Answer answer(index, Clock::now());
    DiagnosticLog log = context.log().apart();
    // an output may be that of an earlier line, but no input
    files = files->next_run();
    log.set_files(files);
    workspace::View view;
    bool good = false;
    if (next == Lines::Next::too_long) {
      workspace::parse_view("{}", index, defaults, view, log);
      log.report(
          Code("E0203"), {},
          fmt::format("{}: the line has more than {} bytes", view.label, workspace::kMaxViewLine));
    } else {
      good = workspace::parse_view(line, index, defaults, view, log);
    }
    const auto require = [&](bool there, const char* message) {
      if (!good || there) return;
      log.report(Code("E0203"), {}, view.label + ": " + message);
      good = false;
    };
    require(bool(view.settings.outputs),
            "no output, expected a file name, as \"output\": \"a.png\"");
    require(view.settings.targets || workspace::shows_sky(view.settings),
            "no targets, and none are given on the command line");
    workspace::RunListener own = listener;
    own.step = {};  // a process may answer for as long as it likes: nothing is kept
    own.written = [&](const workspace::Written& image) { answer.take(image); };
    try {
      if (good) (void)session.run({&view, 1}, own, log, job);
    } catch (const std::exception&) {
      report_exception(log);  // the next view may fit
    }
    answer.print_line(view, log);
    if (log.has_errors()) code = worse(code, exit_code(log));
    if (std::ferror(stdout) != 0) return code;
    ++index;
  }
}

}  // namespace panwright::tools
