// Times at which kernels have answers.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "ephemeris/internal/clocks.h"
#include "ephemeris/internal/data.h"
#include "ephemeris/kernels.h"

namespace panwright::ephemeris {

namespace {

constexpr double kAlways = 1e13;  // seconds: without end, and still a double of 2 ms

// Bounds of all segments that may lie on the way from a body to the root.
void add_bounds(const Kernels::Data& data, int body, std::set<int>& visited,
                std::vector<double>& bounds) {
  std::vector<int> queue{body};
  while (!queue.empty()) {
    const int next = queue.back();
    queue.pop_back();
    const auto track = data.bodies.find(next);
    if (!visited.insert(next).second || track == data.bodies.end()) continue;
    for (const Timeline::Piece& piece : track->second.timeline.pieces()) {
      bounds.push_back(piece.begin);
      bounds.push_back(piece.end);
    }
    for (const OrbitSegment& segment : track->second.segments)
      if (visited.count(segment.centre) == 0) queue.push_back(segment.centre);
  }
}

std::vector<Interval> common(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  std::vector<Interval> out;
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    const Interval both{std::max(a[i].begin, b[k].begin), std::min(a[i].end, b[k].end)};
    if (both.begin <= both.end) out.push_back(both);
    (a[i].end < b[k].end ? i : k) += 1;
  }
  return out;
}

// Spans between bounds in which a question has an answer.
template <class Answers>
std::vector<Interval> spans_between(std::vector<double> bounds, const Answers& answers) {
  std::ranges::sort(bounds);
  bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());
  std::vector<Interval> out;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i)
    if (answers(bounds[i] + 0.5 * (bounds[i + 1] - bounds[i])))
      out.push_back({bounds[i], bounds[i + 1]});
  return joined(out);
}

}  // namespace

std::vector<Interval> Kernels::coverage(int target, int observer, int frame) const {
  std::vector<Interval> out{{-kAlways, kAlways}};
  if (target != observer) {
    std::vector<double> bounds;
    std::set<int> visited;
    add_bounds(*data_, target, visited, bounds);
    visited.clear();
    add_bounds(*data_, observer, visited, bounds);
    out = spans_between(std::move(bounds), [&](double et) {
      std::string problem;
      return data_->relative(target, observer, et, problem).has_value();
    });
  }
  return frame == kJ2000 ? out : common(out, attitude_coverage(frame));
}

std::vector<Interval> Kernels::attitude_coverage(int frame) const {
  const Interval always{-kAlways, kAlways};
  constexpr int kMostDepth = 16;
  for (int depth = 0; depth < kMostDepth; ++depth) {
    const auto kind = data_->class_of(frame);
    if (!kind) return {};
    if (kind->kind == 1) return {always};
    if (kind->kind == 4) {
      std::string relative =
          data_->pool.text("TKFRAME_" + std::to_string(kind->number) + "_RELATIVE").value_or("");
      if (relative.empty())
        relative =
            data_->pool.text("TKFRAME_" + data_->frame_text(frame) + "_RELATIVE").value_or("");
      const auto next = data_->frame_number(relative);
      if (!next) return {};
      frame = *next;
      continue;
    }
    std::vector<double> bounds;
    if (kind->kind == 2) {
      bounds = {-kAlways, kAlways};
      if (const auto track = data_->angles.find(kind->number); track != data_->angles.end())
        for (const Timeline::Piece& piece : track->second.timeline.pieces()) {
          bounds.push_back(piece.begin);
          bounds.push_back(piece.end);
        }
    } else if (const auto found = data_->turning.find(kind->number);
               kind->kind == 3 && found != data_->turning.end()) {
      for (const AttitudeSegment& segment : found->second)
        for (const Interval& span : ck_spans(segment.layout, segment.data))
          for (const double ticks : {span.begin, span.end}) {
            const auto et = et_of_ticks_or(kind->number, ticks);
            if (et) bounds.push_back(*et);
          }
    }
    return spans_between(std::move(bounds), [&](double et) {
      std::string problem;
      return data_->attitude(frame, et, 0, problem).has_value();
    });
  }
  return {};
}

}  // namespace panwright::ephemeris
