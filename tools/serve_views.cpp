// `render --views -`: views as lines of JSON, answered line by line.
#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "tools/print.h"
#include "tools/view_lines.h"

namespace panwright::tools {

namespace {

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

}  // namespace

int serve_views(workspace::ViewSession& session, const workspace::Settings& defaults,
                const workspace::RunListener& listener, CommandContext& context) {
  const Job& job = context.job();
  // a model that cannot be opened is known before the first line
  if (defaults.targets && session.world(defaults, listener, context.log(), job) == nullptr)
    return 0;
  ViewLines views(session, {defaults, listener, false, {}, {}}, context.log());
  Lines lines(job);
  std::string line;
  for (;;) {
    const Lines::Next next = lines.next(line);
    if (next == Lines::Next::end) return views.code();
    if (next == Lines::Next::cancelled) {
      report_cancelled(context.log());
      return views.code();
    }
    const std::string answer =
        next == Lines::Next::too_long ? views.answer_to_long_line() : views.answer(line, job);
    if (answer.empty()) continue;
    print("{}\n", answer);
    std::fflush(stdout);
    if (std::ferror(stdout) != 0) return views.code();
  }
}

}  // namespace panwright::tools
