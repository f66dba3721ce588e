// Counts and latencies of a server.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace panwright::server {

// Histogram of times: bin k holds those below 2^k microseconds that the bin before does not.
class LatencyHistogram {
 public:
  static constexpr std::size_t kBins = 32;
  void add(double seconds);
  std::uint64_t count() const { return count_; }
  // Upper bound, in seconds, of the times of a share of all; 0: there are none.
  double quantile(double share) const;
  const std::array<std::uint64_t, kBins>& bins() const { return bins_; }

 private:
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

struct Metrics {
  std::map<std::string, LatencyHistogram> latency;  // by request
  std::uint64_t accepted = 0;                       // connections
  std::uint64_t refused = 0;                        // above the limit of clients
  std::uint64_t errors = 0;                         // error replies
  std::uint64_t ignored = 0;                        // requests without effect
  std::uint64_t bytes_in = 0, bytes_out = 0;
  std::size_t clients = 0;  // now
  std::size_t waiting = 0;  // requests in the queue now

  // One JSON object.
  std::string json() const;
};

}  // namespace panwright::server
