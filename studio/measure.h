// What the window measures of itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace panwright::studio {

// Numbers of a run of any length: where there are too many, every second one is kept.
class Series {
 public:
  explicit Series(std::size_t most) : most_(most) {}
  void add(double value);
  std::size_t count() const { return count_; }  // that were added
  std::size_t every() const { return every_; }  // one of so many is kept
  const std::vector<double>& kept() const { return kept_; }
  double largest() const { return largest_; }  // of all; 0: none
  double at(double share) const;  // the value that so large a share lies at or below; 0: none

 private:
  std::size_t most_;
  std::size_t count_ = 0;
  std::size_t every_ = 1;
  double largest_ = 0;
  std::vector<double> kept_;
};

// A file was saved, and the image of the model as it is since then was on the screen. Seconds from
// the file's time of modification.
struct SavedToImage {
  double noticed = 0;  // the change was seen
  double read = 0;     // the models were made
  double shown = 0;    // it was on the screen
};

// Of a processor, that this thread took so far.
double thread_seconds();

// Bytes of this process in memory; 0: not known.
std::uint64_t resident_bytes();

}  // namespace panwright::studio
