// Measurements of a run of the window.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace panwright::studio {

// Statistics of any number of values, of which a bounded number is kept.
class Series {
 public:
  // capacity: values that are kept; where it is reached, every second one is dropped
  explicit Series(std::size_t capacity) : capacity_(capacity) {}
  void add(double value);
  std::size_t count() const { return count_; }  // added values
  std::size_t every() const { return every_; }  // one of this number is kept
  const std::vector<double>& kept() const { return kept_; }
  double largest() const { return largest_; }  // of all values; 0: none
  double quantile(double share) const;         // of the kept values; 0: none

 private:
  std::size_t capacity_;
  std::size_t count_ = 0;
  std::size_t every_ = 1;
  double largest_ = 0;
  std::vector<double> kept_;
};

// Times from the modification of a file to its image on the screen, seconds.
struct SavedToImage {
  double noticed = 0;  // the change was found
  double read = 0;     // the models were read
  double shown = 0;    // the image was on the screen
};

// Processor time of this thread, seconds.
double thread_seconds();

// Resident memory of this process, bytes; 0: unknown.
std::uint64_t resident_bytes();

}  // namespace panwright::studio
