#include "studio/measure.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace panwright::studio {

void Series::add(double value) {
  largest_ = count_ == 0 ? value : std::max(largest_, value);
  if (count_++ % every_ != 0) return;
  kept_.push_back(value);
  if (kept_.size() < capacity_) return;
  std::size_t to = 0;
  for (std::size_t from = 0; from < kept_.size(); from += 2) kept_[to++] = kept_[from];
  kept_.resize(to);
  every_ *= 2;
}

double Series::quantile(double share) const {
  if (kept_.empty()) return 0;
  if (share >= 1) return largest_;
  std::vector<double> sorted = kept_;
  const auto place =
      static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1;
  const auto found = sorted.begin() + std::max<std::ptrdiff_t>(place, 0);
  std::nth_element(sorted.begin(), found, sorted.end());
  return *found;
}

double thread_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::uint64_t resident_bytes() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  unsigned long long whole = 0, resident = 0;
  const bool good = std::fscanf(file, "%llu %llu", &whole, &resident) == 2;
  std::fclose(file);
  return good ? resident * static_cast<unsigned long long>(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace panwright::studio
