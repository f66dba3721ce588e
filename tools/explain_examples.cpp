#include "tools/explain_examples.h"

#include <algorithm>
#include <iterator>

namespace panwright::tools {

namespace {

constexpr CodeExample kExamples[] = {
#define PANWRIGHT_EXAMPLE(code, example, cure) {Code::code, example, cure},
#include "tools/explain_examples.def"
#undef PANWRIGHT_EXAMPLE
};

}  // namespace

const CodeExample* example_of(Code code) {
  const auto at = std::find_if(std::begin(kExamples), std::end(kExamples),
                               [&](const CodeExample& each) { return each.code == code; });
  return at == std::end(kExamples) ? nullptr : at;
}

}  // namespace panwright::tools
