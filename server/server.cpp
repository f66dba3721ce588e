#include "server/server.h"

#include <fmt/format.h>

#include <asio.hpp>
#include <chrono>
#include <future>
#include <map>
#include <optional>
#include <set>

#include "base/clock.h"
#include "server/internal/connection.h"
#include "server/internal/worker.h"
#include "server/metrics.h"
#include "server/request_log.h"

namespace panwright::server {

namespace {

using Tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr auto kWatch = std::chrono::milliseconds(50);          // for the end of the job
constexpr auto kAfterFailure = std::chrono::milliseconds(100);  // of accepting
constexpr std::size_t kMostStrangers = 256;  // connections that are no clients, yet or any more

class Service final : public Host {
 public:
  Service(const ServerOptions& options, DiagnosticLog& log, const Job& job)
      : options_(options), log_(log), job_(job), acceptor_(io_), watch_(io_), retry_(io_) {}

  // The stage lives on the worker's thread, where its context is current.
  bool open() {
    if (!options_.log.empty()) {
      auto made = RequestLog::create(options_.log, log_);
      if (!made) return false;
      request_log_ = *std::move(made);
    }
    return on_worker([&] {
      auto stage = Stage::open(options_.stage, log_, job_);
      if (!stage) return false;
      stage_ = *std::move(stage);
      return warm_up();
    });
  }

  // Before models are opened, so that a port in use is known at once.
  bool bind() {
    asio::error_code error;
    const asio::ip::address address = asio::ip::make_address(options_.address, error);
    const Tcp::endpoint endpoint(address, options_.port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(Tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    return !error || report_address(error);
  }

  bool listen() {
    asio::error_code error;
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return report_address(error);
    const Tcp::endpoint bound = acceptor_.local_endpoint();
    if (options_.ready) options_.ready(bound.address().to_string(), bound.port());
    return true;
  }

  void run() {
    accept();
    watch();
    io_.run();
  }

  // Frees what belongs to the worker's thread.
  void end() {
    current_.cancel();
    (void)on_worker([&] {
      sessions_.clear();
      stage_.reset();
      return true;
    });
  }

  bool admit(Connection& connection) override {
    if (clients_.size() >= options_.most_clients) {
      ++metrics_.refused;
      return false;
    }
    clients_.insert(connection.number());
    worker_.add([this, number = connection.number()] { begin_session(number); });
    return true;
  }

  void submit(std::shared_ptr<Connection> connection, Bytes request) override {
    ++metrics_.waiting;
    const auto arrived = Clock::now();
    auto work = std::make_shared<Bytes>(std::move(request));
    worker_.add([this, connection, work, arrived] {
      const Job one{JobOptions{job_.threads(), {}}};
      asio::post(io_, [this, one] { time_limit(one); });
      Reply reply = sessions_.at(connection->number())->answer(*work, one);
      if (request_log_) request_log_->add(connection->number(), *work, reply);
      asio::post(io_, [this, connection, arrived, number = word_at(*work),
                       shared = std::make_shared<Reply>(std::move(reply))] {
        limit_.reset();
        --metrics_.waiting;
        if (!shared->note.empty()) ++metrics_.ignored;
        metrics_.latency[number].add(seconds_since(arrived));
        connection->reply(std::move(*shared));
      });
    });
  }

  void closed(Connection& connection) override {
    connections_.erase(connection.number());
    leave(connection);
  }

  void leave(Connection& connection) override {
    if (clients_.erase(connection.number()) == 0) return;
    worker_.add([this, number = connection.number()] { sessions_.erase(number); });
  }

  // Another client keeps the server.
  void quit(Connection&) override { quits_ = quits_ || clients_.size() <= 1; }

  std::string metrics() override {
    metrics_.clients = clients_.size();
    return metrics_.json();
  }

  void count(std::size_t bytes_in, std::size_t bytes_out, bool error) override {
    metrics_.bytes_in += bytes_in;
    metrics_.bytes_out += bytes_out;
    if (error) ++metrics_.errors;
  }

  std::uint64_t most_request() const override { return options_.most_request; }

 private:
  bool report_address(const asio::error_code& error) {
    log_.report(Code("E0201"), {},
                fmt::format("cannot listen on {}:{}: {}; expected an address of this machine and "
                            "a free port",
                            options_.address, options_.port, error.message()),
                "--port 0 takes a free port");
    return false;
  }

  template <class Work>
  bool on_worker(const Work& work) {
    std::promise<bool> done;
    worker_.add([&] {
      try {
        done.set_value(work());
      } catch (const std::exception&) {
        report_exception(log_);
        done.set_value(false);
      }
    });
    return done.get_future().get();
  }

  // The first image makes the context and uploads models.
  bool warm_up() {
    const auto camera = stage_->camera_of(stage_->initial(), 0);
    return bool(stage_->draw(stage_->initial(), *camera, nullptr, false, log_, job_));
  }

  void begin_session(std::uint64_t number) {
    auto state = options_.shared && shared_ ? shared_ : std::make_shared<State>(stage_->initial());
    if (options_.shared) shared_ = state;
    sessions_[number] = std::make_unique<Session>(*stage_, state, options_.session);
    if (request_log_) request_log_->begin(number, options_.shared ? 0 : number);
  }

  void accept() {
    acceptor_.async_accept([this](const asio::error_code& error, Tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {
        // no descriptors are left: others may be freed soon
        retry_.expires_after(kAfterFailure);
        retry_.async_wait([this](const asio::error_code& stopped) {
          if (!stopped) accept();
        });
        return;
      }
      ++metrics_.accepted;
      if (connections_.size() < options_.most_clients + kMostStrangers) {
        auto connection = std::make_shared<Connection>(std::move(socket), *this, ++last_);
        connections_[last_] = connection;
        connection->start();
      } else {
        ++metrics_.refused;
      }
      accept();
    });
  }

  void watch() {
    watch_.expires_after(kWatch);
    watch_.async_wait([this](const asio::error_code& error) {
      if (error) return;
      if (!job_.cancelled() && !quits_) return watch();
      stop();
    });
  }

  void stop() {
    asio::error_code ignored;
    acceptor_.close(ignored);
    retry_.cancel();
    limit_.reset();
    current_.cancel();
    const auto open = connections_;
    for (const auto& [number, connection] : open)
      if (const auto alive = connection.lock()) alive->close();
    io_.stop();
  }

  // Cancels the request under way when its time is over.
  void time_limit(const Job& one) {
    current_ = one;
    limit_.emplace(io_);
    limit_->expires_after(
        std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * options_.most_seconds)));
    limit_->async_wait([one](const asio::error_code& error) {
      if (!error) one.cancel();
    });
  }

  const ServerOptions& options_;
  DiagnosticLog& log_;
  const Job& job_;
  asio::io_context io_;
  Tcp::acceptor acceptor_;
  asio::steady_timer watch_, retry_;
  std::optional<asio::steady_timer> limit_;
  Job current_{JobOptions{}};
  std::map<std::uint64_t, std::weak_ptr<Connection>> connections_;
  std::set<std::uint64_t> clients_;
  std::uint64_t last_ = 0;
  Metrics metrics_;
  bool quits_ = false;
  // of the worker's thread
  std::unique_ptr<Stage> stage_;
  std::shared_ptr<State> shared_;
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions_;
  std::unique_ptr<RequestLog> request_log_;
  Worker worker_;  // last: its tasks use the others
};

}  // namespace

bool serve(const ServerOptions& options, DiagnosticLog& log, const Job& job) {
  Service service(options, log, job);
  const bool open = service.bind() && service.open() && service.listen();
  if (open) service.run();
  service.end();
  return open;
}

}  // namespace panwright::server
