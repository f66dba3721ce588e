#include "tools/report_page.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "tools/templates.h"

namespace panwright::tools {

std::string report_page(const nlohmann::ordered_json& report) {
  using Json = nlohmann::ordered_json;
  std::string page = report_template_text();
  constexpr std::string_view kPlace = "@report@";
  const std::size_t place = page.find(kPlace);
  const std::string end = page.substr(place + kPlace.size());
  page.resize(place);
  for (const char c : report.dump(-1, ' ', true, Json::error_handler_t::replace))
    if (c == '<')  // would end the element, or begin a comment
      page += "\\u003c";
    else
      page += c;
  return page + end;
}

}  // namespace panwright::tools
