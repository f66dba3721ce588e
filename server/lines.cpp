#include "server/lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "server/internal/service.h"
#include "server/internal/web_page.h"

namespace panwright::server {

namespace {

Bytes line_bytes(const std::string& text) {
  Bytes out(text.begin(), text.end());
  out.push_back('\n');
  return out;
}

// Framing of lines. The end of one is '\n'; a '\r' before it is no part of it.
class LineProtocol final : public Protocol {
 public:
  explicit LineProtocol(const LineServerOptions& options) : options_(options) {}
  bool greets() const override { return false; }

  Step next(std::span<const std::uint8_t> received, bool) const override {
    const auto end = std::ranges::find(received, std::uint8_t{'\n'});
    const auto bytes = static_cast<std::size_t>(end - received.begin());
    const std::uint64_t most = options_.listen.most_request;
    if (bytes > most)
      return {Step::Kind::refused, 0,
              line_bytes(options_.refusal(fmt::format("a line of more than {} bytes", most)))};
    if (end == received.end()) return {};
    return {Step::Kind::request, bytes + 1, {}};
  }

  Bytes crowded() const override {
    return line_bytes(options_.refusal("the server has as many clients as it takes"));
  }
  Bytes late() const override {
    return line_bytes(options_.refusal("the rest of the line did not come in time"));
  }
  bool is_error(std::span<const std::uint8_t> reply) const override {
    // it stands near the begin, and no text has it: quotes are escaped there
    constexpr std::size_t kMost = 4096;
    const std::string_view text(reinterpret_cast<const char*>(reply.data()),
                                std::min(reply.size(), kMost));
    return text.find("\"ok\":false") != text.npos;
  }
  std::string name_of(std::span<const std::uint8_t>) const override { return "line"; }

 private:
  const LineServerOptions& options_;
};

class LineAnswerer final : public Answerer {
 public:
  LineAnswerer(const LineServerOptions& options, DiagnosticLog& log)
      : options_(options), log_(log) {}

  bool open(const Post&) override {
    if (options_.page.port) {
      auto page = WebPage::open(options_.listen, options_.page, {}, log_);
      if (!page) return false;
      page_ = *std::move(page);
    }
    return options_.open();
  }

  void begin(std::uint64_t client) override {
    sessions_[client] = options_.begin(page_ ? page_->shown_of(client) : ShownImage());
  }
  void leave(std::uint64_t client) override { sessions_.erase(client); }
  void end() override {
    sessions_.clear();
    page_.reset();
    options_.end();
  }

  Reply answer(std::uint64_t client, std::span<const std::uint8_t> request,
               const Job& job) override {
    std::string_view line(reinterpret_cast<const char*>(request.data()), request.size());
    line.remove_suffix(1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::string answer = sessions_.at(client)->answer(line, job);
    Reply out;
    out.silent = answer.empty();
    if (!out.silent) out.bytes = line_bytes(answer);
    return out;
  }

 private:
  const LineServerOptions& options_;
  DiagnosticLog& log_;
  std::unique_ptr<WebPage> page_;  // null: none
  std::map<std::uint64_t, std::unique_ptr<LineSession>> sessions_;
};

}  // namespace

bool serve_lines(const LineServerOptions& options, DiagnosticLog& log, const Job& job) {
  const LineProtocol protocol(options);
  LineAnswerer answerer(options, log);
  return run_service(options.listen, protocol, answerer, log, job);
}

}  // namespace panwright::server
