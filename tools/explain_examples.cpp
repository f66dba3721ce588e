#include "tools/explain_examples.h"

#include <algorithm>
#include <iterator>

namespace panwright::tools {

namespace {

constexpr CodeExample kCodeExamples[] = {
#define PANWRIGHT_EXAMPLE(code, example, cure) {Code(#code), example, cure},
#include "tools/explain_examples.def"
#undef PANWRIGHT_EXAMPLE
};

}  // namespace

const CodeExample* example_of(Code code) {
  const auto at = std::find_if(std::begin(kCodeExamples), std::end(kCodeExamples),
                               [&](const CodeExample& each) { return each.code == code; });
  return at == std::end(kCodeExamples) ? nullptr : at;
}

}  // namespace panwright::tools
