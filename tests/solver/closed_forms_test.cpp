// SPDX-License-Identifier: GPL-3.0-or-later
// Strips whose shape, strain, period or grip follows from a formula: what a user computes by hand must come out. A
// closed form is met by the converged solution, so each is checked at an effort that is enough for it, which the form
// names; how the error grows below that is in tests/bench/results/convergence.md.
#include "support/closed_forms.h"

#include <cmath>
#include <ostream>
#include <vector>

#include "support/machine.h"

namespace geocloth::test {
namespace {

struct FormCase : Machine {
  const ClosedForm* form;
  Effort effort;
};

void PrintTo(const FormCase& tested, std::ostream* out) {
  const ClosedForm& form = *tested.form;
  *out << form.what << " = " << form.reference << " (" << form.source << "), on " << name_of(tested) << " with "
       << tested.effort.cells << " cells, " << tested.effort.substeps << " substeps of 1/60 s, "
       << tested.effort.relaxation_steps << " relaxation steps";
}

std::vector<FormCase> all_cases() {
  std::vector<FormCase> cases;
  for (const Machine& machine : machines()) {
    for (const ClosedForm& form : closed_forms()) {
      if (!machine.slow()) {
        cases.push_back({machine, &form, form.enough});
      } else if (!machine.slowest()) {
        cases.push_back({machine, &form, form.least});
      } else if (form.single) {
        cases.push_back({machine, &form, *form.single});
      }
    }
  }
  return cases;
}

class ClosedFormTest : public MachineTest<FormCase> {};

TEST_P(ClosedFormTest, IsMet) {
  const ClosedForm& form = *GetParam().form;
  const double measured = form.measure(GetParam().effort, maker());
  RecordProperty("error_percent", std::to_string(100 * (measured / form.reference - 1)));
  EXPECT_NEAR(measured, form.reference, form.tolerance * std::abs(form.reference));
}

INSTANTIATE_TEST_SUITE_P(Strips, ClosedFormTest, testing::ValuesIn(all_cases()),
                         [](const auto& tested) { return tested.param.form->name + "_on_" + name_of(tested.param); });

}  // namespace
}  // namespace geocloth::test
