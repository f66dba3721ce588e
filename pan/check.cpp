#include "pan/internal/report.h"
#include "pan/model.h"

namespace panwright::pan {

bool Model::check(DiagnosticLog& log, const Job& job, std::uint32_t left) {
  using internal::Part;
  checked_ = false;
  return run_job(job, log, [&] {
    // tables first: what the arrays hold can be judged only by sound tables
    internal::Problems problems = internal::section_problems(*this, Part::tables, false, left, job);
    if (problems.empty()) problems = internal::unpack_tables(*this, job);
    if (problems.empty()) problems = internal::table_problems(*this);
    if (problems.empty()) find_places();
    internal::Problems arrays =
        internal::section_problems(*this, Part::arrays, problems.empty(), left, job);
    if (problems.empty() && arrays.empty()) arrays = internal::unpack_arrays(*this, job);
    problems.insert(problems.end(), arrays.begin(), arrays.end());
    for (const internal::Problem& problem : problems)
      log.report_file(problem.code, name_, problem.message);
    checked_ = problems.empty();
    return checked_;
  });
}

}  // namespace panwright::pan
