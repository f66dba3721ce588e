// Results as files and as a table.
#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"

namespace panwright::bench {

// Returns the machine of the measurements, one "# name: value" line each.
std::string machine_header(const Context& context);

// Returns the header, column names, one line a row (RFC 4180 quoting).
std::string to_csv(const Context& context, const Case& one);

// Returns the same rows for a person; missed bounds are marked.
std::string to_table(const Context& context);

// Returns the number of rows that miss a bound.
int missed(const std::vector<Row>& rows);

}  // namespace panwright::bench
