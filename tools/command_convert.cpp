// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth convert: a mesh file becomes an asset. The outputs are opened before the work starts, so that a folder that
// cannot be written is known at once, and get their final names together at the end.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "file_error.h"
#include "file_names.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/parametrize/parts.h"
#include "options.h"
#include "progress.h"
#include "render/asset_pictures.h"
#include "report/conversion_page.h"

namespace geocloth {
namespace {

constexpr Point3 kUpByShape{0, 0, 0};

struct ConvertArguments {
  std::filesystem::path mesh, asset, pictures, stages;
  std::vector<std::filesystem::path> reports;
  std::string parts;
  bool carry_loose = false, one_layer = false, untangle = false;
  Point3 up = kUpByShape;
  Layout layout = FlattenOptions{}.layout;
  uint32_t resolution = FlattenOptions{}.resolution;
  double spacing = 0;
  double unit = 1, scale = 1, weld = 0, refine = 0;
  CLI::Option *layout_option = nullptr, *unit_option = nullptr, *scale_option = nullptr, *weld_option = nullptr;
  bool quiet = false;
};

/// Said in place of a selection of parts.
constexpr const char* kListParts = "list";

ConvertOptions convert_options(const ConvertArguments& options) {
  ConvertOptions result;
  result.parts = options.parts;
  result.carry_loose = options.carry_loose;
  result.one_layer = options.one_layer;
  result.untangle = options.untangle;
  if (options.unit_option->count() > 0) result.import.scale = options.unit;
  if (options.scale_option->count() > 0) result.import.scale = options.scale;
  if (options.weld_option->count() > 0) result.repair.weld_distance = options.weld;
  result.flatten.layout = options.layout;
  result.square_if_panels_fail = options.layout_option->count() == 0;
  result.flatten.resolution = options.resolution;
  result.flatten.spacing = options.spacing;
  result.refine = options.refine;
  if (options.up != kUpByShape) result.up = options.up;
  result.stages = options.stages;
  return result;
}

/// The largest parts by name; a garment with a hundred loose threads does not fill the screen.
void print_carried(std::vector<CarriedPart> carried) {
  constexpr size_t kNamed = 8;
  std::stable_sort(carried.begin(), carried.end(),
                   [](const CarriedPart& a, const CarriedPart& b) { return a.area_share > b.area_share; });
  for (size_t i = 0; i < std::min(carried.size(), kNamed); ++i) {
    fmt::print("  carried: part {} ({} faces): {}\n", carried[i].part, carried[i].faces, carried[i].why);
  }
  if (carried.size() <= kNamed) return;
  double share = 0;
  for (const CarriedPart& part : carried) share += part.area_share;
  fmt::print("  carried: {} more, smaller ones; all {} are {:.2g} % of the area (--report R.json lists them)\n",
             carried.size() - kNamed, carried.size(), 100 * share);
}

void print_untangled(const ConvertReport& report) {
  const auto print = [](const char* of, const std::optional<Untangled>& untangled) {
    if (!untangled || untangled->before == 0) return;
    fmt::print(
        "  untangled: {} pairs of the {}'s triangles cut through each other, now {}; moved by {:.3g} m at most\n",
        untangled->before, of, untangled->after, untangled->farthest);
  };
  print("mesh", report.untangled_mesh);
  print("image", report.untangled_image);
}

void print_summary(const ConvertArguments& options, const ConvertResult& result) {
  const ClothAsset& asset = result.asset;
  const ConvertReport& report = result.report;
  fmt::print("{}: {} x {} pixels, {} valid, spacing {:.4g} m, {} {}, {} split points\n", options.asset.string(),
             asset.width, asset.height, count_valid_pixels(asset), asset.spacing, asset.chart_count,
             asset.chart_count == 1 ? "chart" : "charts", asset.splits.rows());
  fmt::print("  surface: {} components, {} boundary loops, Euler characteristic {}\n", report.represented.components,
             report.represented.boundary_loops, report.represented.euler_characteristic);
  for (const Repair& repair : report.repairs) {
    if (repair.count > 0) fmt::print("  repaired: {} {}\n", repair.count, repair.kind);
  }
  print_untangled(report);
  print_carried(report.carried);
  if (report.sewing_edges > 0) {
    fmt::print("  sewing: {} edges between panels, {} pairs of pixels\n", report.sewing_edges, asset.sewing.size());
  }
  fmt::print("  accuracy: rms {:.2e} and largest {:.2e} of the diagonal; stretch L2 {:.3f}\n", report.quality.rms_error,
             report.quality.max_error, report.quality.l2_stretch);
}

bool is_page(const std::filesystem::path& report) {
  const std::string ending = CLI::detail::to_lower(report.extension().string());
  return ending == ".html" || ending == ".htm";
}

/// Writes every report, as a page for people or as JSON by its ending.
void write_reports(const ConvertArguments& options, const ConvertResult& result, std::list<OutputFile>& files) {
  const bool pages = std::any_of(options.reports.begin(), options.reports.end(), is_page);
  const std::string page =
      pages ? conversion_page(result, draw_page_pictures(std::make_shared<const ClothAsset>(result.asset)),
                              options.mesh.filename().string())
            : std::string();
  auto file = files.begin();
  for (const std::filesystem::path& report : options.reports) {
    file->write(is_page(report) ? page : to_json(result));
    file->close();
    ++file;
  }
}

/// One line per part: what --parts can choose from.
void list_parts(const ConvertArguments& options) {
  const ConvertOptions convert = convert_options(options);
  const TriangleMesh mesh = name_file_in_errors(
      options.mesh, [&] { return with_choosable_parts(import_mesh(options.mesh, convert.import), convert.repair); });
  fmt::print("{:>5}  {:24}  {:20}  {:>9}  {:>9}  {}\n", "part", "name", "material", "triangles", "area m2", "size m");
  int number = 0;
  for (const PartSummary& part : summarize_parts(mesh)) {
    fmt::print("{:>5}  {:24}  {:20}  {:>9}  {:>9.3g}  {:.3g} x {:.3g} x {:.3g}\n", number++, part.name, part.material,
               part.triangles, part.area, part.high[0] - part.low[0], part.high[1] - part.low[1],
               part.high[2] - part.low[2]);
  }
}

void run(const ConvertArguments& options) {
  if (options.parts == kListParts) {
    list_parts(options);
    return;
  }
  OutputFile asset_file(options.asset);
  std::list<OutputFile> report_files;
  for (const std::filesystem::path& report : options.reports) report_files.emplace_back(report);

  std::optional<ProgressDisplay> progress(std::in_place, "convert", options.quiet);
  const ConvertResult result = name_file_in_errors(options.mesh, [&] {
    return convert(options.mesh, convert_options(options),
                   [&](std::string_view stage, double fraction) { progress->show(stage, fraction); });
  });
  asset_file.write(encode_asset(result.asset));
  asset_file.close();
  if (!options.reports.empty()) {
    progress->show("report", 0);
    write_reports(options, result, report_files);
  }
  if (!options.pictures.empty()) {
    progress->show("pictures", 0);
    write_pictures(result.asset, &result.flat, options.pictures);
  }
  progress.reset();

  for (OutputFile& file : report_files) file.commit();
  asset_file.commit();
  for (const std::string& warning : result.report.warnings) {
    say(fmt::format("geocloth convert: {}: warning: {}\n", options.mesh.string(), warning));
  }
  print_summary(options, result);
}

std::vector<NamedFile> written_files(const ConvertArguments& options) {
  std::vector<NamedFile> files{{"--output", options.asset}};
  for (const std::filesystem::path& report : options.reports) files.push_back({"--report", report});
  if (!options.stages.empty()) {
    for (const std::filesystem::path& stage : stage_files(options.stages)) files.push_back({"--stages", stage});
  }
  return files;
}

CLI::Validator is_selection() {
  const auto check = [](const std::string& given) {
    const std::string framed = "," + given + ",";
    const bool empty_term = framed.find(",,") != framed.npos || framed.find(",-,") != framed.npos;
    return empty_term ? fmt::format("'{}' has an empty term; write for example 0,2 or -3", given) : std::string();
  };
  return CLI::Validator(check, "");
}

}  // namespace

CommandRun add_convert(CLI::App& app) {
  auto options = std::make_shared<ConvertArguments>();
  add_text(app, "mesh", "MESH", options->mesh, "OBJ, glTF, GLB, PLY, STL, OFF, FBX or DAE file", "required")
      ->required();
  CLI::Option* output =
      add_text(app, "-o,--output", "ASSET.glb", options->asset, "the asset to write", "required, but with --parts list")
          ->check(ends_with({".glb"}));
  options->layout_option = add_choice<Layout>(
      app, "--layout", options->layout, {{"panels", Layout::panels}, {"square", Layout::square}, {"uv", Layout::uv}},
      "how the surface lies in the image; panels that are not asked for get more pixels, or give way to squares, where "
      "they cannot be made");
  CLI::Option* resolution = add_number<uint32_t>(app, "--resolution", "N", options->resolution, 8, 4096, "pixels",
                                                 "about N x N valid pixels in all");
  add_number<double>(app, "--spacing", "M", options->spacing, 1e-6, 1e6, "m",
                     "length of a spring, instead of --resolution", "by --resolution")
      ->excludes(resolution);
  add_number<double>(
      app, "--refine", "PIXELS", options->refine, 0.5, 1e6, "pixels",
      "divide triangles until no edge is longer than this, so that a coarse mesh is drawn with the folds "
      "of its cloth; the vertices of the file stay the first ones",
      "none");
  add_choice<Point3>(
      app, "--up", options->up,
      {{"auto", kUpByShape},
       {"x", {1, 0, 0}},
       {"y", {0, 1, 0}},
       {"z", {0, 0, 1}},
       {"-x", {-1, 0, 0}},
       {"-y", {0, -1, 0}},
       {"-z", {0, 0, -1}}},
      "which way is up in the mesh: the grain of panels runs along it; auto: by the garment's shape, and "
      "y where that does not tell");
  options->unit_option =
      add_choice<double>(app, "--unit", options->unit,
                         {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}},
                         "unit of the mesh's coordinates", "what the file says, else m");
  options->scale_option = add_number<double>(app, "--scale", "S", options->scale, 1e-9, 1e9, "m per unit of the file",
                                             "the same as a number", "by --unit");
  options->scale_option->excludes(options->unit_option);
  options->weld_option =
      add_number<double>(app, "--weld", "M", options->weld, 0, 1e6, "m",
                         "join vertices that are no farther apart than this, but for the ends of short edges",
                         "a millionth of the size, and up to a hundred times that where all triangles are loose");
  add_text(app, "--parts", "SELECTION", options->parts,
           "parts of the file to convert, with commas between: N, N-M, NAME or material:NAME; -N, -NAME, ... leaves "
           "out. 'list' lists them and converts nothing. Parts are the file's objects, groups or primitives, or the "
           "connected pieces of its only one",
           "default all")
      ->check(is_selection());
  app.add_flag(
      "--carry-loose", options->carry_loose,
      "let small loose pieces that lie on the cloth all over, such as buttons and sequins, ride on it and have "
      "no pixels [default off: only those smaller than a pixel]");
  app.add_flag("--one-layer", options->one_layer,
               "of cloth that was given a thickness (a closed shell), simulate one side and let the other ride on it "
               "[default off: each side is cloth of its own]");
  app.add_flag("--untangle", options->untangle,
               "draw layers apart that cut through each other, in the mesh and in the image, as little as need be "
               "[default off: they are reproduced as they are]");
  app.callback([options, output] {
    if (options->parts != kListParts && output->count() == 0) throw CLI::RequiredError("--output");
    const std::string clash = find_name_clash({{"the mesh", options->mesh}}, written_files(*options));
    if (options->parts != kListParts && !clash.empty()) throw CLI::ValidationError(clash);
  });
  add_text(app, "--report", "R.html|R.json", options->reports,
           "write what came out: a page with pictures and the measures against their targets (.html), or topology, "
           "repairs, quality and times for programs (any other ending); may be given several times",
           "default none")
      ->allow_extra_args(false);
  add_text(app, "--pictures", "DIR", options->pictures,
           "write PNGs: geometry image, chart map with the split points, distortion", "default none");
  add_text(app, "--stages", "DIR", options->stages,
           "write every intermediate as a file; where a stage fails, those before it stay to be looked at",
           "default none");
  add_quiet(app, options->quiet);
  return [options] { run(*options); };
}

}  // namespace geocloth
