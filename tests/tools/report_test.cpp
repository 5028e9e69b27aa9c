// SPDX-License-Identifier: GPL-3.0-or-later
// The page by which a technical artist judges a conversion.
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <regex>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/chart_labels.h"
#include "report/conversion_page.h"
#include "report/html.h"
#include "report/targets.h"
#include "support/make_sheet.h"

namespace geocloth {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// A conversion of a sheet in four panels with measures that meet every target.
ConvertResult good_result() {
  ConvertResult result;
  result.asset = test::make_sheet({.nx = 40, .ny = 40, .charts_x = 2, .charts_y = 2});
  result.asset.name = "shirt";
  result.asset.layout = Layout::panels;
  Quality& q = result.report.quality;
  q.l2_stretch = 1.001;
  q.symmetric_dirichlet = 4.01;
  q.anisotropy_p95 = 1.05;
  q.spring_min = q.spring_max = q.spring_p99_over_p1 = q.quad_area_p5 = q.quad_area_p95 = 1;
  q.psnr_db = 90;
  result.report.seconds = {{"import", 0.1}, {"total", 0.2}};
  return result;
}

Measure find_measure(const ConvertResult& result, const std::string& key) {
  for (const MeasureGroup& group : judge(result))
    for (const Measure& measure : group.measures)
      if (measure.key == key) return measure;
  ADD_FAILURE() << "no measure " << key;
  return {};
}

std::string page_of(const ConvertResult& result, const PagePictures& pictures = {}) {
  return conversion_page(result, pictures, "shirt.obj");
}

/// The first element that is not closed where it should be, or "".
std::string first_unbalanced(const std::string& html) {
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*>");
  std::vector<std::string> open;
  for (std::sregex_iterator it(html.begin(), html.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if (name == "meta" || name == "img") continue;
    if ((*it)[1].length() == 0) {
      open.push_back(name);
    } else {
      if (open.empty() || open.back() != name) return "</" + name + ">";
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

TEST(Targets, tell_met_from_near_and_missed) {
  ConvertResult result = good_result();
  EXPECT_EQ(find_measure(result, "l2_stretch").verdict, Verdict::met);
  result.report.quality.l2_stretch = 1.005;
  EXPECT_EQ(find_measure(result, "l2_stretch").verdict, Verdict::met);
  result.report.quality.l2_stretch = 1.01;
  EXPECT_EQ(find_measure(result, "l2_stretch").verdict, Verdict::near);
  result.report.quality.l2_stretch = 1.3;
  EXPECT_EQ(find_measure(result, "l2_stretch").verdict, Verdict::missed);
  result.report.quality.psnr_db = 60;  // where more is better
  EXPECT_EQ(find_measure(result, "psnr_db").verdict, Verdict::missed);
  result.report.quality.flipped = 1;  // there is no "nearly" for what must hold
  EXPECT_EQ(find_measure(result, "flipped").verdict, Verdict::missed);
  const Judgement sum = sum_up(judge(result));
  EXPECT_EQ(sum.worst, Verdict::missed);
  EXPECT_GE(sum.missed, 3U);
}

TEST(Targets, of_shape_are_not_asked_of_squares) {
  ConvertResult result = good_result();
  result.asset.layout = Layout::square;
  result.report.quality.anisotropy_p95 = 6;
  EXPECT_EQ(find_measure(result, "anisotropy_p95").verdict, Verdict::none);
  EXPECT_THAT(find_measure(result, "anisotropy_p95").target, IsEmpty());
  EXPECT_EQ(find_measure(result, "copy_gap").verdict, Verdict::met);
}

TEST(Page, says_what_came_out_without_need_of_colours) {
  ConvertResult result = good_result();
  EXPECT_THAT(page_of(result), HasSubstr("<h1>shirt</h1>"));
  result.report.quality.max_error = 3e-3;
  EXPECT_THAT(page_of(result), AllOf(HasSubstr("≈ near"), HasSubstr("at most 0.002")));
  result.report.quality.max_error = 0.1;
  EXPECT_THAT(page_of(result), AllOf(HasSubstr("Look closer"), HasSubstr("✗ missed")));
}

// What was taken for up decides how the panels lie, and was in the JSON alone: who got them askew learned of no remedy.
TEST(Page, tells_which_way_the_grain_runs) {
  ConvertResult result = good_result();
  EXPECT_THAT(page_of(result), HasSubstr("; grain along +y of the file (--up tells another)"));
  result.report.up = {0, 0, -1};
  EXPECT_THAT(page_of(result), HasSubstr("grain along -z of the file"));
  result.report.up = {0.6, 0, 0.8};
  EXPECT_THAT(page_of(result), HasSubstr("grain along (0.60, 0.00, 0.80) of the file"));
  result.asset.layout = Layout::square;  // which has no grain
  EXPECT_THAT(page_of(result), Not(HasSubstr("--up")));
}

TEST(Page, holds_warnings_repairs_carried_and_parts) {
  ConvertResult result = good_result();
  result.report.warnings = {"the sleeve is not developable"};
  result.report.repairs = {{"bow_ties", 7}, {"t_junctions", 0}};
  result.report.carried.push_back({.part = 3, .faces = 12, .area_share = 0.002, .why = "smaller than a pixel"});
  result.report.parts = {{"Hood", 100, 0.25, 0.125}, {"Body", 300, 0.75, 0}};
  const std::string page = page_of(result);
  EXPECT_THAT(page, HasSubstr("the sleeve is not developable"));
  EXPECT_THAT(page, AllOf(HasSubstr("bow ties"), Not(HasSubstr("t junctions"))));
  EXPECT_THAT(page, AllOf(HasSubstr("smaller than a pixel"), HasSubstr("0.2 %")));
  EXPECT_THAT(page, AllOf(HasSubstr("Hood"), HasSubstr("12.5 %")));
  EXPECT_LT(page.find("Body"), page.find("Hood"));  // the largest first
}

TEST(Page, keeps_hostile_names_as_text) {
  ConvertResult result = good_result();
  const std::string evil = "</title><script>alert('\"&\xff\xfe\x01')</script>";
  result.asset.name = evil;
  result.report.warnings = {evil};
  result.report.parts = {{evil, 1, 0.5, 0}, {"plain", 1, 0.5, 0}};
  result.report.carried.push_back({.part = 0, .faces = 1, .area_share = 0, .why = evil});
  result.report.repairs = {{evil, 1}};
  const std::string page = conversion_page(result, {{}, evil}, evil);
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("\xff")), Not(HasSubstr("\x01"))));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(&#39;&quot;&amp;"));
  EXPECT_EQ(first_unbalanced(page), "");
}

TEST(Page, needs_nothing_from_elsewhere) {
  // No loader finds a driver from here on: the page has to do without pictures of the model, and to say so.
  setenv("VK_DRIVER_FILES", "/nowhere", 1);
  setenv("VK_ICD_FILENAMES", "/nowhere", 1);
  const ConvertResult result = good_result();
  const PagePictures pictures = draw_page_pictures(std::make_shared<const ClothAsset>(result.asset));
  unsetenv("VK_DRIVER_FILES");
  unsetenv("VK_ICD_FILENAMES");
  EXPECT_THAT(pictures.pictures, SizeIs(3));
  const std::string page = page_of(result, pictures);
  EXPECT_THAT(page, HasSubstr("There is no picture of the garment itself: pictures need a Vulkan device"));
  EXPECT_THAT(page, AllOf(Not(HasSubstr("http")), Not(HasSubstr("url(")), Not(HasSubstr("<link"))));
  const std::regex source("src=\"([a-z/:]*)"), picture("<img alt=\"[^\"]{20,}\" width=\"[0-9]+\" height=\"[0-9]+\"");
  std::ptrdiff_t sources = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), source), end; it != end; ++it, ++sources)
    EXPECT_EQ((*it)[1], "data:image/png");
  EXPECT_EQ(sources, 3);
  EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), picture), {}), 3);
}

TEST(Html, writes_bytes_as_base64) {
  const auto encoded = [](std::string_view text) { return base64(std::as_bytes(std::span(text))); };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

TEST(ChartLabels, stand_where_the_chart_is_widest) {
  const ClothAsset asset = test::make_sheet({.nx = 41, .ny = 21});
  const std::vector<ChartLabel> numbers = chart_numbers(asset);
  ASSERT_THAT(numbers, SizeIs(1));
  EXPECT_EQ(numbers[0].text, "1");
  EXPECT_EQ(numbers[0].y, 10U);
  EXPECT_EQ(numbers[0].room, 10U);
}

TEST(ChartLabels, give_both_sides_of_a_seam_the_same_letter) {
  const ClothAsset asset = test::make_sheet({.nx = 41, .ny = 21, .charts_x = 2});
  const SeamLines lines = find_seam_lines(asset);
  const std::vector<ChartLabel> letters = seam_letters(asset, lines, 6);
  ASSERT_THAT(letters, SizeIs(2));
  EXPECT_EQ(letters[0].text, letters[1].text);
  const auto chart = [&](const ChartLabel& label) { return asset.chart[label.y * asset.width + label.x]; };
  EXPECT_NE(chart(letters[0]), chart(letters[1]));
  EXPECT_GT(letters[0].room, 1U);  // clear of the outline
  EXPECT_THAT(seam_letters(asset, lines, 100), IsEmpty());
}

}  // namespace
}  // namespace geocloth
