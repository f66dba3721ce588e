// Messages of CCSDS in keyword-value notation or XML: a header, then blocks of metadata and
// records. Private to scenario.
//
// Sources: CCSDS 502.0-B-3, 5 and 7; 504.0-B-2, 4 and 6.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scenario/internal/input.h"
#include "scenario/internal/track.h"
#include "scenario/source.h"

namespace panwright::scenario {

struct Field {
  std::string_view key;
  std::string_view value;
};

// Line of data: an epoch and numbers.
struct Record {
  std::string_view line;
  std::string_view epoch;
  std::size_t first = 0;  // of its numbers, in Block::numbers
  std::size_t count = 0;
};

struct Block {
  std::string_view begin;  // the line META_START
  std::map<std::string_view, Field> fields;
  std::vector<Record> records;
  std::vector<double> numbers;

  const Field* find(std::string_view key) const;
};

struct Message {
  int version = 0;  // 1 for "1.0"…
  std::vector<Block> blocks;
};

// Grammar of one kind of message.
struct Grammar {
  std::string_view version_key;            // first in the file
  int versions = 1;                        // 1.0 to this one
  std::span<const std::string_view> keys;  // of metadata
  bool data_marks = false;                 // records lie between DATA_START and DATA_STOP
};

// Reads either notation: a text that begins with '<' is XML. Fails: E8001.
Result<Message> read_message(Input& input, const Grammar& grammar);
Result<Message> read_xml_message(Input& input, const Grammar& grammar);

// Returns a name in capitals; of a frame, J2000 as EME2000, which it is.
std::string capitals(std::string_view name);
std::string frame_name(std::string_view name);

// Common metadata of a block.
struct BlockTimes {
  TimeSystem system = TimeSystem::utc;
  std::optional<Epoch> start, stop;  // of the block
  std::optional<Epoch> useable_start, useable_stop;
};

// Value of a key that the message must have. Reports E8001 where it is missing; null then.
const Field* required(const Block& block, std::string_view key, Input& input);
// Reports each missing key that the standard demands and reading does not.
void check_present(const Block& block, std::span<const std::string_view> keys, Input& input,
                   bool strict);
// Returns whether a block shares some metadata, and TIME_SYSTEM, with the first one. False: E8001,
// E8007.
bool same_metadata(const Block& block, const Block& first, std::span<const std::string_view> keys,
                   Input& input);
// False: E8001, E8007.
bool read_times(const Block& block, BlockTimes& out, Input& input);
std::optional<Epoch> read_epoch(std::string_view text, TimeSystem system, Input& input);

// Epochs of a block's records as seconds after an epoch. Records that repeat the one before are
// left out (W8012). False: E8001, E8004.
//
//   kept  indices of the records
bool read_record_times(const Block& block, TimeSystem system, std::optional<Epoch>& epoch,
                       std::vector<double>& times, std::vector<std::size_t>& kept, Input& input,
                       bool strict);

// Returns the span in which a block counts: its usable one, within its records.
TimeSpan useable_span(const Block& block, const BlockTimes& block_times, const Epoch& epoch,
                      const std::vector<double>& times, Input& input, bool strict);

// Sets the span of a block's samples, and reports their gaps. False: E8004 for a span that ends
// before it begins.
template <class Value>
bool end_block(const Block& block, const BlockTimes& block_times, const Epoch& epoch,
               Samples<Value>& samples, Input& input, bool strict) {
  samples.span = useable_span(block, block_times, epoch, samples.times, input, strict);
  if (!(samples.span.begin <= samples.span.end)) {
    input.error(Code("E8004"), block.begin, "the usable span ends before it begins");
    return false;
  }
  report_gap(samples.times, input, block.begin);
  return true;
}

// Method and degree from INTERPOLATION or INTERPOLATION_METHOD. False: E8001.
struct MethodRead {
  bool stated = false;
  Method method = Method::linear;
  std::size_t degree = 1;
};
bool read_method(const Block& block, std::string_view key, MethodRead& out, Input& input);

// Reports W8012 once where a block has fewer records than its degree needs.
void check_degree(const Block& block, const MethodRead& method, std::size_t needed,
                  std::size_t records, Input& input);

// Pieces of the blocks; overlapping ones are a deviation.
std::vector<Piece> block_pieces(const std::vector<TimeSpan>& spans,
                                const std::vector<std::string_view>& places, Input& input,
                                bool strict);

}  // namespace panwright::scenario
