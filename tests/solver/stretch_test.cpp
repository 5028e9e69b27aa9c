// SPDX-License-Identifier: GPL-3.0-or-later
// How far cloth that hangs is stretched, with as few substeps as games can pay: where NvCloth with tethers at the same
// work was measured to stretch the sheet by 11.6 % at most. Its scene does not tell the ball, so every ball has to do.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/solver/scene.h"
#include "lib/span.h"
#include "rest/short_seams.h"
#include "rest/upload.h"
#include "solver_fixture.h"
#include "support/swing.h"

namespace geocloth {
namespace {

constexpr uint32_t kFiveSeconds = 300;

class Ball : public ::testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Ball, StretchesASheetByLessThanNvClothAtEightSubsteps) {
  const auto [ball, behind] = GetParam();
  const StretchStatistics stretch = test::stretch_of_swing({.ball = ball, .behind = behind}, kFiveSeconds);
  RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
  RecordProperty("mean_percent", std::to_string(100 * (stretch.mean - 1)));
  EXPECT_LE(stretch.max, 1.11);
  EXPECT_LE(stretch.p99, 1.045);
  EXPECT_LE(stretch.mean, 1.0028);
}

INSTANTIATE_TEST_SUITE_P(Swing, Ball,
                         ::testing::Values(std::pair{0.1, 0.0}, std::pair{0.15, 0.0}, std::pair{0.2, 0.0},
                                           std::pair{0.3, 0.0}, std::pair{0.15, -0.1}, std::pair{0.15, 0.1},
                                           std::pair{0.25, 0.15}));

// Without ties single springs in sharp folds were stretched by 14 % on the smallest and the largest ball.
TEST(Swing, SixteenSubstepsHalveIt) {
  for (const double ball : {0.1, 0.15, 0.2, 0.25, 0.3}) {
    const StretchStatistics stretch = test::stretch_of_swing({.substeps = 16, .ball = ball}, kFiveSeconds);
    RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
    EXPECT_LE(stretch.max, 1.05) << ball;
    EXPECT_LE(stretch.mean, 1.0028) << ball;
  }
}

// The worst case: two seams cross where the ball presses. Where spans ended at seams it was 18 %.
TEST(Swing, CutIntoChartsItStretchesNoMore) {
  for (const uint32_t charts : {2U, 4U}) {
    const StretchStatistics stretch = test::stretch_of_swing({.charts = charts}, kFiveSeconds);
    RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
    EXPECT_LE(stretch.max, 1.11) << charts;
    EXPECT_LE(stretch.mean, 1.0028) << charts;
  }
}

// Spans, attachments and contacts take energy and give none, at any number of substeps.
TEST(Swing, OntoABallGainsNoEnergy) {
  for (const uint32_t substeps : {8U, 16U, 60U}) {
    test::SwingScene scene = test::make_swing({.points = 33, .substeps = substeps, .ball = 0.2});
    double highest = -1;
    for (uint32_t f = 0; f < 120; ++f) {
      scene.solver.step();
      const Energy e = measure_energy(scene.cloth, {0, -9.81F, 0}, test::positions_of(scene.solver),
                                      test::velocities_of(scene.solver));
      highest = std::max(highest, e.kinetic + e.potential);
    }
    EXPECT_LE(highest, 0.0) << substeps;
  }
}

/// What the list over seams has of `count` colours.
std::vector<shader::SeamSpring> springs_of(const ClothData& data, uint32_t first_color, uint32_t count) {
  if (count == 0) return {};
  const auto springs = data.seam_springs.begin();
  return {springs + data.seam_color_offset[first_color], springs + data.seam_color_offset[first_color + count]};
}

// Every row that a seam cuts has a span over the seam in all of its seven places, as long as those within a chart.
TEST(Spans, GoOnOverASeam) {
  const ClothDesc cloth{
      std::make_shared<const ClothAsset>(test::make_sheet({.nx = 41, .ny = 30, .charts_x = 2})), {}, {}};
  const ClothData data = make_cloth_data(cloth, {});
  ASSERT_EQ(data.seam_span_colors, 1U);
  const std::vector<shader::SeamSpring> spans = springs_of(data, data.seam_bend_colors, 1);
  EXPECT_EQ(spans.size(), 30U * (shader::kSpanPixels - 1));
  for (const shader::SeamSpring& span : spans) {
    EXPECT_NEAR(span.rest, shader::kSpanPixels / 40.0, 1e-6);
    EXPECT_NEAR(length(cloth.asset->rest_position[span.a] - cloth.asset->rest_position[span.b]), span.rest, 1e-6);
  }
}

// A spring along a seam that only one side has pulls only that side's copies: the other ones are tied too.
TEST(Ties, JoinTheCopiesThatNoSpringJoins) {
  constexpr uint32_t kSide = 17;
  ClothAsset asset = test::make_sheet({.nx = kSide, .ny = kSide, .charts_x = 2});
  const auto ties_of = [](const ClothAsset& sheet) {
    const ClothData data = make_cloth_data({std::make_shared<const ClothAsset>(sheet), {}, {}}, {});
    return springs_of(data, data.seam_bend_colors + data.seam_span_colors, data.seam_tie_colors);
  };
  EXPECT_TRUE(ties_of(asset).empty());
  uint32_t taken = 0;
  for (uint32_t r = 0; r < asset.splits.rows(); ++r) {
    uint8_t& springs = asset.spring_mask[asset.splits.pixel[asset.splits.offset[r]]];
    taken += (springs & kSpringDown) != 0 ? 1 : 0;
    springs = static_cast<uint8_t>(springs & ~kSpringDown);
  }
  EXPECT_EQ(taken, kSide - 1);
  const std::vector<shader::SeamSpring> ties = ties_of(asset);
  EXPECT_EQ(ties.size(), taken);
  for (const shader::SeamSpring& tie : ties) {
    EXPECT_NEAR(tie.rest, 1.0 / (kSide - 1), 1e-6);
    EXPECT_EQ(asset.chart[tie.a], asset.chart[tie.b]);
    EXPECT_EQ(asset.spring_mask[std::min(tie.a, tie.b)] & kSpringDown, 0);
  }
}

/// A sheet in four charts, one below the other, whose seams run close to the row above.
ClothAsset with_short_springs_at_seams(double share) {
  ClothAsset asset = test::make_sheet({.nx = 49, .ny = 49, .charts_y = 4, .horizontal = true});
  const auto s = static_cast<float>(share);
  for (const uint32_t p : asset.splits.pixel) {
    asset.rest_position[p].z -= (1 - s) * asset.spacing;
    const bool upper = asset.valid(p - asset.width);  // of the two copies, that of the chart above
    asset.area[p] *= upper ? s : 2 - s;
    asset.area[upper ? p - asset.width : p + asset.width] *= 0.5F * (upper ? 1 + s : 3 - s);
  }
  return asset;
}

/// The same, sewn in every tenth point of its seams only, as a mesh with cracks is.
ClothAsset with_lone_points() {
  ClothAsset asset = with_short_springs_at_seams(0.75);
  SplitVertexTable lone;
  lone.offset.push_back(0);
  for (uint32_t r = 0; r < asset.splits.rows(); r += 10) {
    for (uint32_t k = asset.splits.offset[r]; k < asset.splits.offset[r + 1]; ++k)
      lone.pixel.push_back(asset.splits.pixel[k]);
    lone.offset.push_back(static_cast<uint32_t>(lone.pixel.size()));
  }
  asset.splits = lone;
  return asset;
}

/// The largest stretch in each frame of two seconds of what falls. @param held  a vertex group
std::vector<double> largest_stretches(ClothAsset asset, const char* held) {
  ClothDesc cloth;
  cloth.asset = std::make_shared<const ClothAsset>(std::move(asset));
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.substeps = 16;
  Solver solver({&cloth, 1}, settings);
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, held));
  std::vector<Vec3> positions;
  std::vector<double> largest;
  for (uint32_t f = 0; f < 120; ++f) {
    solver.step();
    solver.read_positions(0, positions);
    largest.push_back(measure_stretch(*cloth.asset, 1, positions).max);
  }
  return largest;
}

// Short springs at seams join points of which one side's copy is light: what a tie moved of it, the stitch took back
// from, and they were stretched by 34 % while the sheet fell and by 13 % in the end.
TEST(WholeTies, HoldShortSpringsAtSeams) {
  const std::vector<double> largest = largest_stretches(with_short_springs_at_seams(0.3), "corners");
  for (size_t f = 0; f < largest.size(); ++f) EXPECT_LE(largest[f], 1.15) << "frame " << f;
  EXPECT_LE(largest.back(), 1.06);
}

// Few springs carry what hangs on a lone point: they were stretched by 20 % while the sheet fell.
TEST(WholeTies, HoldWhatHangsOnLonePoints) {
  const std::vector<double> largest = largest_stretches(with_lone_points(), "top");
  for (size_t f = 0; f < largest.size(); ++f) EXPECT_LE(largest[f], 1.15) << "frame " << f;
  RecordProperty("largest", std::to_string(*std::max_element(largest.begin(), largest.end())));
}

/// Four panels below each other, each sewn to the next one in two points that lie beside each other, to the left and to
/// the right in turns.
ClothAsset hung_by_short_seams() {
  constexpr uint32_t kSide = 49;
  ClothAsset asset = test::make_sheet({.nx = kSide, .ny = kSide, .charts_y = 4, .horizontal = true});
  SplitVertexTable few;
  few.offset.push_back(0);
  for (uint32_t r = 0; r < asset.splits.rows(); ++r) {
    const uint32_t seam = r / kSide, first = seam % 2 == 0 ? kSide / 3 : 2 * kSide / 3;
    if (r % kSide != first && r % kSide != first + 1) continue;
    for (uint32_t k = asset.splits.offset[r]; k < asset.splits.offset[r + 1]; ++k)
      few.pixel.push_back(asset.splits.pixel[k]);
    few.offset.push_back(static_cast<uint32_t>(few.pixel.size()));
  }
  asset.splits = few;
  std::erase_if(asset.seam_bends, [&](const SeamBend& bend) {
    return std::find(few.pixel.begin(), few.pixel.end(), bend.middle) == few.pixel.end();
  });
  return asset;
}

// The way to the pins bends at such points, so attachments are slack, and the few springs about them carry all that
// hangs below: they were stretched by 60 % while the panels fell and by 16 % in the end.
TEST(ShortSeams, CarryWhatHangsOnThem) {
  const std::vector<double> largest = largest_stretches(hung_by_short_seams(), "top");
  RecordProperty("largest", std::to_string(*std::max_element(largest.begin(), largest.end())));
  EXPECT_LE(*std::max_element(largest.begin(), largest.end()), 1.15);
  EXPECT_LE(largest.back(), 1.08);
}

// No span through a point holds its ends nearer than they are along the cloth, and long seams have none.
TEST(ShortSeams, HaveSpansThroughTheirPoints) {
  const ClothAsset asset = hung_by_short_seams();
  const std::vector<bool> short_seams = pixels_of_short_seams(asset);
  EXPECT_EQ(static_cast<size_t>(std::count(short_seams.begin(), short_seams.end(), true)), asset.splits.pixel.size());
  const std::vector<shader::SeamSpring> spans = spans_through_short_seams(asset, 2, short_seams);
  EXPECT_GE(spans.size(), 6U * (shader::kSpanPixels - 1));
  EXPECT_LE(spans.size(), most_spans_through_short_seams(asset, short_seams));
  for (const shader::SeamSpring& span : spans) {
    EXPECT_NE(asset.chart[span.a], asset.chart[span.b]);
    EXPECT_GE(span.rest * 1.0001F, 2 * length(asset.rest_position[span.a] - asset.rest_position[span.b]));
  }
  const ClothAsset sewn = test::make_sheet({.nx = 20, .ny = 20, .charts_x = 2, .charts_y = 2});
  const std::vector<bool> none = pixels_of_short_seams(sewn);
  EXPECT_EQ(std::count(none.begin(), none.end(), true), 0);
}

// Each joins whole points and is there once, whatever copies its spring joins; those of a colour share no point.
TEST(WholeTies, AreTheSpringsAtSeams) {
  const ClothAsset asset = with_short_springs_at_seams(0.3);
  const ClothData data = make_cloth_data({std::make_shared<const ClothAsset>(asset), {}, {}}, {});
  const uint32_t first = data.seam_bend_colors + data.seam_span_colors + data.seam_tie_colors;
  size_t ties = 0, short_ties = 0;
  for (uint32_t color = first; color < first + data.whole_tie_colors; ++color) {
    std::set<uint32_t> seen;
    for (uint32_t k = data.seam_color_offset[color]; k < data.seam_color_offset[color + 1]; ++k, ++ties) {
      const shader::SeamSpring& tie = data.seam_springs[k];
      EXPECT_NEAR(tie.rest, length(asset.rest_position[tie.a] - asset.rest_position[tie.b]), 1e-6);
      if (std::abs(tie.rest - 0.3F * asset.spacing) < 1e-5F) ++short_ties;
      EXPECT_TRUE(seen.insert(tie.a).second && seen.insert(tie.b).second);
      for (const auto& [pixel, row] : {std::pair{tie.a, tie.row_a}, std::pair{tie.b, tie.row_b}}) {
        const auto& copies = asset.splits.pixel;
        const auto place = std::find(copies.begin(), copies.end(), pixel) - copies.begin();
        const bool is_copy = place < std::ssize(copies);
        ASSERT_EQ(is_copy, row != shader::kNoRow);
        if (is_copy) {
          EXPECT_EQ(asset.splits.offset[row], place);
        }
      }
    }
  }
  EXPECT_EQ(short_ties, 3U * 49U);
  EXPECT_EQ(ties, 3U * (48U + 2U * 49U));  // of three seams, those along them and those to both sides
}

// The automatic limit knew the cloth's weight only: a knit on a frame bulged by 6 cm without gravity, by 18 cm with it,
// and by 40 cm where nothing but its springs held it.
TEST(Attachments, LeaveAKnitToTheWindWithGravityAndWithout) {
  const auto bulge_of = [](float gravity, float max_stretch) {
    const ClothAsset asset = test::make_sheet({.nx = 33, .ny = 33, .horizontal = true});
    ClothDesc cloth = test::describe(asset, find_material_preset("interlock_knit")->material);
    cloth.material.max_stretch = max_stretch;
    SolverSettings settings = test::cpu_settings();
    settings.substeps = 16;
    settings.gravity = {0, -gravity, 0};
    Solver solver(std::vector{cloth}, settings);
    std::vector<Pin> pins;
    for (const char* edge : {"top", "bottom", "left", "right"}) {
      const std::vector<Pin> of_edge = test::pins_at_rest(asset, edge);
      pins.insert(pins.end(), of_edge.begin(), of_edge.end());
    }
    solver.set_pins(0, pins);
    solver.set_wind(Wind{.velocity = {0, 8, 0}});
    test::run(solver, 60);
    float highest = 0;
    for (const Vec3& p : test::positions_of(solver)) highest = std::max(highest, p.y);
    return static_cast<double>(highest);
  };
  const double with = bulge_of(9.81F, -1), without = bulge_of(0, -1), springs = bulge_of(0, 0);
  RecordProperty("bulges", std::to_string(with) + ' ' + std::to_string(without) + ' ' + std::to_string(springs));
  EXPECT_NEAR(without, with, 0.05 * with);
  EXPECT_GT(without, 0.7 * springs);
}

// A cloth that lies over a ball without a pin has no attachments.
TEST(Spans, HoldClothWithoutPins) {
  const auto stretch_of = [](float max_stretch) {
    ClothDesc cloth;
    cloth.asset = std::make_shared<const ClothAsset>(
        test::make_sheet({.nx = 71, .ny = 71, .width = 0.7F, .height = 0.7F, .charts_x = 2, .horizontal = true}));
    cloth.material = find_material_preset("cotton")->material;
    cloth.material.max_stretch = max_stretch;
    SolverSettings settings;
    settings.backend = Backend::cpu;
    settings.substeps = 8;
    Solver solver({&cloth, 1}, settings);
    solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, -0.15F, 0}, 0.12F}, 1.F, {}}});
    test::run(solver, 60);
    return measure_stretch(*cloth.asset, 1, test::positions_of(solver));
  };
  const StretchStatistics with = stretch_of(-1), without = stretch_of(0);
  RecordProperty("with", std::to_string(with.p99) + ' ' + std::to_string(with.mean));
  RecordProperty("without", std::to_string(without.p99) + ' ' + std::to_string(without.mean));
  EXPECT_LT(with.p99 - 1, 0.7 * (without.p99 - 1));
  EXPECT_LT(with.mean - 1, 0.7 * (without.mean - 1));
}

/// [m] Where cloth that lies on a collider has its middle after each of some times [s].
std::vector<Vec3> middles(const test::SheetOptions& sheet, const Collider& collider, double rate, uint32_t substeps,
                          std::initializer_list<double> times) {
  ClothDesc cloth;
  cloth.asset = std::make_shared<const ClothAsset>(test::make_sheet(sheet));
  cloth.material = find_material_preset("cotton")->material;
  SolverSettings settings = test::cpu_settings();
  settings.frame_time = 1 / rate;
  settings.substeps = substeps;
  Solver solver({&cloth, 1}, settings);
  solver.set_colliders(std::vector{collider});
  std::vector<Vec3> middles;
  uint32_t frame = 0;
  for (const double time : times) {
    for (; frame < static_cast<uint32_t>(std::lround(time * rate)); ++frame) solver.step();
    Vec3 sum;
    for (const Vec3& p : test::positions_of(solver)) sum = sum + p;
    middles.push_back((1.F / static_cast<float>(cloth.asset->pixel_count())) * sum);
  }
  return middles;
}

// A frame's ties pull what hangs on both sides of a ball, the farther the longer the substeps are, and moved what lies
// on it along without friction: a square metre crept over the ball and fell off within ten seconds.
TEST(Ties, LeaveWhatHangsOverABallToFriction) {
  const Collider ball{"ball", Sphere{{-0.08F, -0.202F, 0}, 0.2F}, 0.3F, {}};
  for (const auto& [rate, substeps] : {std::pair{60.0, 8U}, {60.0, 4U}, {24.0, 16U}}) {
    const std::vector<Vec3> x =
        middles({.nx = 64, .ny = 64, .charts_x = 2, .horizontal = true}, ball, rate, substeps, {5, 10});
    EXPECT_LT(std::abs(x[1].x - x[0].x), 0.002) << rate << " frames a second, " << substeps << " substeps";
    EXPECT_LT(std::abs(x[1].y - x[0].y), 0.001) << rate << " frames a second, " << substeps << " substeps";
  }
}

// A towel over a bar whose sides are 10 % longer and shorter than the mean, much less than what friction holds (the
// capstan's equation), went down by 12 mm a second.
TEST(Ties, LeaveATowelOnABarToFriction) {
  const Collider bar{"bar", Capsule{{0, -0.102F, -1}, {0, -0.102F, 1}, 0.1F, 0.1F}, 0.3F, {}};
  for (const auto& [rate, substeps] : {std::pair{60.0, 8U}, {24.0, 8U}, {30.0, 16U}}) {
    const test::SheetOptions towel{
        .nx = 51, .ny = 16, .width = 1, .height = 0.3F, .horizontal = true, .center = {0.04F, 0, 0}};
    const std::vector<Vec3> x = middles(towel, bar, rate, substeps, {10, 15});
    EXPECT_LT(std::abs(x[1].x - x[0].x), 0.001) << rate << " frames a second, " << substeps << " substeps";
    EXPECT_LT(std::abs(x[1].y - x[0].y), 0.001) << rate << " frames a second, " << substeps << " substeps";
  }
}

// Attachments run straight to the pins, past the bow that the cloth hangs in: without spans a spring beside a pin was
// 3 % too long here, and 21 % in a strip of 5 cm.
TEST(Spans, HoldClothThatSagsBetweenItsPins) {
  constexpr float kLength = 0.5F, kSpan = kLength / 1.25F;
  for (const uint32_t charts : {1U, 2U}) {
    const test::SheetOptions options{
        .nx = 61, .ny = 8, .width = kLength, .height = 0.06F, .charts_x = charts, .horizontal = true};
    ClothDesc cloth = test::describe(test::make_sheet(options));
    cloth.material.stretch_warp = cloth.material.stretch_weft = 2000;
    cloth.material.bend_warp = cloth.material.bend_weft = 1e-9F;
    cloth.material.damping = 4;
    SolverSettings settings;
    settings.backend = Backend::cpu;
    Solver solver({&cloth, 1}, settings);
    for (uint32_t frame = 1; frame <= 300; ++frame) {
      const float in = 0.5F * (kLength - kSpan) * std::min(1.F, static_cast<float>(frame) / 60);
      std::vector<Pin> pins = test::pins_at_rest(*cloth.asset, "left", {in, 0, 0});
      std::ranges::copy(test::pins_at_rest(*cloth.asset, "right", {-in, 0, 0}), std::back_inserter(pins));
      solver.set_pins(0, pins);
      solver.step();
    }
    const std::vector<Vec3> x = test::positions_of(solver);
    EXPECT_LT(measure_stretch(*cloth.asset, 1, x).max, 1.02) << charts;
    float lowest = 0;
    for (uint32_t p = 0; p < x.size(); ++p)
      if (cloth.asset->valid(p)) lowest = std::min(lowest, x[p].y);
    EXPECT_NEAR(-lowest / kSpan, 0.3318, 0.015 * 0.3318) << charts;  // catenary
  }
}

// A sheet that hangs by two corners is attached to them straight through what lies about them, which few springs hold:
// they were stretched by 18 % here and by 66 % in a finer sheet, unless there was a collider somewhere, for which cloth
// has spans, too.
TEST(Spans, HoldWhatHangsByItsCorners) {
  const std::vector<double> largest =
      largest_stretches(test::make_sheet({.nx = 97, .ny = 97, .horizontal = true}), "corners");
  RecordProperty("largest", std::to_string(*std::max_element(largest.begin(), largest.end())));
  RecordProperty("last", std::to_string(largest.back()));
  EXPECT_LE(largest.back(), 1.04);
}

TEST(Spans, AreTheSameOnEveryPath) {
  for (const bool pinned : {true, false}) {
    for (const uint32_t charts : {1U, 2U}) {
      for (const uint32_t relaxation_steps : {1U, 2U}) {
        test::Swing swing{.points = 61, .charts = charts, .relaxation_steps = relaxation_steps, .pinned = pinned};
        swing.behind = pinned ? 0 : 0.4;
        test::SwingScene swept = test::make_swing(swing);
        swing.path = SolverPath::plain;
        test::SwingScene plain = test::make_swing(swing);
        for (test::SwingScene* scene : {&swept, &plain}) test::run(scene->solver, 40);
        EXPECT_EQ(hash_state(*swept.cloth.asset, test::positions_of(swept.solver)),
                  hash_state(*plain.cloth.asset, test::positions_of(plain.solver)))
            << charts << ' ' << relaxation_steps << (pinned ? "" : ", without pins");
      }
    }
  }
}

/// A flag of 1.2 m x 0.8 m in measured cotton, pinned along one side, in a wind of 10 m/s with gusts.
struct Flag {
  float scale = 1;
  uint32_t charts = 1;
  bool wind = true;
  bool pole = false;  ///< thinner than the distance of the pixels: triangles meet it
  SolverPath path = SolverPath::automatic;
};

struct FlagScene {
  ClothDesc cloth;
  Solver solver;
};

FlagScene make_flag(const Flag& flag) {
  ClothDesc cloth;
  cloth.asset = std::make_shared<const ClothAsset>(test::make_sheet(
      {.nx = 73, .ny = 49, .width = 1.2F * flag.scale, .height = 0.8F * flag.scale, .charts_x = flag.charts}));
  cloth.material = find_material_preset("cotton")->material;
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.path = flag.path;
  settings.substeps = 16;
  FlagScene scene{cloth, Solver({&cloth, 1}, settings)};
  scene.solver.set_pins(0, test::pins_at_rest(*cloth.asset, "left"));
  if (flag.pole) {
    const Collider pole{"pole", Capsule{{-0.62F, -1, 0}, {-0.62F, 1, 0}, 0.015F, 0.015F}, 0.3F, {}};
    scene.solver.set_colliders(std::vector{pole}, true);
  }
  if (flag.wind) {
    scene.solver.set_wind({.velocity = {10, 0, 1}, .turbulence = 1, .frequency = 2, .drag = 1, .lift = 0.5F});
  }
  return scene;
}

/// Largest of two seconds, frame by frame.
StretchStatistics worst_of(const Flag& flag) {
  FlagScene scene = make_flag(flag);
  StretchStatistics worst;
  for (int f = 0; f < 120; ++f) {
    scene.solver.step();
    const StretchStatistics now = measure_stretch(*scene.cloth.asset, 1, test::positions_of(scene.solver));
    worst.max = std::max(worst.max, now.max);
    worst.p99 = std::max(worst.p99, now.p99);
  }
  ::testing::Test::RecordProperty("worst", std::to_string(worst.max) + ' ' + std::to_string(worst.p99));
  return worst;
}

// Attachments alone leave a flag that flies at right angles to its pole 64 % too long, one spring in a hundred 41 %;
// and where the pole was thinner than a cell nothing ended a frame (26 and 19 %).
TEST(Flag, IsHardlyStretchedByWind) {
  for (const bool pole : {false, true}) {
    for (const uint32_t charts : {1U, 2U}) {
      const StretchStatistics worst = worst_of({.charts = charts, .pole = pole});
      EXPECT_LE(worst.max, 1.15) << charts << (pole ? " with a pole" : "");
      EXPECT_LE(worst.p99, 1.08) << charts << (pole ? " with a pole" : "");
    }
  }
}

// A doll's flag falls from its side: springs of 1.7 mm were 2.7 times as long as at rest, one in a hundred 1.6 times.
TEST(Flag, OfADollHangsByItsSide) {
  const StretchStatistics worst = worst_of({.scale = 0.1F, .wind = false});
  EXPECT_LE(worst.max, 1.3);
  EXPECT_LE(worst.p99, 1.08);
}

// What lies near the pole is left as it is at the end of a frame.
TEST(Flag, AtAThinPoleIsTheSameOnEveryPath) {
  for (const uint32_t charts : {1U, 2U}) {
    FlagScene swept = make_flag({.charts = charts, .pole = true});
    FlagScene plain = make_flag({.charts = charts, .pole = true, .path = SolverPath::plain});
    for (FlagScene* scene : {&swept, &plain}) test::run(scene->solver, 30);
    EXPECT_EQ(hash_state(*swept.cloth.asset, test::positions_of(swept.solver)),
              hash_state(*plain.cloth.asset, test::positions_of(plain.solver)))
        << charts;
  }
}

}  // namespace
}  // namespace geocloth
