// Place and limits of a server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace panwright::server {

struct ListenOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any
  std::string path;        // of a Unix socket, for this user alone, in place of TCP; empty: none
  std::size_t most_clients = 16;
  std::uint64_t most_request = std::uint64_t{16} << 20;  // bytes of one request
  double most_seconds = 60;                              // of one request
  // Called once, when clients can connect: with the address and the port, or the path and 0.
  std::function<void(const std::string& where, std::uint16_t port)> ready;
};

}  // namespace panwright::server
