// Connection of one client. Private to server.
#pragma once

#include <array>
#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/internal/protocol.h"
#include "server/packing.h"
#include "server/session.h"

namespace panwright::server {

class Connection;

// Shared side of all connections; all calls come from the thread of the sockets.
class Host {
 public:
  virtual ~Host() = default;
  // A client has begun. False: there are too many.
  virtual bool admit(Connection& connection) = 0;
  // Answers a whole request by Connection::reply().
  virtual void submit(std::shared_ptr<Connection> connection, Bytes request) = 0;
  // A client's session has ended.
  virtual void leave(Connection& connection) = 0;
  virtual void closed(Connection& connection) = 0;
  virtual void quit(Connection& connection) = 0;
  virtual std::string metrics() = 0;
  virtual void count(std::size_t bytes_in, std::size_t bytes_out, bool error) = 0;
};

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  // Of TCP or a path.
  using Socket = asio::generic::stream_protocol::socket;

  // Expects: host and protocol outlive the connection.
  Connection(Socket socket, Host& host, const Protocol& protocol, std::uint64_t number)
      : socket_(std::move(socket)),
        deadline_(socket_.get_executor()),
        host_(host),
        protocol_(protocol),
        number_(number) {}

  void start();
  // The answer to the request under way.
  void reply(Reply reply);
  void close();
  std::uint64_t number() const { return number_; }

 private:
  void read();
  void process();
  void process_http();
  void take(std::size_t bytes);
  void greeted(Step step);
  void wait_for_rest();
  void send(Bytes bytes, bool last);
  void refuse(Bytes bytes);
  void drain();
  void set_deadline(double seconds, bool says_so);

  Socket socket_;
  asio::steady_timer deadline_;
  Host& host_;
  const Protocol& protocol_;
  const std::uint64_t number_;
  std::array<std::uint8_t, 1 << 16> chunk_;
  Bytes buffer_;                                 // received, not yet answered
  Bytes sent_;                                   // under way
  std::chrono::steady_clock::time_point begun_;  // of the request that is incomplete
  bool waits_ = false;                           // for the rest of one
  bool admitted_ = false;
  bool asked_ = false;  // a greeting or a request has come
  bool ended_ = false;  // nothing more is read as a request
};

}  // namespace panwright::server
