#include "server/internal/service.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <asio.hpp>
#include <chrono>
#include <cstring>
#include <future>
#include <map>
#include <optional>
#include <set>

#include "base/clock.h"
#include "server/internal/connection.h"
#include "server/internal/worker.h"
#include "server/metrics.h"

namespace panwright::server {

namespace {

using Tcp = asio::ip::tcp;
using Unix = asio::local::stream_protocol;
using Stream = asio::generic::stream_protocol;
using Clock = std::chrono::steady_clock;

constexpr auto kWatch = std::chrono::milliseconds(50);          // for the end of the job
constexpr auto kAfterFailure = std::chrono::milliseconds(100);  // of accepting
constexpr std::size_t kMostStrangers = 256;  // connections that are no clients, yet or any more

// A socket that nobody listens to, of a server that was killed.
bool is_left_over(const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0 || !S_ISSOCK(info.st_mode)) return false;
  asio::io_context io;
  Unix::socket socket(io);
  asio::error_code error;
  socket.connect(Unix::endpoint(path), error);
  return error == asio::error::connection_refused;
}

class Service final : public Host {
 public:
  Service(const ListenOptions& options, const Protocol& protocol, Answerer& answerer,
          DiagnosticLog& log, const Job& job)
      : options_(options),
        protocol_(protocol),
        answerer_(answerer),
        log_(log),
        job_(job),
        acceptor_(io_),
        watch_(io_),
        retry_(io_) {}

  // Contexts are current on the worker's thread.
  bool open() {
    return on_worker([&] {
      return answerer_.open([this](std::function<void(const Job&)> work) {
        worker_.add([this, work = std::move(work)] { within_limit(work); });
      });
    });
  }

  // Before models are opened, so that a place in use is known at once.
  bool bind() {
    asio::error_code error;
    if (!options_.path.empty()) return bind_path();
    const asio::ip::address address = asio::ip::make_address(options_.address, error);
    const Tcp::endpoint endpoint(address, options_.port);
    if (!error) acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    return !error || report_address(error);
  }

  bool listen() {
    asio::error_code error;
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return report_address(error);
    if (!options_.ready) return true;
    if (!options_.path.empty()) {
      options_.ready(options_.path, 0);
      return true;
    }
    const Stream::endpoint bound = acceptor_.local_endpoint(error);
    Tcp::endpoint own;
    own.resize(bound.size());
    std::memcpy(own.data(), bound.data(), bound.size());
    options_.ready(own.address().to_string(), own.port());
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
      answerer_.end();
      return true;
    });
    if (bound_) ::unlink(options_.path.c_str());
  }

  bool admit(Connection& connection) override {
    if (clients_.size() >= options_.most_clients) {
      ++metrics_.refused;
      return false;
    }
    clients_.insert(connection.number());
    worker_.add([this, number = connection.number()] { answerer_.begin(number); });
    return true;
  }

  void submit(std::shared_ptr<Connection> connection, Bytes request) override {
    ++metrics_.waiting;
    const auto arrived = Clock::now();
    auto work = std::make_shared<Bytes>(std::move(request));
    worker_.add([this, connection, work, arrived] {
      Reply reply;
      within_limit(
          [&](const Job& one) { reply = answerer_.answer(connection->number(), *work, one); });
      asio::post(io_, [this, connection, arrived, name = protocol_.name_of(*work),
                       shared = std::make_shared<Reply>(std::move(reply))] {
        --metrics_.waiting;
        if (!shared->note.empty()) ++metrics_.ignored;
        metrics_.latency[name].add(seconds_since(arrived));
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
    worker_.add([this, number = connection.number()] { answerer_.leave(number); });
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

 private:
  bool report_address(const asio::error_code& error) {
    if (options_.path.empty())
      log_.report(Code("E0201"), {},
                  fmt::format("cannot listen on {}:{}: {}; expected an address of this machine and "
                              "a free port",
                              options_.address, options_.port, error.message()),
                  "--port 0 takes a free port");
    else
      log_.report(Code("E0201"), {},
                  fmt::format("cannot listen on {}: {}; expected a path of at most {} bytes at "
                              "which nothing is",
                              options_.path, error.message(), kMostPath));
    return false;
  }

  bool bind_path() {
    asio::error_code error;
    if (options_.path.size() > kMostPath) error = asio::error::name_too_long;
    if (!error && is_left_over(options_.path)) ::unlink(options_.path.c_str());
    if (!error) acceptor_.open(Stream(AF_UNIX, 0), error);
    if (!error) acceptor_.bind(Stream::endpoint(Unix::endpoint(options_.path)), error);
    if (error) return report_address(error);
    bound_ = true;
    // nobody can connect before listen(); early clients wait, and others see that it is in use
    constexpr mode_t kOwner = 0600;
    ::chmod(options_.path.c_str(), kOwner);
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    return !error || report_address(error);
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

  void accept() {
    acceptor_.async_accept([this](const asio::error_code& error, Stream::socket socket) {
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
        auto connection =
            std::make_shared<Connection>(std::move(socket), *this, protocol_, ++last_);
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

  // Of the worker's thread.
  void within_limit(const std::function<void(const Job&)>& work) {
    const Job one{JobOptions{job_.threads(), {}}};
    asio::post(io_, [this, one] { time_limit(one); });
    work(one);
    asio::post(io_, [this] { limit_.reset(); });
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

  static constexpr std::size_t kMostPath = sizeof(sockaddr_un::sun_path) - 1;
  const ListenOptions& options_;
  const Protocol& protocol_;
  Answerer& answerer_;
  DiagnosticLog& log_;
  const Job& job_;
  asio::io_context io_;
  asio::basic_socket_acceptor<Stream> acceptor_;
  asio::steady_timer watch_, retry_;
  std::optional<asio::steady_timer> limit_;
  Job current_{JobOptions{}};
  std::map<std::uint64_t, std::weak_ptr<Connection>> connections_;
  std::set<std::uint64_t> clients_;
  std::uint64_t last_ = 0;
  Metrics metrics_;
  bool quits_ = false;
  bool bound_ = false;  // to a path
  Worker worker_;       // last: its tasks use the others
};

}  // namespace

bool run_service(const ListenOptions& options, const Protocol& protocol, Answerer& answerer,
                 DiagnosticLog& log, const Job& job) {
  Service service(options, protocol, answerer, log, job);
  const bool open = service.bind() && service.open() && service.listen();
  if (open) service.run();
  service.end();
  return open;
}

}  // namespace panwright::server
