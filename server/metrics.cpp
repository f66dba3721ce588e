#include "server/metrics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace panwright::server {

void LatencyHistogram::add(double seconds) {
  std::size_t bin = 0;
  for (double bound = 1e-6; bin + 1 < kBins && seconds >= bound; bound *= 2) ++bin;
  ++bins_[bin];
  ++count_;
}

double LatencyHistogram::quantile(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; count_ > 0 && bin < kBins; ++bin)
    if ((seen += bins_[bin]) >= std::max<std::uint64_t>(wanted, 1))
      return 1e-6 * std::exp2(static_cast<double>(bin));
  return 0;
}

std::string Metrics::json() const {
  nlohmann::ordered_json out;
  out["clients"] = clients;
  out["waiting"] = waiting;
  out["accepted"] = accepted;
  out["refused"] = refused;
  out["errors"] = errors;
  out["ignored"] = ignored;
  out["bytes_in"] = bytes_in;
  out["bytes_out"] = bytes_out;
  out["requests"] = nlohmann::ordered_json::object();
  for (const auto& [name, histogram] : latency) {
    auto& one = out["requests"][name];
    one["count"] = histogram.count();
    // upper bounds of bins
    one["median_ms"] = 1e3 * histogram.quantile(0.5);
    one["p99_ms"] = 1e3 * histogram.quantile(0.99);
    std::size_t used = LatencyHistogram::kBins;
    while (used > 0 && histogram.bins()[used - 1] == 0) --used;
    one["below_2^k_us"] = std::vector<std::uint64_t>(
        histogram.bins().begin(), histogram.bins().begin() + static_cast<std::ptrdiff_t>(used));
  }
  return out.dump();
}

}  // namespace panwright::server
