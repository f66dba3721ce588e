// Properties of a file that scenes do not have. Private to importers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/diagnostic.h"

namespace panwright::importers {

// Counter of lost properties, with the first place of each.
class LostProperties {
 public:
  // Distinct ones past the first 30 are counted together.
  void add(std::string_view what, SourceSpan where);

  // Reports all of them as one W6008 at the first place; those of other lines with theirs. Nothing
  // was lost: nothing.
  //
  //   whole  place where none is known
  void report(SourceSpan whole, DiagnosticLog& log) const;

 private:
  struct Known {
    std::uint64_t count = 0;
    SourceSpan where;
  };
  std::map<std::string, Known, std::less<>> known_;
};

// Returns true if a place is before another one, or the other is none.
bool is_before(const SourceSpan& place, const SourceSpan& other);

}  // namespace panwright::importers
