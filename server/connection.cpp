#include "server/internal/connection.h"

#include <fmt/format.h>

#include <algorithm>

namespace panwright::server {

namespace {

constexpr double kGreetingSeconds = 5;     // and for the first bytes of a request
constexpr double kBytesPerSecond = 65536;  // slowest client, in both directions
constexpr double kDrainSeconds = 1;
constexpr std::string_view kHttpGet = "GET ";
constexpr std::size_t kMostHttp = 8192;  // bytes of a request line with its headers

std::string_view text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void Connection::start() {
  asio::error_code ignored;
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(asio::socket_base::keep_alive(true), ignored);
  if (protocol_.greets()) {
    set_deadline(kGreetingSeconds, false);
  } else if (!host_.admit(*this)) {
    return refuse(protocol_.crowded());
  } else {
    admitted_ = true;
  }
  read();
}

void Connection::close() {
  ended_ = true;
  asio::error_code ignored;
  deadline_.cancel();
  if (!socket_.is_open()) return;
  socket_.close(ignored);
  host_.closed(*this);
}

// says_so: with an error reply, else the connection is closed at once.
void Connection::set_deadline(double seconds, bool says_so) {
  deadline_.expires_after(std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds)));
  deadline_.async_wait([self = shared_from_this(), says_so](const asio::error_code& error) {
    if (error || !self->socket_.is_open()) return;
    if (says_so && !self->ended_)
      self->refuse(self->protocol_.late());
    else
      self->close();
  });
}

void Connection::read() {
  socket_.async_read_some(asio::buffer(chunk_), [self = shared_from_this()](
                                                    const asio::error_code& error, std::size_t n) {
    if (error) return self->close();
    self->host_.count(n, 0, false);
    if (self->ended_) return;
    self->buffer_.insert(self->buffer_.end(), self->chunk_.begin(),
                         self->chunk_.begin() + static_cast<std::ptrdiff_t>(n));
    self->process();
  });
}

// A request for metrics.
void Connection::process_http() {
  const std::string_view text = text_of(buffer_);
  if (text.find("\r\n\r\n") == text.npos && buffer_.size() < kMostHttp) return read();
  const bool known = text.starts_with("GET /metrics ");
  const std::string body = known ? host_.metrics() + "\n" : "expected /metrics\n";
  const std::string answer = fmt::format(
      "HTTP/1.0 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      known ? "200 OK" : "404 Not Found", known ? "application/json" : "text/plain", body.size(),
      body);
  send(Bytes(answer.begin(), answer.end()), true);
}

// Removes bytes from the front.
void Connection::take(std::size_t bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(bytes));
}

void Connection::greeted(Step step) {
  take(step.bytes);
  asked_ = true;
  if (!host_.admit(*this)) return refuse(protocol_.crowded());
  admitted_ = true;
  send(std::move(step.reply), false);
}

// The deadline follows from what has come, not from when it came.
void Connection::wait_for_rest() {
  if (admitted_) {
    const auto now = std::chrono::steady_clock::now();
    if (!waits_) begun_ = now;
    waits_ = true;
    const double allowed = kGreetingSeconds + static_cast<double>(buffer_.size()) / kBytesPerSecond;
    const double passed = std::chrono::duration<double>(now - begun_).count();
    set_deadline(std::max(allowed - passed, 0.0), true);
  }
  read();
}

void Connection::process() {
  if (buffer_.empty()) {
    // a client may think for as long as it likes
    waits_ = false;
    deadline_.cancel();
    return read();
  }
  const std::string_view text = text_of(buffer_).substr(0, kHttpGet.size());
  if (!asked_ && text == kHttpGet) return process_http();
  if (!asked_ && kHttpGet.starts_with(text)) return wait_for_rest();
  Step step = protocol_.next(buffer_, admitted_);
  switch (step.kind) {
    case Step::Kind::more:
      return wait_for_rest();
    case Step::Kind::greeted:
      return greeted(std::move(step));
    case Step::Kind::refused:
      return refuse(std::move(step.reply));
    case Step::Kind::request:
      break;
  }
  asked_ = true;
  waits_ = false;
  deadline_.cancel();
  Bytes request;
  if (step.bytes == buffer_.size()) {
    request.swap(buffer_);
  } else {
    request.assign(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(step.bytes));
    take(step.bytes);
  }
  host_.submit(shared_from_this(), std::move(request));
}

void Connection::reply(Reply reply) {
  if (!socket_.is_open()) return;
  if (reply.then == Reply::Then::quit) host_.quit(*this);
  if (reply.silent) return process();
  if (reply.bytes.empty()) return drain();
  send(std::move(reply.bytes), reply.then != Reply::Then::next);
}

void Connection::send(Bytes bytes, bool last) {
  host_.count(0, bytes.size(), asked_ && protocol_.is_error(bytes));
  sent_ = std::move(bytes);
  set_deadline(kGreetingSeconds + static_cast<double>(sent_.size()) / kBytesPerSecond, false);
  asio::async_write(socket_, asio::buffer(sent_),
                    [self = shared_from_this(), last](const asio::error_code& failed, std::size_t) {
                      if (failed) return self->close();
                      self->deadline_.cancel();
                      self->sent_ = {};
                      if (last)
                        self->drain();
                      else
                        self->process();
                    });
}

void Connection::refuse(Bytes bytes) {
  ended_ = true;
  asio::error_code ignored;
  socket_.cancel(ignored);  // the read under way
  send(std::move(bytes), true);
}

// Ends the connection so that the client reads what was sent: what still comes is dropped.
void Connection::drain() {
  ended_ = true;
  asio::error_code ignored;
  socket_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  host_.leave(*this);
  set_deadline(kDrainSeconds, false);
  const auto step = [](auto&& again, const std::shared_ptr<Connection>& self) -> void {
    self->socket_.async_read_some(asio::buffer(self->chunk_),
                                  [self, again](const asio::error_code& error, std::size_t) {
                                    if (error)
                                      self->close();
                                    else
                                      again(again, self);
                                  });
  };
  step(step, shared_from_this());
}

}  // namespace panwright::server
