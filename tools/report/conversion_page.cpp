// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a conversion as a page of HTML, from the top: what came out, what to know of it, how it looks, how it
// measures, what was done to the mesh. No meaning is in a colour alone, and nothing is fetched from elsewhere.
#include "report/conversion_page.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "report/html.h"
#include "report/page_style.h"
#include "report/targets.h"

namespace geocloth {
namespace {

std::string counted(uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string percent(double share) {
  return fmt::format("{:.3g} %", 100 * share);
}

/// Sign and word of a verdict, so that its colour is not needed.
std::string badge(Verdict verdict) {
  switch (verdict) {
    case Verdict::met:
      return R"(<span class="badge met">✓ met</span>)";
    case Verdict::near:
      return R"(<span class="badge near">≈ near</span>)";
    case Verdict::missed:
      return R"(<span class="badge missed">✗ missed</span>)";
    case Verdict::none:
      break;
  }
  return R"(<span class="badge none">–</span>)";
}

std::string table(std::string_view caption, const std::vector<std::string>& head, const std::string& body,
                  std::string_view style = "plain") {
  std::string text =
      fmt::format("<div class=\"scroll\"><table class=\"{}\">\n<caption>{}</caption>\n<thead><tr>", style, caption);
  for (const std::string& column : head) text += fmt::format("<th scope=\"col\">{}</th>", column);
  return text + "</tr></thead>\n<tbody>\n" + body + "</tbody>\n</table></div>\n";
}

std::string section(std::string_view id, std::string_view title, const std::string& body) {
  return fmt::format("<section aria-labelledby=\"{0}\">\n<h2 id=\"{0}\">{1}</h2>\n{2}</section>\n", id, title, body);
}

// ------------------------------------------------------------------------------------------------ from the top

std::string verdict_line(const Judgement& sum) {
  const std::size_t met = sum.with_target - sum.near - sum.missed;
  if (sum.worst == Verdict::met) {
    return fmt::format(R"(<p class="verdict met"><strong>✓ Good.</strong> All {} targets are met.</p>)", met);
  }
  const bool near = sum.worst == Verdict::near;
  return fmt::format(R"(<p class="verdict {}"><strong>{}</strong> {} of {} targets are met, {} nearly, {} missed.</p>)",
                     near ? "near" : "missed", near ? "≈ Nearly good." : "✗ Look closer.", met, sum.with_target,
                     sum.near, sum.missed);
}

/// "+y", or the three coordinates of a direction that is no axis.
std::string in_words(const Point3& direction) {
  constexpr double kAlong = 0.9999;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) > kAlong) return fmt::format("{}{}", direction[k] < 0 ? '-' : '+', "xyz"[k]);
  }
  const auto rounded = [&](std::size_t k) { return std::round(100 * direction[k]) / 100 + 0.0; };  // no -0.00
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", rounded(0), rounded(1), rounded(2));
}

/// Only the grain of panels follows what was taken for up.
std::string grain(const ConvertResult& result) {
  if (result.asset.layout != Layout::panels) return {};
  return fmt::format("; grain along {} of the file (--up tells another)", in_words(result.report.up));
}

std::string header(const ConvertResult& result, const std::string& source, const Judgement& sum) {
  const ClothAsset& asset = result.asset;
  const ConvertReport& report = result.report;
  const std::string charts = asset.layout == Layout::square ? counted(asset.chart_count, "square", "squares")
                                                            : counted(asset.chart_count, "panel", "panels");
  const std::vector<std::pair<std::string_view, std::string>> facts{
      {"Made from", fmt::format("<span class=\"file\">{}</span>, {}", escape_html(source),
                                counted(report.source_faces, "face", "faces"))},
      {"Geometry image",
       fmt::format("{} × {} pixels, {} of them cloth", asset.width, asset.height, count_valid_pixels(asset))},
      {"Layout", fmt::format("{}, {}{}", to_string(asset.layout), charts, grain(result))},
      {"Spring length", fmt::format("{:.4g} mm", 1000 * double{asset.spacing})},
      {"Size", fmt::format("{:.3g} m across", report.cleaned_bbox_diagonal)}};
  std::string text =
      fmt::format("<header>\n<h1>{}</h1>\n{}\n<dl class=\"facts\">\n", escape_html(asset.name), verdict_line(sum));
  for (const auto& [name, value] : facts) text += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, value);
  return text + "</dl>\n</header>\n";
}

std::string warnings_section(const ConvertReport& report) {
  if (report.warnings.empty()) return section("know", "What to know", "<p>Nothing unusual.</p>\n");
  std::string list = "<ul class=\"warnings\">\n";
  for (const std::string& warning : report.warnings) list += fmt::format("<li>{}</li>\n", escape_html(warning));
  return section("know", "What to know", list + "</ul>\n");
}

std::string pictures_section(const PagePictures& pictures) {
  std::string text;
  if (!pictures.note.empty()) {
    text += fmt::format("<p class=\"note\">There is no picture of the garment itself: {}</p>\n",
                        escape_html(pictures.note));
  }
  text += "<div class=\"pictures\">\n";
  for (const PagePicture& picture : pictures.pictures) {
    text += fmt::format(
        "<figure{}>\n<figcaption><strong>{}.</strong> {}</figcaption>\n"
        "<img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\">\n</figure>\n",
        picture.wide ? " class=\"wide\"" : "", escape_html(picture.title), escape_html(picture.caption),
        escape_html(picture.alt), picture.width, picture.height, base64(picture.png));
  }
  return section("look", "How it looks", text + "</div>\n");
}

std::string measures_section(const std::vector<MeasureGroup>& groups, Layout layout) {
  std::string text =
      layout == Layout::square
          ? "<p>A square keeps neither lengths nor angles, so measures of shape and springs have no target here.</p>\n"
          : "<p>The targets are for garments that can be laid flat, at about 17,000 pixels.</p>\n";
  for (const MeasureGroup& group : groups) {
    std::string rows;
    for (const Measure& m : group.measures) {
      rows += fmt::format(
          "<tr><th scope=\"row\">{}<small>{}</small></th><td class=\"number\">{}</td><td class=\"number\">{}</td>"
          "<td>{}</td></tr>\n",
          escape_html(m.title), escape_html(m.meaning), escape_html(m.value), escape_html(m.target), badge(m.verdict));
    }
    text += table(group.title, {"Measure", "Value", "Target", "Verdict"}, rows, "measures");
  }
  return section("measures", "How it measures", text);
}

// --------------------------------------------------------------------------------------------- what was done to it

std::string surface_section(const ConvertReport& report) {
  std::string rows;
  const auto row = [&](std::string_view name, const Topology& t) {
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}"
        "</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>\n",
        name, t.components, t.boundary_loops, t.euler_characteristic, t.non_manifold_edges, t.bow_tie_vertices,
        t.orientable ? "yes" : "no");
  };
  row("In the file", report.source);
  row("After repair", report.cleaned);
  row("To be shown by the image", report.represented);
  row("Of the image, copies merged", report.welded);
  const std::string body = table("The last two lines agree, or the asset would have been refused.",
                                 {"Surface", "Pieces", "Openings", "Euler characteristic", "Edges of several sheets",
                                  "Bow-tie points", "Two-sided"},
                                 rows, "surface");
  return section("surface", "The surface", body);
}

std::string repairs_section(const ConvertReport& report) {
  std::string rows;
  for (const Repair& repair : report.repairs) {
    if (repair.count == 0) continue;
    std::string kind = repair.kind;
    std::replace(kind.begin(), kind.end(), '_', ' ');
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td class=\"number\">{}</td></tr>\n", escape_html(kind),
                        repair.count);
  }
  std::string text = rows.empty() ? "<p>The mesh needed no repair.</p>\n"
                                  : table("What was put right in the mesh", {"Repair", "Count"}, rows);
  rows.clear();
  for (const CarriedPart& part : report.carried) {
    rows += fmt::format(
        "<tr><th scope=\"row\">part {}</th><td class=\"number\">{}</td><td class=\"number\">{}</td>"
        "<td>{}</td></tr>\n",
        part.part, part.faces, percent(part.area_share), escape_html(part.why));
  }
  text += rows.empty() ? "<p>No part is carried along: all of the surface has pixels.</p>\n"
                       : table("Carried along by their neighbours, without pixels of their own",
                               {"Part", "Faces", "Area", "Why"}, rows);
  return section("repairs", "Repairs and carried parts", text);
}

std::string parts_section(const ConvertReport& report) {
  if (report.parts.size() < 2) return {};
  constexpr std::size_t kShown = 40;
  std::vector<PartShape> parts = report.parts;
  std::stable_sort(parts.begin(), parts.end(),
                   [](const PartShape& a, const PartShape& b) { return a.area_share > b.area_share; });
  std::string rows;
  for (std::size_t i = 0; i < std::min(parts.size(), kShown); ++i) {
    rows += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"number\">{}</td><td class=\"number\">{}</td>"
        "<td class=\"number\">{}</td></tr>\n",
        parts[i].name.empty() ? "(no name)" : escape_html(parts[i].name), parts[i].faces, percent(parts[i].area_share),
        percent(parts[i].stretched_share));
  }
  std::string text = table("Parts of the file, largest first",
                           {"Part", "Triangles", "Share of the area", "Of it stretched by more than 10 %"}, rows);
  if (parts.size() > kShown) text += fmt::format("<p>and {} smaller ones.</p>\n", parts.size() - kShown);
  return section("parts", "Parts", text);
}

std::string time_section(const ConvertReport& report) {
  std::string rows;
  for (const auto& [stage, seconds] : report.seconds) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td class=\"number\">{:.2f} s</td></tr>\n", escape_html(stage),
                        seconds);
  }
  const double megabytes = static_cast<double>(report.peak_memory_bytes) / (1 << 20);
  return section("time", "Time and memory",
                 table("Seconds of each step", {"Step", "Time"}, rows) +
                     fmt::format("<p>At most {:.0f} MiB of memory were in use.</p>\n", megabytes));
}

}  // namespace

std::string conversion_page(const ConvertResult& result, const PagePictures& pictures, const std::string& source) {
  const std::vector<MeasureGroup> groups = judge(result);
  const ConvertReport& report = result.report;
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
             "<title>{}: conversion report</title>\n<style>\n{}</style>\n</head>\n<body>\n",
             escape_html(result.asset.name), kPageStyle) +
         header(result, source, sum_up(groups)) + "<main>\n" + warnings_section(report) + pictures_section(pictures) +
         measures_section(groups, result.asset.layout) + surface_section(report) + repairs_section(report) +
         parts_section(report) + time_section(report) + "</main>\n</body>\n</html>\n";
}

}  // namespace geocloth
