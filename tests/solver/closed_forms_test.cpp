// SPDX-License-Identifier: GPL-3.0-or-later
// Strips whose shape, strain or period follows from a formula: what a user computes by hand must come out. A closed
// form is met by the converged solution, so each is checked at an effort that is enough for it, which the form names;
// how the error grows below that is in tests/bench/results/convergence.md.
#include "support/closed_forms.h"

#include <cmath>
#include <ostream>

#include <gtest/gtest.h>

namespace geocloth::test {

static void PrintTo(const ClosedForm& form, std::ostream* out) {
  *out << form.what << " = " << form.reference << " (" << form.source << "), with " << form.enough.cells << " cells, "
       << form.enough.substeps << " substeps of 1/60 s, " << form.enough.relaxation_steps << " relaxation steps";
}

namespace {

class ClosedFormTest : public testing::TestWithParam<ClosedForm> {};

TEST_P(ClosedFormTest, IsMet) {
  const ClosedForm& form = GetParam();
  const double measured = form.measure(form.enough, make_cpu_solver);
  RecordProperty("error_percent", std::to_string(100 * (measured / form.reference - 1)));
  EXPECT_NEAR(measured, form.reference, form.tolerance * std::abs(form.reference));
}

INSTANTIATE_TEST_SUITE_P(Strips, ClosedFormTest, testing::ValuesIn(closed_forms().begin(), closed_forms().end()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace geocloth::test
