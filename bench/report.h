// Results as files and as a table.
#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"

namespace panwright::bench {

// What the numbers were measured on, one "# name: value" line each.
std::string machine_header(const Context& context);

// Header, column names, one line a row (RFC 4180 quoting).
std::string to_csv(const Context& context, const Case& one);

// The same rows for a person; a bound that is missed is marked.
std::string to_table(const Context& context);

// How many rows miss a bound.
int missed(const std::vector<Row>& rows);

}  // namespace panwright::bench
