// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth inspect: what is in an asset, for people or as JSON, and its surface as a mesh.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command.h"
#include "file_names.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/asset/topology.h"
#include "geocloth/solver/scene.h"
#include "options.h"
#include "render/asset_pictures.h"

namespace geocloth {
namespace {

struct InspectArguments {
  std::filesystem::path asset, mesh, charts, pictures;
  bool json = false;
};

constexpr std::array<const char*, kSpringCount> kSpringNames{"right",     "down",   "down_right",
                                                             "down_left", "right2", "down2"};

struct Summary {
  uint32_t valid_pixels = 0, split_pixels = 0, copies_max = 0;
  std::array<uint64_t, kSpringCount> springs{};
  double area = 0;  ///< [m^2]
  Vec3 low, high;   ///< [m]
  Topology welded;
};

Topology welded_topology(const ClothAsset& asset) {
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  return measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
}

Summary summarize(const ClothAsset& asset) {
  Summary summary;
  bool first = true;
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if (!asset.valid(pixel)) continue;
    const Vec3& p = asset.rest_position[pixel];
    if (first) summary.low = summary.high = p;
    first = false;
    summary.low = {std::min(summary.low.x, p.x), std::min(summary.low.y, p.y), std::min(summary.low.z, p.z)};
    summary.high = {std::max(summary.high.x, p.x), std::max(summary.high.y, p.y), std::max(summary.high.z, p.z)};
    summary.area += static_cast<double>(asset.area[pixel]);
    ++summary.valid_pixels;
    for (uint32_t bit = 0; bit < kSpringCount; ++bit) {
      summary.springs[bit] += static_cast<uint32_t>(asset.spring_mask[pixel] >> bit) & 1U;
    }
  }
  summary.split_pixels = static_cast<uint32_t>(asset.splits.pixel.size());
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    summary.copies_max = std::max(summary.copies_max, static_cast<uint32_t>(asset.splits.copies(row).size()));
  }
  summary.welded = welded_topology(asset);
  return summary;
}

/// The first of many.
template <class Named>
std::string names_of(const std::vector<Named>& all) {
  constexpr size_t kMost = 12;
  std::string names;
  for (size_t k = 0; k < std::min(kMost, all.size()); ++k) names += (k > 0 ? ", " : "") + all[k].name;
  if (all.size() > kMost) names += fmt::format(" and {} more", all.size() - kMost);
  return names;
}

/// What the vertices are painted in: the least and the most of each channel, 0..1; empty without paint.
std::vector<std::pair<const char*, std::array<double, 2>>> paint_ranges(const ClothAsset& asset) {
  std::vector<std::pair<const char*, std::array<double, 2>>> ranges;
  if (asset.paint.empty()) return ranges;
  for (const PaintChannel channel : kPaintChannels) {
    uint8_t least = 255, most = 0;
    for (const Rgba8& color : asset.paint) {
      least = std::min(least, color[static_cast<size_t>(channel)]);
      most = std::max(most, color[static_cast<size_t>(channel)]);
    }
    ranges.push_back({to_string(channel), {least / 255.0, most / 255.0}});
  }
  return ranges;
}

void print_for_people(const InspectArguments& options, const ClothAsset& asset, const Summary& summary) {
  const SourceMesh& source = asset.source;
  fmt::print("{}: \"{}\", layout {}\n", options.asset.string(), asset.name, to_string(asset.layout));
  fmt::print("  image     {} x {} pixels, {} valid, {} {}, spacing {:.4g} m, area {:.4g} m^2\n", asset.width,
             asset.height, summary.valid_pixels, asset.chart_count, asset.chart_count == 1 ? "chart" : "charts",
             asset.spacing, summary.area);
  fmt::print("  extent    {:.4g} x {:.4g} x {:.4g} m\n", summary.high.x - summary.low.x, summary.high.y - summary.low.y,
             summary.high.z - summary.low.z);
  fmt::print("  split     {} points with {} copies, at most {} of one point, {} bending elements across seams\n",
             asset.splits.rows(), summary.split_pixels, summary.copies_max, asset.seam_bends.size());
  if (!asset.sewing.empty()) fmt::print("  sewing    {} pairs of pixels to be sewn together\n", asset.sewing.size());
  fmt::print("  springs  ");
  for (uint32_t bit = 0; bit < kSpringCount; ++bit) fmt::print(" {} {}", kSpringNames[bit], summary.springs[bit]);
  fmt::print("\n  welded    {} components, {} boundary loops, Euler characteristic {}, {}\n", summary.welded.components,
             summary.welded.boundary_loops, summary.welded.euler_characteristic,
             summary.welded.orientable ? "orientable" : "not orientable");
  fmt::print("  source    {} vertices{}, {} triangles, {} parts, {} materials, {} images, {} vertex groups\n",
             source.file_vertex_count(),
             source.middle.empty() ? "" : fmt::format(" and {} between them", source.middle.size()),
             source.triangle.size(), source.part.size(), source.material.size(), source.image.size(),
             asset.vertex_groups.size());
  if (!source.material.empty()) fmt::print("  materials {}\n", names_of(source.material));
  if (!asset.vertex_groups.empty()) fmt::print("  groups    {}\n", names_of(asset.vertex_groups));
  std::string paint;
  for (const auto& [channel, range] : paint_ranges(asset))
    paint += fmt::format("{}{} {:.3g} to {:.3g}", paint.empty() ? "" : ", ", channel, range[0], range[1]);
  if (!paint.empty()) fmt::print("  paint     {}\n", paint);
}

nlohmann::ordered_json to_json(const ClothAsset& asset, const Summary& summary) {
  nlohmann::ordered_json springs;
  for (uint32_t bit = 0; bit < kSpringCount; ++bit) springs[kSpringNames[bit]] = summary.springs[bit];
  const auto point = [](const Vec3& p) { return nlohmann::ordered_json{p.x, p.y, p.z}; };
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  for (const ClothAsset::VertexGroup& group : asset.vertex_groups) {
    groups.push_back({{"name", group.name}, {"vertices", group.source_vertex.size()}});
  }
  nlohmann::ordered_json materials = nlohmann::ordered_json::array();
  for (const SourceMaterial& material : asset.source.material) materials.push_back(material.name);
  nlohmann::ordered_json paint = nlohmann::ordered_json::object();
  for (const auto& [channel, range] : paint_ranges(asset)) paint[channel] = {{"min", range[0]}, {"max", range[1]}};
  return {{"name", asset.name},
          {"image",
           {{"layout", to_string(asset.layout)},
            {"width", asset.width},
            {"height", asset.height},
            {"valid_pixels", summary.valid_pixels},
            {"charts", asset.chart_count},
            {"spacing", asset.spacing},
            {"split_points", asset.splits.rows()},
            {"copies_max", summary.copies_max}}},
          {"area", summary.area},
          {"bounds", {{"min", point(summary.low)}, {"max", point(summary.high)}}},
          {"springs", springs},
          {"seam_bends", asset.seam_bends.size()},
          {"sewing_pairs", asset.sewing.size()},
          {"welded",
           {{"components", summary.welded.components},
            {"boundary_loops", summary.welded.boundary_loops},
            {"euler_characteristic", summary.welded.euler_characteristic},
            {"orientable", summary.welded.orientable}}},
          {"source",
           {{"vertices", asset.source.file_vertex_count()},
            {"refined_vertices", asset.source.middle.size()},
            {"triangles", asset.source.triangle.size()},
            {"parts", asset.source.part.size()},
            {"materials", asset.source.material.size()},
            {"images", asset.source.image.size()}}},
          {"vertex_groups", groups},
          {"material_names", materials},
          {"paint", paint}};
}

void run(const InspectArguments& options) {
  std::optional<OutputFile> mesh_file, charts_file;
  if (!options.mesh.empty()) mesh_file.emplace(options.mesh);
  if (!options.charts.empty()) charts_file.emplace(options.charts);

  const ClothAsset asset = read_asset(options.asset);
  if (mesh_file) {
    mesh_file->write(to_obj(welded_grid_mesh(asset, asset.rest_position), false));
    mesh_file->close();
  }
  if (charts_file) {
    charts_file->write(to_obj(unwelded_grid_mesh(asset, asset.rest_position), true));
    charts_file->close();
  }
  if (!options.pictures.empty()) write_pictures(asset, nullptr, options.pictures);
  if (mesh_file) mesh_file->commit();
  if (charts_file) charts_file->commit();

  const Summary summary = summarize(asset);
  if (options.json) {
    fmt::print("{}\n", to_json(asset, summary).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    print_for_people(options, asset, summary);
  }
}

}  // namespace

CommandRun add_inspect(CLI::App& app) {
  auto options = std::make_shared<InspectArguments>();
  add_text(app, "asset", "ASSET.glb", options->asset, "an asset that convert wrote", "required")->required();
  app.add_flag("--json", options->json, "print JSON for programs [default off]");
  add_text(app, "--mesh", "OUT.obj", options->mesh, "write the grid mesh with the copies of split points merged",
           "default none")
      ->check(ends_with({".obj"}));
  add_text(app, "--charts", "OUT.obj", options->charts,
           "write the charts apart, texture coordinates = place in the atlas", "default none")
      ->check(ends_with({".obj"}));
  add_text(app, "--pictures", "DIR", options->pictures,
           "write PNGs: geometry image, chart map with the split points, distortion", "default none");
  app.final_callback([options] {
    std::vector<NamedFile> writes;
    if (!options->mesh.empty()) writes.push_back({"--mesh", options->mesh});
    if (!options->charts.empty()) writes.push_back({"--charts", options->charts});
    if (const std::string clash = find_name_clash({{"the asset", options->asset}}, writes); !clash.empty())
      throw CLI::ValidationError(clash);
  });
  return [options] { run(*options); };
}

}  // namespace geocloth
