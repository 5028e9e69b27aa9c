// SPDX-License-Identifier: GPL-3.0-or-later
// The last word on a conversion. The welded grid mesh is compared with the surface by its topology (components,
// boundary loops, Euler characteristic, orientability, kinds of singular places), because a wrong weld or a lost
// opening shows there and nowhere else; then come the checks on the map. When the whole differs, the parts are
// compared one by one to tell the user where.
#include "report/verify.h"

#include <algorithm>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// Numbers of vertices and edges depend on the sampling; everything else has to agree.
bool same_topology(const Topology& a, const Topology& b) {
  return a.components == b.components && a.boundary_loops == b.boundary_loops &&
         a.euler_characteristic == b.euler_characteristic && a.orientable == b.orientable &&
         a.bow_tie_vertices == b.bow_tie_vertices && (a.non_manifold_edges == 0) == (b.non_manifold_edges == 0);
}

std::string in_words(const Topology& t) {
  return std::to_string(t.components) + " components, " + std::to_string(t.boundary_loops) +
         " boundary loops, Euler characteristic " + std::to_string(t.euler_characteristic) + ", " +
         (t.non_manifold_edges == 0 ? "no" : "some") + " edges of several sheets, " +
         std::to_string(t.bow_tie_vertices) + " bow-tie points" + (t.orientable ? "" : ", not orientable");
}

class Verifier {
 public:
  Verifier(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat, const ClothAsset& asset)
      : mesh_(mesh), clean_(clean), flat_(flat), asset_(asset) {
    component_of_chart_.assign(flat.charts.size(), 0);
    for (std::size_t t = 0; t < flat.triangle.size(); ++t) {
      component_of_chart_[flat.chart[t]] = clean.component[flat.clean_triangle[t]];
    }
  }

  void check_topology(const Topology& represented, const Topology& welded) const {
    if (same_topology(represented, welded)) return;
    for (uint32_t c = 0; c < clean_.component_count; ++c) {
      const Topology surface = surface_topology(c), image = image_topology(c);
      if (!same_topology(surface, image)) {
        refuse(name_of(c) + ": its image has " + in_words(image) + ", the surface " + in_words(surface) +
               finer_image());
      }
    }
    refuse("the parts are right, but not how they hang together: the image has " + in_words(welded) + ", the surface " +
           in_words(represented) + finer_image());
  }

  void check_map(const Raster& raster, const Quality& quality) const {
    if (quality.flipped != 0) refuse_flipped(quality.flipped);
    if (quality.mirrored != 0) refuse(std::to_string(quality.mirrored) + " charts are mirrored" + report_it());
    if (!raster.overlapping.empty()) {
      refuse(name_of(component_of_chart_[raster.chart[raster.overlapping[0]]]) + ": " +
             std::to_string(raster.overlapping.size()) + " pixels are covered twice" + finer_image());
    }
    if (quality.crossing_springs != 0) {
      refuse(std::to_string(quality.crossing_springs) + " springs leave their chart" + report_it());
    }
    if (quality.copy_gap != 0) {
      refuse("copies of a split vertex lie up to " + std::to_string(quality.copy_gap) + " m apart" + report_it());
    }
  }

 private:
  [[noreturn]] static void refuse(const std::string& what) { throw Error(ErrorCode::verification, what); }

  [[nodiscard]] std::string finer_image() const {
    return "; give a finer image (--resolution above " + std::to_string(asset_.width) +
           "), or mend the mesh there and convert again";
  }
  [[nodiscard]] static std::string report_it() { return "; this is a fault of the converter: please report the mesh"; }

  /// "part 'Sleeve' (component 3 of 5)"
  [[nodiscard]] std::string name_of(uint32_t component) const {
    std::string name = "component " + std::to_string(component + 1) + " of " + std::to_string(clean_.component_count);
    for (std::size_t t = 0; t < clean_.triangle.size(); ++t) {
      const uint32_t source = clean_.source_triangle[t];
      if (clean_.component[t] != component || source == kNone) continue;
      for (const SourcePart& part : mesh_.part) {
        const bool holds = source >= part.first_triangle && source - part.first_triangle < part.triangle_count;
        if (holds && !part.name.empty()) return "part '" + part.name + "' (" + name + ")";
      }
      break;
    }
    return name;
  }

  [[nodiscard]] Topology surface_topology(uint32_t component) const {
    std::vector<Triangle> triangles;
    for (std::size_t t = 0; t < clean_.triangle.size(); ++t) {
      if (clean_.component[t] != component) continue;
      const Triangle& v = clean_.triangle[t];
      triangles.push_back({clean_.point[v[0]], clean_.point[v[1]], clean_.point[v[2]]});
    }
    return measure_topology(triangles, clean_.point_count);
  }

  [[nodiscard]] Topology image_topology(uint32_t component) const {
    const std::vector<uint32_t> first = first_copies(asset_);
    std::vector<Triangle> triangles;
    for (const Triangle& t : pixel_triangles(asset_)) {
      if (component_of_chart_[asset_.chart[t[0]]] != component) continue;
      const Triangle welded{first[t[0]], first[t[1]], first[t[2]]};
      if (welded[0] != welded[1] && welded[1] != welded[2] && welded[2] != welded[0]) triangles.push_back(welded);
    }
    return measure_topology(triangles, asset_.pixel_count());
  }

  [[noreturn]] void refuse_flipped(uint32_t count) const {
    const auto flipped = std::find_if(flat_.triangle.begin(), flat_.triangle.end(), [&](const Triangle& t) {
      return !(signed_area_twice(flat_.uv[t[0]], flat_.uv[t[1]], flat_.uv[t[2]]) > 0);
    });
    const auto index = static_cast<std::size_t>(flipped - flat_.triangle.begin());
    refuse(name_of(component_of_chart_[flat_.chart[index]]) + ": " + std::to_string(count) +
           " triangles are flipped in the chart; its triangles are too thin to be laid flat: remesh it");
  }

  const TriangleMesh& mesh_;
  const CleanSurface& clean_;
  const FlatSurface& flat_;
  const ClothAsset& asset_;
  std::vector<uint32_t> component_of_chart_;
};

}  // namespace

void verify(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
            const ClothAsset& asset, const ConvertReport& report) {
  const Verifier verifier(mesh, clean, flat, asset);
  verifier.check_map(raster, report.quality);
  verifier.check_topology(report.represented, report.welded);
  validate(asset);
}

}  // namespace geocloth
