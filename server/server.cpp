#include "server/server.h"

#include <fmt/format.h>

#include <map>

#include "server/internal/service.h"
#include "server/internal/web_page.h"
#include "server/messages.h"
#include "server/metrics.h"
#include "server/request_log.h"

namespace panwright::server {

namespace {

// Framing of the PANGU protocol.
class PanguProtocol final : public Protocol {
 public:
  explicit PanguProtocol(std::uint64_t most) : most_(most) {}
  bool greets() const override { return true; }

  Step next(std::span<const std::uint8_t> received, bool admitted) const override {
    constexpr std::size_t kWord = 4;
    if (!admitted) {
      if (received.size() < kWord) return {};
      const std::uint32_t version = word_at(received);
      if (version >> 8 == 1) return {Step::Kind::greeted, kWord, okay()};
      return refusal(WireError::version,
                     fmt::format("version 0x{:x} of the protocol, expected 0x1xx", version));
    }
    const RequestSize size = request_size(received, most_);
    switch (size.state) {
      case RequestSize::State::unknown:
        return refusal(WireError::request, fmt::format("unknown request {}", word_at(received)));
      case RequestSize::State::too_large:
        return refusal(WireError::size, fmt::format("a request of {} bytes, expected at most {}",
                                                    size.bytes, most_));
      case RequestSize::State::incomplete:
        return {};
      case RequestSize::State::complete:
        break;
    }
    return {Step::Kind::request, static_cast<std::size_t>(size.bytes), {}};
  }

  Bytes crowded() const override {
    return error_reply(WireError::clients, "the server has as many clients as it takes");
  }
  Bytes late() const override {
    return error_reply(WireError::deadline, "the rest of the request did not come in time");
  }
  bool is_error(std::span<const std::uint8_t> reply) const override {
    return reply.size() >= 4 && word_at(reply) == reply::kError;
  }
  std::string name_of(std::span<const std::uint8_t> request) const override {
    const RequestKind* const kind = request_kind(word_at(request));
    return std::string(kind != nullptr ? kind->name : "unknown");
  }

 private:
  static Step refusal(WireError error, std::string_view text) {
    return {Step::Kind::refused, 0, error_reply(error, text)};
  }
  const std::uint64_t most_;
};

// Sessions over one stage.
class PanguAnswerer final : public Answerer {
 public:
  PanguAnswerer(const ServerOptions& options, DiagnosticLog& log, const Job& job)
      : options_(options), log_(log), job_(job) {}

  bool open() override {
    if (!options_.log.empty()) {
      auto made = RequestLog::create(options_.log, log_);
      if (!made) return false;
      request_log_ = *std::move(made);
    }
    if (options_.web) {
      const std::string address =
          options_.listen.path.empty() ? options_.listen.address : "127.0.0.1";
      auto page = WebPage::open(address, *options_.web, log_);
      if (!page) return false;
      page_ = *std::move(page);
      if (options_.web_ready) options_.web_ready(address, page_->port());
    }
    auto stage = Stage::open(options_.stage, log_, job_);
    if (!stage) return false;
    stage_ = *std::move(stage);
    // the first image makes the context and uploads models
    const auto camera = stage_->camera_of(stage_->initial(), 0);
    return bool(stage_->draw(stage_->initial(), *camera, nullptr, false, log_, job_));
  }

  void begin(std::uint64_t client) override {
    auto state = options_.shared && shared_ ? shared_ : std::make_shared<State>(stage_->initial());
    if (options_.shared) shared_ = state;
    SessionOptions session = options_.session;
    if (page_)
      session.shown = [this, client](Drawing&& drawing, const world::Camera& camera,
                                     const State& of, double seconds) {
        latency_.add(seconds);
        const Shown shown{client, latency_.count(), seconds, latency_.quantile(0.5),
                          latency_.quantile(0.99)};
        page_->show(std::move(drawing), text_of(shown, camera, of));
      };
    sessions_[client] = std::make_unique<Session>(*stage_, state, session);
    if (request_log_) request_log_->begin(client, options_.shared ? 0 : client);
  }

  Reply answer(std::uint64_t client, std::span<const std::uint8_t> request,
               const Job& job) override {
    Reply reply = sessions_.at(client)->answer(request, job);
    if (request_log_) request_log_->add(client, request, reply);
    return reply;
  }

  void leave(std::uint64_t client) override { sessions_.erase(client); }

  void end() override {
    sessions_.clear();
    page_.reset();
    stage_.reset();
  }

 private:
  const ServerOptions& options_;
  DiagnosticLog& log_;
  const Job& job_;
  std::unique_ptr<Stage> stage_;
  std::shared_ptr<State> shared_;
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions_;
  std::unique_ptr<RequestLog> request_log_;
  std::unique_ptr<WebPage> page_;  // null: none
  LatencyHistogram latency_;       // of images
};

}  // namespace

bool serve(const ServerOptions& options, DiagnosticLog& log, const Job& job) {
  const PanguProtocol protocol(options.listen.most_request);
  PanguAnswerer answerer(options, log, job);
  return run_service(options.listen, protocol, answerer, log, job);
}

}  // namespace panwright::server
