// Samples of positions, rotations and numbers over time, in segments. Private to scenario.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "scenario/internal/input.h"
#include "scenario/interpolate.h"
#include "scenario/method.h"
#include "scenario/source.h"

namespace panwright::scenario {

// One run of samples; between those of two runs nothing is interpolated.
template <class Value>
struct Samples {
  std::vector<double> times;      // n, ascending
  std::vector<Value> values;      // n
  std::vector<Value> velocities;  // n or none; of positions
  Method method = Method::linear;
  std::size_t degree = 1;  // of Lagrange's and Hermite's polynomial
  TimeSpan span;           // within the times
};

// Expects: a time in the span.
double value_at(const Samples<double>& samples, double time);
Vec3 value_at(const Samples<Vec3>& samples, double time);
Quat value_at(const Samples<Quat>& samples, double time);

// Segment that counts in a span.
struct Piece {
  TimeSpan span;
  std::size_t segment = 0;
};

// Returns the parts of spans that do not overlap, ascending: where two do, the first in the list
// counts. overlaps: index of a span that overlaps an earlier one, or spans.size().
std::vector<Piece> pieces_of(const std::vector<TimeSpan>& spans, std::size_t& overlaps);
std::vector<TimeSpan> spans_of(const std::vector<Piece>& pieces);
// Expects: a time in a piece.
std::size_t segment_at(const std::vector<Piece>& pieces, double time);

// Reports W8011 for the longest step that is over 10 times the median one. at: the samples' place.
void report_gap(const std::vector<double>& times, Input& input, std::string_view at);

}  // namespace panwright::scenario
