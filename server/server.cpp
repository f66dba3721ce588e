#include "server/server.h"

#include <fmt/format.h>

#include <atomic>
#include <map>

#include "server/internal/service.h"
#include "server/internal/web_page.h"
#include "server/messages.h"
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

  bool open(const Post& post) override {
    if (!options_.log.empty()) {
      auto made = RequestLog::create(options_.log, log_);
      if (!made) return false;
      request_log_ = *std::move(made);
    }
    if (options_.page.port) {
      // one look at what browsers ask waits at a time, so that they delay clients by one image
      const auto asked = [this, post] {
        if (!asked_.exchange(true)) post([this](const Job& job) { steer(job); });
      };
      auto page = WebPage::open(options_.listen, options_.page, asked, log_);
      if (!page) return false;
      page_ = *std::move(page);
    }
    auto stage = Stage::open(options_.stage, log_, job_);
    if (!stage) return false;
    stage_ = *std::move(stage);
    // the first image makes the context and uploads models
    const auto camera = stage_->camera_of(stage_->initial(), 0);
    return stage_->draw(
        stage_->initial(), *camera, nullptr, false, [](Drawing&) {}, log_, job_);
  }

  void begin(std::uint64_t client) override {
    sessions_[client] = session_over(options_.shared ? shared() : own(client), client);
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
    steering_.reset();
    page_.reset();
    stage_.reset();
  }

 private:
  // State of sessions, and its number in the log.
  struct Numbered {
    std::shared_ptr<State> state;
    std::uint64_t number = 0;
  };
  Numbered own(std::uint64_t number) const {
    return {std::make_shared<State>(stage_->initial()), number};
  }
  const Numbered& shared() {
    if (shared_.state == nullptr) shared_ = own(0);
    return shared_;
  }

  std::unique_ptr<Session> session_over(const Numbered& world, std::uint64_t number) {
    SessionOptions session = options_.session;
    session.log = &log_;
    if (page_)
      session.shown = [this, world, show = page_->shown_of(number)](
                          Drawing&& drawing, const world::Camera& camera, const world::World& of,
                          double time, double seconds) {
        steered_ = world;
        show(std::move(drawing), camera, of, time, seconds);
      };
    if (request_log_) request_log_->begin(number, world.number);
    return std::make_unique<Session>(*stage_, world.state, session);
  }

  // What browsers ask, of the world that they see. Images are drawn once.
  void steer(const Job& job) {
    asked_ = false;
    if (!page_) return;  // it has ended
    if (steered_.state == nullptr) steered_ = options_.shared ? shared() : own(kPages);
    if (steering_ == nullptr || steering_of_ != steered_.state) {
      steering_of_ = steered_.state;
      steering_ = session_over(steered_, kPages + pages_++);
    }
    const auto answer = [&](const Bytes& request) {
      const Reply reply = steering_->answer(request, job);
      if (request_log_) request_log_->add(kPages + pages_ - 1, request, reply);
    };
    Bytes image;
    for (Bytes& request : page_->take_requests())
      if (static_cast<Request>(word_at(request)) == Request::get_viewpoint_by_camera)
        image = std::move(request);
      else
        answer(request);
    if (!image.empty()) answer(image);
  }

  // numbers of sessions of the page, above those of clients
  static constexpr std::uint64_t kPages = std::uint64_t{1} << 32;
  const ServerOptions& options_;
  DiagnosticLog& log_;
  const Job& job_;
  std::unique_ptr<Stage> stage_;
  Numbered shared_;
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions_;
  std::unique_ptr<RequestLog> request_log_;
  std::unique_ptr<WebPage> page_;       // null: none
  std::atomic<bool> asked_{false};      // steer() waits
  Numbered steered_;                    // of the last image
  std::shared_ptr<State> steering_of_;  // state of steering_
  std::unique_ptr<Session> steering_;   // of the page; null: it asked nothing yet
  std::uint64_t pages_ = 0;             // sessions of it so far
};

}  // namespace

bool serve(const ServerOptions& options, DiagnosticLog& log, const Job& job) {
  const PanguProtocol protocol(options.listen.most_request);
  PanguAnswerer answerer(options, log, job);
  return run_service(options.listen, protocol, answerer, log, job);
}

}  // namespace panwright::server
