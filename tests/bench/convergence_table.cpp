// SPDX-License-Identifier: GPL-3.0-or-later
// How far the solver is from its closed forms, by what is spent: cells along the strip, substeps, relaxation steps.
// Writes a Markdown table for each form, one of how far a sheet on a ball is stretched, and one of Cusick's drape.
//
//   convergence_table OUT.md [NAME]     only forms whose name contains NAME
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>

#include "geocloth/asset/output_file.h"
#include "support/closed_forms.h"
#include "support/drape.h"
#include "support/swing.h"

namespace {

using geocloth::test::ClosedForm;

constexpr uint32_t kCells[] = {8, 16, 32};
constexpr uint32_t kSubsteps[] = {8, 16, 32, 64};
constexpr uint32_t kRelaxationSteps[] = {1, 2, 4, 8, 16};

std::string percent(double error) {
  if (!(std::abs(error) < 10)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%+.2f", 100 * error);
  return text;
}

void write_header(std::ostream& out, const ClosedForm& form) {
  out << "\n## " << form.name << "\n\n"
      << form.what << ": " << form.reference << ", wanted within " << 100 * form.tolerance << " % (" << form.source
      << "). Error in percent:\n\n| cells | substeps |";
  for (const uint32_t relaxation : kRelaxationSteps) out << ' ' << relaxation << " |";
  out << "\n|---|---|";
  for (std::size_t i = 0; i < std::size(kRelaxationSteps); ++i) out << "---|";
  out << '\n';
}

std::string table_of(const ClosedForm& form) {
  std::ostringstream out;
  write_header(out, form);
  for (const uint32_t cells : kCells) {
    for (const uint32_t substeps : kSubsteps) {
      out << "| " << cells << " | " << substeps << " |";
      for (const uint32_t relaxation : kRelaxationSteps) {
        const double measured = form.measure({cells, substeps, relaxation}, geocloth::test::make_cpu_solver);
        const double error = measured / form.reference - 1;
        const char* bold = std::abs(error) <= form.tolerance ? "**" : "";
        out << ' ' << bold << percent(error) << bold << " |";
      }
      out << '\n';
    }
  }
  std::cout << out.str() << std::flush;
  return out.str();
}

/// The sheet of tests/solver/stretch_test.cpp, 100 x 100 at 1 cm, after five seconds.
std::string stretch_table() {
  constexpr double kBalls[] = {0.1, 0.15, 0.2, 0.3};
  constexpr uint32_t kFrames = 300;
  std::ostringstream out;
  out << "\n## stretch\n\nA sheet of 100 x 100 points, 1 cm apart, that starts level and swings down about its pinned "
         "edge onto a ball: largest / mean stretch of its structural springs in percent after 5 s, by the ball's "
         "radius in "
         "sides; all springs projected fully, attachments of 0.05 %. NvCloth with tethers on its ball: 11.6 / 0.28 at "
         "8 "
         "substeps.\n\n| substeps |";
  for (const double ball : kBalls) out << ' ' << ball << " |";
  out << "\n|---|---|---|---|---|\n";
  for (const uint32_t substeps : {4U, 8U, 16U, 32U}) {
    out << "| " << substeps << " |";
    for (const double ball : kBalls) {
      const auto stretch = geocloth::test::stretch_of_swing({.substeps = substeps, .ball = ball}, kFrames);
      out << ' ' << percent(stretch.max - 1) << " / " << percent(stretch.mean - 1) << " |";
    }
    out << '\n';
  }
  std::cout << out.str() << std::flush;
  return out.str();
}

/// Pixels along the disc, with relaxation steps that are enough: what bending needs grows with their fourth power.
struct DrapeRow {
  uint32_t resolution, relaxation_steps;
};

std::string drape_table() {
  constexpr DrapeRow kRows[] = {{32, 4}, {64, 8}, {128, 32}};
  constexpr double kRigidities[] = {8e-5, 2e-5};  // [N m]
  std::ostringstream out;
  out << "\n## drape\n\nCusick's drape coefficient in percent after 75 frames of 32 substeps: a disc of 30 cm on one "
         "of "
         "18 cm, a sheet without grain, 50 N/m and 0.2 kg/m2; wanted within 3 points for one rigidity.\n\n| pixels | "
         "relaxation steps |";
  for (const double rigidity : kRigidities) out << ' ' << rigidity << " N m, panels | square |";
  out << "\n|---|---|---|---|---|---|\n";
  for (const DrapeRow& row : kRows) {
    out << "| " << row.resolution << " | " << row.relaxation_steps << " |";
    for (const double rigidity : kRigidities) {
      for (const auto layout : {geocloth::Layout::panels, geocloth::Layout::square}) {
        const auto drape = geocloth::test::drape(geocloth::test::make_specimen(row.resolution, layout),
                                                 geocloth::test::even_sheet(rigidity), {32, row.relaxation_steps, 75});
        char text[32];
        std::snprintf(text, sizeof text, " %.1f |", drape.coefficient);
        out << text;
        std::cerr << text << std::flush;
      }
    }
    out << '\n';
  }
  std::cout << out.str() << std::flush;
  return out.str();
}

/// Each grid begins as the coarser one hangs: what the folds that one grid chose are on a finer one.
std::string refined_drape_table() {
  struct Row {
    uint32_t resolution;
    geocloth::test::DrapeEffort limp, firm;
  };
  constexpr Row kRows[] = {{32, {32, 4, 75}, {32, 4, 75}},
                           {64, {80, 2, 30, 12}, {80, 2, 30, 12}},
                           {128, {80, 16, 30, 12}, {80, 32, 30, 12}},
                           {256, {80, 60, 24, 12}, {80, 220, 16, 12}}};
  std::ostringstream out;
  out << "\n## refined drape\n\nThe same, but only the first grid begins level; each finer one begins as the coarser "
         "one hangs, and settles under damping of 12 /s. In brackets: substeps x relaxation steps.\n\n"
         "| rigidity, layout |";
  for (const Row& row : kRows) out << ' ' << row.resolution << " |";
  out << "\n|---|---|---|---|---|\n";
  for (const double rigidity : {2e-5, 8e-5}) {
    for (const auto layout : {geocloth::Layout::panels, geocloth::Layout::square}) {
      out << "| " << rigidity << (layout == geocloth::Layout::panels ? " N m, panels |" : " N m, square |");
      geocloth::test::Draped hung;
      for (const Row& row : kRows) {
        const auto specimen = geocloth::test::make_specimen(row.resolution, layout);
        const auto material = geocloth::test::even_sheet(rigidity);
        const geocloth::test::DrapeEffort& effort = rigidity < 5e-5 ? row.limp : row.firm;
        hung = hung.specimen == nullptr ? geocloth::test::hang_level(specimen, material, effort)
                                        : geocloth::test::hang_on(hung, specimen, material, effort);
        char text[48];
        std::snprintf(text, sizeof text, " %.1f (%u x %u) |", geocloth::test::shadow_of(hung).coefficient,
                      effort.substeps, effort.relaxation_steps);
        out << text;
        std::cerr << text << std::flush;
      }
      out << '\n';
    }
  }
  std::cout << out.str() << std::flush;
  return out.str();
}

int run(const std::string& out, const std::string& name) {
  std::string text =
      "# Error against the closed forms\n\n"
      "Strips four points wide with square cells, on the cpu; columns are relaxation steps, substeps are those of a "
      "60 Hz frame. Bold: within what is wanted; -: more than ten times off. Made by `convergence_table " +
      out + "`.\n";
  for (const ClosedForm& form : geocloth::test::closed_forms()) {
    if (form.name.find(name) != std::string::npos) text += table_of(form);
  }
  if (std::string("stretch").find(name) != std::string::npos) text += stretch_table();
  if (std::string("drape").find(name) != std::string::npos) text += drape_table();
  if (std::string("refined drape").find(name) != std::string::npos) text += refined_drape_table();
  geocloth::write_file(out, text);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || argv[1][0] == '-') {
    std::cerr << "usage: convergence_table OUT.md [NAME]\n";
    return 2;
  }
  try {
    return run(argv[1], argc == 3 ? argv[2] : "");
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return EXIT_FAILURE;
  }
}
