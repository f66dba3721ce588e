// Variables of text kernels. Private to ephemeris.
//
// Source: NAIF, Kernel Required Reading.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::ephemeris {

// Numbers or texts, never both. Dates (@2004-AUG-03) are numbers: seconds past J2000 of a calendar
// without leap seconds.
struct Values {
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

class Pool {
 public:
  // Adds the variables of a text kernel; a later value of a name replaces earlier ones.
  //
  //   problem  where false: "line 12: …"
  // Cost: O(text).
  bool read(std::string_view text, std::string& problem);

  // Return null where there is no such name, or its values are of the other kind.
  const std::vector<double>* numbers(const std::string& name) const;
  const std::vector<std::string>* texts(const std::string& name) const;
  std::optional<double> number(const std::string& name) const;  // the first of them
  std::optional<std::string> text(const std::string& name) const;
  const std::map<std::string, Values, std::less<>>& all() const { return values_; }

 private:
  std::map<std::string, Values, std::less<>> values_;
};

// Returns whether bytes are a text kernel: they begin with "KPL/", or have a line \begindata.
bool is_text_kernel(std::string_view text);

// Parses a calendar date of any of the forms "2004-AUG-03-06:00:20.184", "03-AUG-2004/06:00",
// "1972-JAN-1", "2004-08-03T06:00:20.184" and "2004-216T06:00:20": seconds past J2000 of a calendar
// without leap seconds.
std::optional<double> calendar_seconds(std::string_view text);

}  // namespace panwright::ephemeris
