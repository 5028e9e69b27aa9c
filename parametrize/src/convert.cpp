// SPDX-License-Identifier: GPL-3.0-or-later
// A garment file becomes a cloth asset: the stages of the design in order, each one call, timed, its result written to
// a folder on request. What the stages did not promise is checked at the end (verify.cpp): a wrong asset is refused,
// a poor one is described by its measures and by warnings.
#include "geocloth/parametrize/convert.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <sys/resource.h>

#include "cut/fold_loops.h"
#include "develop/develop.h"
#include "fit/fit_image.h"
#include "fit/relax_samples.h"
#include "flatten/open_holes.h"
#include "flatten/uv_layout.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/parts.h"
#include "geocloth/parametrize/refine.h"
#include "mesh/point_math.h"
#include "mesh/untangle.h"
#include "pack/pack.h"
#include "repair/border_loops.h"
#include "repair/canonical_order.h"
#include "repair/filled_holes.h"
#include "repair/layers.h"
#include "repair/small_pieces.h"
#include "repair/upright.h"
#include "report/mesh_warnings.h"
#include "report/stage_files.h"
#include "report/verify.h"
#include "report/warnings.h"
#include "sewing/sewing_edges.h"
#include "sewing/sewn_pixels.h"

namespace geocloth {
namespace {

/// Runs the stages and notes how long each took.
class Stages {
 public:
  explicit Stages(const Progress& progress) : progress_(progress) {}

  template <class Work>
  auto run(const char* name, const Work& work) {
    show(name, 0);
    const Timing timing(*this, name);
    auto result = work();
    show(name, 1);
    return result;
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> seconds() const {
    auto all = seconds_;
    all.emplace_back("total", since(start_));
    return all;
  }

 private:
  using Clock = std::chrono::steady_clock;
  /// Notes the time of a stage when it ends, also by an exception: another layout may be tried then.
  struct Timing {
    Timing(Stages& stages_of, const char* stage) : stages(stages_of), name(stage) {}
    ~Timing() { stages.add_seconds(name, since(start)); }
    Timing(const Timing&) = delete;
    Timing& operator=(const Timing&) = delete;
    Stages& stages;
    const char* name;
    Clock::time_point start = Clock::now();
  };
  static double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }
  /// A stage that runs again, for another layout, goes on counting.
  void add_seconds(const char* name, double seconds) {
    const auto known = std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& s) { return s.first == name; });
    if (known == seconds_.end()) {
      seconds_.emplace_back(name, seconds);
    } else {
      known->second += seconds;
    }
  }
  void show(const char* name, double fraction) const {
    if (progress_) progress_(name, fraction);
  }

  const Progress& progress_;
  Clock::time_point start_ = Clock::now();
  std::vector<std::pair<std::string, double>> seconds_;
};

/// What the stages of a conversion have in common.
struct Conversion {
  const TriangleMesh* mesh;  ///< the file's; untangled: with its vertices where they are then
  Upright upright;
  Point3 up{};                   ///< in the image, if it is panels: one of the two ends of what is upright
  std::vector<Point3> beside{};  ///< per vertex of the file: where the cloth is that it rides on; empty: there
  const Progress& progress;
  Stages& stages;
  const StageFiles& files;
};

Topology welded_topology(const ClothAsset& asset) {
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  return measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
}

uint32_t polygon_count(const TriangleMesh& mesh) {
  std::vector<uint32_t> polygons = mesh.polygon;
  std::sort(polygons.begin(), polygons.end());
  return static_cast<uint32_t>(std::unique(polygons.begin(), polygons.end()) - polygons.begin());
}

/// As Linux counts it. The peak of getrusage() may be that of the program that started this one, for exec keeps it.
std::optional<uint64_t> peak_of_status() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    uint64_t kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
  }
  return std::nullopt;
}

uint64_t peak_memory_bytes() {
  if (const auto peak = peak_of_status()) return *peak;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

/// Layout uv is cut along the seams of the garment's own texture coordinates, layout panels as well where they are a
/// sewing pattern whose pieces are large beside the pixels; where they are small, cuts prefer them.
/// @param shape  what the surface's shape speaks for
CutOptions cut_options(const CleanSurface& clean, const FlattenOptions& options, const CutPreferences& shape) {
  if (options.layout == Layout::uv) return {.extra_edges = usable_uv_pattern(clean).seam};
  if (options.layout != Layout::panels) return {};
  CutOptions cut{{}, shape};
  UvPattern pattern = read_uv_pattern(clean);
  double area = 0;
  for (const UvPattern::Island& island : pattern.island) area += island.area;
  const double spacing = options.spacing > 0 ? options.spacing : std::sqrt(area) / options.resolution;
  constexpr double kMostOnOutline = 0.07;  // share of the pixels
  if (pattern.is_sewing_pattern && pattern.outline * spacing <= kMostOnOutline * area) {
    cut.extra_edges = std::move(pattern.seam);
  } else if (pattern.is_sewing_pattern) {
    cut.prefer.seams = std::move(pattern.seam);
  }
  return cut;
}

/// The shortest cuts, those where they are wished, and those all along the folds between layers: what a wish costs in
/// the end only the layout tells.
std::vector<CutSurface> all_cuts(const CleanSurface& clean, const CutOptions& options, const Progress& progress) {
  std::vector<CutSurface> cuts;
  cuts.push_back(cut_to_disks(clean, {.extra_edges = options.extra_edges}, progress));
  const CutPreferences& prefer = options.prefer;
  std::vector<size_t> triangles(clean.component_count, 0);
  for (const uint32_t c : clean.component) ++triangles[c];
  const bool some_part_is_small =
      std::any_of(triangles.begin(), triangles.end(), [](size_t n) { return n <= kMostWithWishes; });
  if (some_part_is_small && (prefer.creases || !prefer.seams.empty() || prefer.mirror)) {
    cuts.push_back(cut_to_disks(clean, options, progress));
  }
  if (!prefer.folds.empty()) {
    CutOptions along_folds{options.extra_edges, {}};
    along_folds.extra_edges.insert(along_folds.extra_edges.end(), prefer.folds.begin(), prefer.folds.end());
    try {
      cuts.push_back(cut_to_disks(clean, along_folds, progress));
    } catch (const Error&) {  // there are the others
    }
  }
  return cuts;
}

/// A surface cut open, in the ways that cut_options wants.
struct Cuts {
  CutOptions options;
  std::vector<CutSurface> surface;
};

Cuts cut_open(const CleanSurface& surface, const FlattenOptions& options, const CutPreferences& shape,
              const Conversion& run) {
  Cuts cuts{cut_options(surface, options, shape), {}};
  cuts.surface = run.stages.run("cut", [&] { return all_cuts(surface, cuts.options, run.progress); });
  return cuts;
}

/// @param surface  upright. @returns it as it lies in the file
FlatSurface lay_flat(const CleanSurface& surface, const Cuts& cuts, const FlattenOptions& options,
                     const Conversion& run) {
  CutSurface first = cuts.surface.front();
  first.position = run.upright.undo(std::move(first.position));
  run.files.save(first);
  return run.stages.run("flatten", [&] {
    FlattenOptions with_wishes = options;
    with_wishes.prefer = cuts.options.prefer;
    FlatSurface flat = flatten(surface, cuts.surface, with_wishes, run.progress);
    flat.position = run.upright.undo(std::move(flat.position));
    if (options.layout == Layout::panels && run.up != run.upright.up()) turn_atlas(flat);
    return flat;
  });
}

/// A surface whose holes are filled where that may cost less than cuts to them, cut open.
struct FilledCuts {
  CleanSurface surface;
  Cuts cuts;
};

/// Nothing when there are no such holes. Those that first cuts meet anyway are cut open like other borders.
std::optional<FilledCuts> cut_filled(const CleanSurface& clean, const FlattenOptions& options,
                                     const CutPreferences& shape, const Conversion& run) {
  constexpr int kTries = 4;
  constexpr size_t kMostCutOpen = 300;  // holes: to find cuts to more of them takes long
  const size_t kept = clean.triangle.size();
  std::vector<uint32_t> left_open;
  for (int tries = 0; tries < kTries; ++tries) {
    FilledSurface filled = fill_holes(clean, left_open);
    if (filled.rim.empty()) return std::nullopt;
    Cuts cuts = cut_open(filled.surface, options, shape, run);
    std::vector<uint32_t> met;
    for (CutSurface& cut : cuts.surface) {
      for (const uint32_t t : cut.clean_triangle) cut.hole.push_back(t < kept ? kNone : filled.hole[t - kept]);
      const std::vector<uint32_t> of_cut = holes_on_cuts(cut);
      met.insert(met.end(), of_cut.begin(), of_cut.end());
    }
    if (!met.empty() && tries + 1 < kTries) {
      for (const uint32_t hole : met) left_open.push_back(filled.rim[hole]);
      std::sort(left_open.begin(), left_open.end());
      continue;
    }
    if (filled.rim.size() <= kMostCutOpen) {
      CleanSurface as_it_is = clean;
      as_it_is.point_count = filled.surface.point_count;  // points that cuts insert have numbers beyond all of these
      for (CutSurface& cut : cut_open(as_it_is, options, shape, run).surface) {
        cuts.surface.push_back(std::move(cut));
      }
    }
    return FilledCuts{std::move(filled.surface), std::move(cuts)};
  }
  return std::nullopt;
}

/// From the surface that the image is to reproduce to a verified asset.
/// @param fill  whether holes are to cost no cut. @returns whether there is something laid out: not if `fill` and there
///   are no such holes
bool lay_out(const CarriedSurface& carried, const FlattenOptions& options, bool fill, const Conversion& run,
             ConvertResult& result) {
  const CleanSurface& clean = carried.represented;
  ConvertReport& report = result.report;
  report.carried = carried.carried;
  report.represented = measure_topology(point_triangles(clean), clean.point_count);

  CleanSurface upright = clean;
  upright.position = run.upright.apply(std::move(upright.position));
  CutPreferences shape{.creases = true, .seams = {}, .mirror = {}};
  if (options.layout == Layout::panels) {
    shape.mirror = run.stages.run("mirror", [&] { return find_mirror_plane(upright.position, upright.triangle); });
    shape.folds = fold_loops(upright, kMostWithWishes);
  }
  report.mirror = shape.mirror;
  if (shape.mirror) report.mirror->normal = run.upright.undo(shape.mirror->normal);
  if (fill) {
    const std::optional<FilledCuts> filled = cut_filled(upright, options, shape, run);
    if (!filled) return false;
    result.flat = lay_flat(filled->surface, filled->cuts, options, run);
  } else {
    result.flat = lay_flat(upright, cut_open(upright, options, shape, run), options, run);
  }
  FlatSurface& flat = result.flat;
  // Exactly where they were, which turning there and back is not.
  for (size_t v = 0; v < flat.position.size(); ++v) {
    if (flat.clean_vertex[v] < clean.position.size()) flat.position[v] = clean.position[flat.clean_vertex[v]];
  }
  run.files.save(flat);

  const Raster raster = run.stages.run("rasterize", [&] {
    Raster r = rasterize(flat, run.progress);
    if (options.layout != Layout::square) relax_samples(flat, r);
    return r;
  });
  result.asset = run.stages.run("image", [&] { return build_image(flat, raster, options.layout); });
  ClothAsset& asset = result.asset;
  run.stages.run("fit", [&] {
    fit_image(flat, raster, asset);
    return true;
  });
  if (report.untangled_mesh) report.untangled_image = run.stages.run("untangle", [&] { return untangle_image(asset); });
  run.files.save(asset);

  run.stages.run("bind", [&] {
    bind_source(*run.mesh, clean, flat, raster, asset, carried.piece_of_point, run.beside);
    return true;
  });
  report.quality = run.stages.run("measure", [&] { return measure_quality(clean, flat, raster, asset, run.progress); });
  report.welded = run.stages.run("verify", [&] {
    report.welded = welded_topology(asset);
    verify(*run.mesh, clean, flat, raster, asset, report);
    return report.welded;
  });
  return true;
}

/// The same; in panels with holes that cost no cut, if that can be. Cuts to all of some thousand holes take many
/// minutes: with so many it is that or nothing.
void lay_out_with_holes(const CarriedSurface& carried, const FlattenOptions& options, const Conversion& run,
                        ConvertResult& result) {
  constexpr size_t kMostCut = 5000;  // holes
  if (options.layout == Layout::panels) {
    try {
      if (lay_out(carried, options, true, run, result)) return;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::verification && e.code() != ErrorCode::limit) throw;
      if (border_loops(carried.represented).size() > kMostCut) throw;
    }
  }
  lay_out(carried, options, false, run, result);
}

/// @param mesh    that the surface was repaired from: its vertices move along
/// @param beside  per vertex of the mesh, or empty: moves along, too
Untangled untangle_surface(CleanSurface& surface, TriangleMesh& mesh, std::vector<Point3>& beside) {
  std::vector<Point3> place(surface.point_count);
  for (std::size_t v = 0; v < surface.position.size(); ++v) place[surface.point[v]] = surface.position[v];
  const std::vector<Point3> before = place;
  const Untangled result = untangle(point_triangles(surface), place);
  const auto follow = [&](Point3& position, uint32_t point) { position = position + (place[point] - before[point]); };
  for (std::size_t v = 0; v < surface.position.size(); ++v) follow(surface.position[v], surface.point[v]);
  for (std::size_t v = 0; v < mesh.position.size(); ++v) {
    const uint32_t point = surface.source_point[v];
    if (point == kNone) continue;
    follow(mesh.position[v], point);
    if (!beside.empty()) follow(beside[v], point);
  }
  return result;
}

struct Attempt {
  FlattenOptions options;
  bool carry;  ///< what is smaller than a pixel
};

/// What is tried one after the other until one passes the verification. A square gives every part pixels, however small
/// it is, so nothing needs to be carried unless that fails; panels have one spacing for all parts, and in a part of few
/// pixels cuts along the edges may fit where straight ones do not. Where strips are too narrow for panels, a few more
/// pixels serve better than squares, which stretch such a part beyond use.
std::vector<Attempt> plan_attempts(const ConvertOptions& options) {
  const auto finer = [&](double by) {
    FlattenOptions o = options.flatten;
    o.spacing /= by;
    o.resolution = static_cast<uint32_t>(std::lround(std::min(by * o.resolution, double{kMaxResolution})));
    return o;
  };
  const auto with = [&](Layout layout, bool straight_cuts) {
    FlattenOptions o = options.flatten;
    o.layout = layout;
    o.straight_cuts = straight_cuts;
    return o;
  };
  const Layout layout = options.flatten.layout;
  std::vector<Attempt> attempts;
  if (layout != Layout::square) attempts.push_back({options.flatten, true});
  if (layout == Layout::panels && options.flatten.straight_cuts) attempts.push_back({with(layout, false), true});
  if (layout == Layout::panels && options.square_if_panels_fail) {
    for (const double by : {1.25, 1.6, 2.5}) attempts.push_back({finer(by), true});
  }
  if (layout == Layout::square || (layout == Layout::panels && options.square_if_panels_fail)) {
    attempts.push_back({with(Layout::square, false), false});
    attempts.push_back({with(Layout::square, false), true});
  }
  return attempts;
}

ConvertResult convert_mesh(const TriangleMesh& mesh, std::span<const SewingRun> sewing, const ConvertOptions& options,
                           const Progress& progress, Stages& stages, const StageFiles& files) {
  ConvertResult result;
  ConvertReport& report = result.report;
  report.source_faces = polygon_count(mesh);
  report.source_bbox_diagonal = bounding_diagonal(mesh.position);

  Conversion run{&mesh, {}, {}, {}, progress, stages, files};
  std::vector<CarriedPart> sides;
  RepairResult repaired = stages.run("repair", [&] {
    RepairResult r = repair_mesh(mesh, options.repair, progress);
    if (options.one_layer) {
      OneLayer layer = leave_one_layer(mesh, r.surface, options.repair);
      r.surface = std::move(layer.surface);
      sides = std::move(layer.carried);
      run.beside = std::move(layer.beside);
    }
    put_in_canonical_order(r.surface);  // what is sampled to find up and down must not depend on the file's order
    run.upright = options.up ? Upright(*options.up) : find_upright(r.surface);
    if (!run.upright.is_identity()) put_in_canonical_order(r.surface, run.upright);
    return r;
  });
  run.up = options.up.value_or(run.upright.higher_end());  // where possible the image stands as the file does
  report.up = run.up;
  report.source = repaired.source;
  report.repairs = repaired.repairs;
  report.cleaned = repaired.cleaned;
  report.cleaned_bbox_diagonal = bounding_diagonal(repaired.surface.position);
  TriangleMesh untangled;
  if (options.untangle) {
    untangled = mesh;
    report.untangled_mesh =
        stages.run("untangle", [&] { return untangle_surface(repaired.surface, untangled, run.beside); });
    run.mesh = &untangled;
  }
  files.save(repaired.surface);

  const std::vector<Attempt> attempts = plan_attempts(options);
  std::string panels_failed;
  CarriedSurface carried;
  bool finer = false;  // than asked for
  for (size_t i = 0; i < attempts.size(); ++i) {
    carried = stages.run("carry", [&] {
      const bool square = attempts[i].options.layout == Layout::square;
      CarriedSurface of_surface =
          attempts[i].carry ? carry_small_pieces(mesh, repaired.surface, square ? options.flatten : attempts[i].options,
                                                 options.carry_loose)
                            : carry_nothing(repaired.surface);
      of_surface.carried.insert(of_surface.carried.end(), sides.begin(), sides.end());
      return of_surface;
    });
    try {
      lay_out_with_holes(carried, attempts[i].options, run, result);
      finer = attempts[i].options.layout == Layout::panels &&
              (attempts[i].options.resolution > options.flatten.resolution ||
               attempts[i].options.spacing < options.flatten.spacing);
      break;
    } catch (const Error& e) {
      const bool refused = e.code() == ErrorCode::verification || e.code() == ErrorCode::limit;
      if (!refused) throw;
      if (i + 1 == attempts.size()) {
        if (panels_failed.empty() || attempts[i].options.layout != Layout::square) throw;
        // The remedy is the one for panels: for squares it may be the opposite.
        const std::string in_squares = e.what();
        throw Error(e.code(), panels_failed + "; nor in squares: " + in_squares.substr(0, in_squares.rfind("; ")));
      }
      if (attempts[i].options.layout == Layout::panels && panels_failed.empty()) panels_failed = e.what();
    }
  }

  if (!sewing.empty()) {
    result.asset.sewing = stages.run("sew", [&] { return sew_pixels(sewing, *run.mesh, result.asset); });
    report.sewing_edges = count_edges(sewing);
  }
  report.parts = measure_parts(mesh, carried.represented, result.flat);
  report.uncut_corners = count_uncut_corners(result.flat);
  report.disk_share = disk_share(result.flat);
  report.panels_failed = !panels_failed.empty() && result.asset.layout == Layout::square;
  const double side = options.flatten.spacing > 0 ? 0.0 : static_cast<double>(options.flatten.resolution);
  report.warnings = plain_warnings(report, result.asset, side * side);
  if (report.panels_failed) {
    report.warnings.insert(report.warnings.begin(),
                           "laid out in squares, because panels could not be made: " + panels_failed);
  } else if (finer) {
    report.warnings.insert(report.warnings.begin(),
                           "more pixels than asked for, because panels could not be made of so few: " + panels_failed);
  }
  for (const auto& warning :
       {warning_of_spacing(result.asset.spacing, options.flatten.spacing), warning_of_coarse_triangles(result.asset),
        warning_of_loose_pieces(find_loose_pieces(carried.represented, options.carry_loose ? 0 : carried.spacing)),
        warning_of_cracks(find_cracks(repaired.surface)),
        options.one_layer ? std::nullopt : warning_of_thickness(find_thickness(repaired.surface)),
        warning_of_folds(repaired, mesh.triangle.size(), report.source_bbox_diagonal),
        warning_of_touching(repaired, report.source_bbox_diagonal)}) {
    if (warning) report.warnings.push_back(*warning);
  }
  report.warnings.insert(report.warnings.begin(), mesh.left_out.begin(), mesh.left_out.end());
  report.seconds = stages.seconds();
  report.peak_memory_bytes = peak_memory_bytes();
  return result;
}

struct Bounds {
  Point3 low, high;
};

/// Of what has faces; nothing for a mesh without.
std::optional<Bounds> bounds_of_faces(const TriangleMesh& mesh) {
  if (mesh.triangle.empty()) return std::nullopt;
  const Point3& first = mesh.position[mesh.triangle[0][0]];
  Bounds bounds{first, first};
  for (const Triangle& t : mesh.triangle) {
    for (const uint32_t v : t) {
      for (std::size_t k = 0; k < 3; ++k) {
        bounds.low[k] = std::min(bounds.low[k], mesh.position[v][k]);
        bounds.high[k] = std::max(bounds.high[k], mesh.position[v][k]);
      }
    }
  }
  return bounds;
}

constexpr double kLargestMesh = 1e7;    // [m] an asset's coordinates end at ten times that
constexpr double kSmallestMesh = 1e-9;  // [m] areas of pixels leave the range of a float at a millionth of that

/// Refuses what no unit makes cloth of, before minutes are spent on it.
void check_size(const Bounds& bounds) {
  const double across = distance(bounds.low, bounds.high);
  if (across == 0 || (across >= kSmallestMesh && across <= kLargestMesh)) return;
  char text[256];
  std::snprintf(text, sizeof text,
                across > kLargestMesh
                    ? "the mesh is %.3g m across, which no cloth is; give its unit with --unit or --scale, "
                      "or look for stray vertices in it"
                    : "the mesh is %.3g m across, which no cloth is; give its unit with --unit or --scale",
                across);
  throw Error(ErrorCode::limit, text);
}

/// The way to the origin for a mesh so far from it that single precision, in which assets and solvers count, would show
/// in its springs; nothing for one that can stay where it is.
std::optional<Point3> way_to_origin(const Bounds& bounds) {
  constexpr double kFar = 100;  // diagonals
  const Point3 middle = (bounds.low + bounds.high) * 0.5;
  const bool far = length(middle) > std::min(kLargestMesh, kFar * distance(bounds.low, bounds.high));
  return far ? std::optional(middle * -1) : std::nullopt;
}

/// Divides what is coarser than the pixels, see ConvertOptions::refine.
TriangleMesh refined(TriangleMesh mesh, const ConvertOptions& options) {
  double spacing = options.flatten.spacing;
  if (!(spacing > 0)) spacing = std::sqrt(surface_area(mesh.position, mesh.triangle)) / options.flatten.resolution;
  return spacing > 0 ? refine_mesh(std::move(mesh), options.refine * spacing) : mesh;
}

ConvertResult convert_near_origin(TriangleMesh mesh, const ConvertOptions& options, const Progress& progress,
                                  Stages& stages, const StageFiles& files) {
  files.save(mesh);
  const std::optional<Bounds> bounds = bounds_of_faces(mesh);
  if (bounds) check_size(*bounds);
  const std::optional<Point3> way = bounds ? way_to_origin(*bounds) : std::nullopt;
  if (way) {
    for (Point3& p : mesh.position) p = p + *way;
  }
  const auto vertices = static_cast<uint32_t>(mesh.position.size());
  const std::vector<SewingRun> sewing = find_sewing(mesh);  // as long as edges of the mesh join those of the file
  if (options.refine > 0) mesh = stages.run("refine", [&] { return refined(std::move(mesh), options); });
  ConvertResult result = convert_mesh(mesh, sewing, options, progress, stages, files);
  result.report.source_vertices = vertices;
  result.report.refined_vertices = static_cast<uint32_t>(mesh.position.size()) - vertices;
  std::vector<std::string>& warnings = result.report.warnings;
  const auto far = warning_of_far_vertices(mesh, way.value_or(Point3{0, 0, 0}), result.asset.spacing);
  if (far) warnings.insert(warnings.begin(), *far);
  if (!way) return result;
  result.report.moved = *way;
  warnings.insert(warnings.begin(), warning_of_move(*way));
  return result;
}

TriangleMesh chosen_parts(TriangleMesh mesh, const ConvertOptions& options) {
  if (options.parts.empty()) return mesh;
  return select_parts(with_choosable_parts(std::move(mesh), options.repair), options.parts);
}

/// Foreign failures in our own words, once for the whole conversion.
template <class Work>
ConvertResult translated(const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, "not enough memory for this mesh; give a smaller --resolution or reduce the mesh");
  }
}

}  // namespace

ConvertResult convert(const TriangleMesh& mesh, const ConvertOptions& options, const Progress& progress) {
  return translated([&] {
    const StageFiles files(options.stages);
    Stages stages(progress);
    return convert_near_origin(chosen_parts(mesh, options), options, progress, stages, files);
  });
}

ConvertResult convert(const std::filesystem::path& path, const ConvertOptions& options, const Progress& progress) {
  try {
    return translated([&] {
      const StageFiles files(options.stages);
      Stages stages(progress);
      TriangleMesh mesh =
          stages.run("import", [&] { return chosen_parts(import_mesh(path, options.import), options); });
      return convert_near_origin(std::move(mesh), options, progress, stages, files);
    });
  } catch (const Error& e) {
    const std::string message = e.what();
    const bool named = e.code() == ErrorCode::cancelled || message.find(path.string()) != std::string::npos;
    throw Error(e.code(), named ? message : path.string() + ": " + message);
  }
}

}  // namespace geocloth
