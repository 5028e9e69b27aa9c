// SPDX-License-Identifier: Apache-2.0
// The geometry image as a value: its invariants, its normals and its binding. Everything that reads an asset relies on
// validate(), so each check names the element that breaks it. Normals are summed per surface point over all of its
// copies (area weights come for free from the cross product), in double precision and in one fixed order, so that
// copies agree bit for bit and a millimetre garment does not underflow.
#include "geocloth/asset/cloth_asset.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/vec3d.h"

namespace geocloth {
namespace {

constexpr float kUnitTolerance = 1e-3F;  ///< of the length of a normal, and of a sum of weights
constexpr float kMaxCoordinate = 1e8F;   ///< [m] beyond it, squares of areas leave the range of a float
constexpr uint8_t kAllSprings = (1U << kSpringCount) - 1U;
constexpr uint8_t kAllCellBits = kCellFirst | kCellSecond | kCellDiagonalLeft;

[[noreturn]] void refuse(const std::string& element, const std::string& problem) {
  throw Error(ErrorCode::invalid_data, element + " " + problem);
}

std::string element(const char* array, std::size_t index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

void check_size(const char* array, std::size_t size, std::size_t expected) {
  if (size != expected) {
    refuse(array, "has " + std::to_string(size) + " entries instead of " + std::to_string(expected));
  }
}

/// Of what a caller gives beside an asset.
void check_count(const char* what, std::size_t count, std::size_t expected) {
  if (count == expected) return;
  throw Error(ErrorCode::invalid_argument,
              std::string(what) + ": " + std::to_string(count) + " are given instead of " + std::to_string(expected));
}

/// @param array, at  name the element; put together only when it is needed
void check_index(const char* array, std::size_t at, std::size_t index, std::size_t count) {
  if (index >= count) refuse(element(array, at), "is " + std::to_string(index) + " of " + std::to_string(count));
}

bool is_coordinate(const Vec3& p) {
  // Written so that NaN fails.
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
}

bool in_unit_range(float value) {
  return value >= 0 && value <= 1;
}

void check_image(const ClothAsset& asset) {
  if (asset.width < 1 || asset.width > kMaxImageSide || asset.height < 1 || asset.height > kMaxImageSide) {
    refuse("the image", "is " + std::to_string(asset.width) + " x " + std::to_string(asset.height) +
                            " pixels; a side has 1 to " + std::to_string(kMaxImageSide));
  }
  if (!(asset.spacing > 0 && asset.spacing <= kMaxCoordinate)) refuse("spacing", "is not a positive length");
  if (asset.chart_count >= kNoChart) refuse("chart_count", "is " + std::to_string(asset.chart_count) + ", too large");
  const std::size_t count = asset.pixel_count();
  check_size("rest_position", asset.rest_position.size(), count);
  check_size("chart", asset.chart.size(), count);
  check_size("spring_mask", asset.spring_mask.size(), count);
  check_size("cell", asset.cell.size(), count);
  check_size("area", asset.area.size(), count);
}

void check_pixels(const ClothAsset& asset) {
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) {
      check_index("chart", i, asset.chart[i], asset.chart_count);
      if (!is_coordinate(asset.rest_position[i])) refuse(element("rest_position", i), "is not a finite position");
      if (!(asset.area[i] > 0 && std::isfinite(asset.area[i]))) refuse(element("area", i), "is not a positive area");
    } else if (asset.rest_position[i] != Vec3{} || asset.area[i] != 0) {
      refuse(element(asset.area[i] != 0 ? "area" : "rest_position", i), "is not zero, but the pixel is not valid");
    }
  }
}

void check_springs(const ClothAsset& asset) {
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.spring_mask[i] == 0) continue;
    if ((asset.spring_mask[i] & ~kAllSprings) != 0) refuse(element("spring_mask", i), "has an unknown bit");
    const auto x = static_cast<int64_t>(i % asset.width), y = static_cast<int64_t>(i / asset.width);
    for (uint32_t s = 0; s < kSpringCount; ++s) {
      if ((asset.spring_mask[i] & (1U << s)) == 0) continue;
      const int64_t to_x = x + kSpringOffset[s][0], to_y = y + kSpringOffset[s][1];
      const bool inside = to_x >= 0 && to_x < asset.width && to_y < asset.height;
      if (!inside || !asset.valid(i) ||
          asset.chart[static_cast<std::size_t>(to_y * asset.width + to_x)] != asset.chart[i]) {
        refuse(element("spring_mask", i), "has bit " + std::to_string(s) + ", but not both ends lie in one chart");
      }
    }
  }
}

void check_cells(const ClothAsset& asset) {
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.cell[i] == 0) continue;
    if ((asset.cell[i] & ~kAllCellBits) != 0) refuse(element("cell", i), "has an unknown bit");
    if (i % asset.width + 1 == asset.width || i / asset.width + 1 == asset.height) {
      refuse(element("cell", i), "is not empty in the last row or column");
    }
  }
  for (const Triangle& t : pixel_triangles(asset)) {
    for (const uint32_t corner : t) {
      if (!asset.valid(corner) || asset.chart[corner] != asset.chart[t[0]]) {
        refuse("the triangle of pixels " + std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " +
                   std::to_string(t[2]),
               "does not lie in one chart");
      }
    }
  }
}

void check_splits(const ClothAsset& asset) {
  const SplitVertexTable& table = asset.splits;
  if (table.offset.empty()) {
    if (!table.pixel.empty()) refuse("splits.pixel", "is not empty, but there is no row");
    return;
  }
  if (table.offset.front() != 0) refuse("splits.offset[0]", "is not 0");
  if (table.offset.back() != table.pixel.size()) refuse("splits.offset", "does not end at the number of pixels");
  std::vector<bool> used(asset.pixel_count(), false);
  uint32_t first_before = 0;
  for (uint32_t row = 0; row < table.rows(); ++row) {
    const uint32_t begin = table.offset[row], end = table.offset[row + 1];
    if (end < begin || end > table.pixel.size() || end - begin < 2) {
      refuse("splits row " + std::to_string(row), "has fewer than two pixels");
    }
    for (uint32_t k = begin; k < end; ++k) {
      const auto refuse_pixel = [k](const char* problem) { refuse(element("splits.pixel", k), problem); };
      const uint32_t pixel = table.pixel[k];
      check_index("splits.pixel", k, pixel, asset.pixel_count());
      if (!asset.valid(pixel)) refuse_pixel("is not a valid pixel");
      if (used[pixel]) refuse_pixel("stands in two rows");
      used[pixel] = true;
      if (k > begin && pixel <= table.pixel[k - 1]) refuse_pixel("is not in ascending order");
      if (asset.rest_position[pixel] != asset.rest_position[table.pixel[begin]]) {
        refuse_pixel("has another rest position than the first copy");
      }
    }
    if (row > 0 && table.pixel[begin] <= first_before) {
      refuse("splits row " + std::to_string(row), "is not in order of its first pixel");
    }
    first_before = table.pixel[begin];
  }
}

void check_seam_bends(const ClothAsset& asset) {
  for (std::size_t i = 0; i < asset.seam_bends.size(); ++i) {
    const SeamBend& bend = asset.seam_bends[i];
    for (const uint32_t pixel : {bend.a, bend.middle, bend.b}) {
      check_index("seam_bends", i, pixel, asset.pixel_count());
      if (!asset.valid(pixel)) refuse(element("seam_bends", i), "names a pixel that is not valid");
    }
    if (bend.a == bend.b || bend.a == bend.middle || bend.b == bend.middle) {
      refuse(element("seam_bends", i), "names a pixel twice");
    }
    if (!(bend.rest_length >= 0 && bend.rest_length <= 4 * kMaxCoordinate)) {
      refuse(element("seam_bends", i), "has a rest length that is not a length");
    }
  }
}

void check_sewing(const ClothAsset& asset) {
  for (std::size_t i = 0; i < asset.sewing.size(); ++i) {
    for (const uint32_t pixel : asset.sewing[i]) {
      check_index("sewing", i, pixel, asset.pixel_count());
      if (!asset.valid(pixel)) refuse(element("sewing", i), "names a pixel that is not valid");
    }
    if (asset.sewing[i][0] == asset.sewing[i][1]) refuse(element("sewing", i), "names a pixel twice");
  }
}

void check_source_vertices(const SourceMesh& source) {
  const std::size_t count = source.position.size();
  if (count == 0 || count > 0xFFFFFFFEU) refuse("source.position", "has no vertices, or too many");
  check_size("source.normal", source.normal.size(), count);
  if (!source.uv.empty()) check_size("source.uv", source.uv.size(), count);
  check_size("source.source_vertex", source.source_vertex.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_coordinate(source.position[i])) refuse(element("source.position", i), "is not a finite position");
    if (!(std::abs(length(source.normal[i]) - 1) <= kUnitTolerance)) {
      refuse(element("source.normal", i), "is not of unit length");
    }
    check_index("source.source_vertex", i, source.source_vertex[i], source.source_vertex_count);
  }
  if (source.middle.size() > source.source_vertex_count) refuse("source.middle", "has more entries than vertices");
  for (std::size_t i = 0; i < source.middle.size(); ++i) {
    for (const uint32_t end : source.middle[i]) {
      check_index("source.middle", i, end, source.file_vertex_count() + static_cast<uint32_t>(i));
    }
  }
  for (std::size_t i = 0; i < source.uv.size(); ++i) {
    if (!std::isfinite(source.uv[i].x) || !std::isfinite(source.uv[i].y)) {
      refuse(element("source.uv", i), "is not finite");
    }
  }
}

void check_parts(const SourceMesh& source) {
  for (std::size_t i = 0; i < source.triangle.size(); ++i) {
    for (const uint32_t v : source.triangle[i]) check_index("source.triangle", i, v, source.position.size());
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < source.part.size(); ++i) {
    const SourcePart& part = source.part[i];
    if (part.first_triangle != next) refuse(element("source.part", i), "does not begin where the part before ends");
    if (part.triangle_count == 0) refuse(element("source.part", i), "has no triangles");
    next += part.triangle_count;
    check_index("source.part.material", i, part.material, source.material.size());
  }
  if (next != source.triangle.size() || next == 0) refuse("source.part", "does not cover all triangles");
}

void check_materials(const SourceMesh& source) {
  for (std::size_t i = 0; i < source.material.size(); ++i) {
    const SourceMaterial& material = source.material[i];
    const std::string what = element("source.material", i);
    if (!std::all_of(material.base_color.begin(), material.base_color.end(), in_unit_range) ||
        !in_unit_range(material.metallic) || !in_unit_range(material.roughness)) {
      refuse(what, "has a factor outside 0..1");
    }
    if (!(material.alpha_cutoff >= 0 && std::isfinite(material.alpha_cutoff))) {
      refuse(what, "has an alpha cutoff that is no number from 0 on");
    }
    if (material.alpha_mask && material.alpha_blend) refuse(what, "is both masked and blended");
    for (const auto& image : {material.base_color_image, material.normal_image, material.metallic_roughness_image}) {
      if (image) check_index("source.material.image", i, *image, source.image.size());
    }
  }
}

bool starts_with(const std::vector<uint8_t>& bytes, std::initializer_list<uint8_t> signature) {
  return bytes.size() >= signature.size() && std::equal(signature.begin(), signature.end(), bytes.begin());
}

void check_images(const SourceMesh& source) {
  for (std::size_t i = 0; i < source.image.size(); ++i) {
    const SourceImage& image = source.image[i];
    const bool png = image.mime_type == "image/png" && starts_with(image.bytes, {0x89, 'P', 'N', 'G', 13, 10, 26, 10});
    const bool jpeg = image.mime_type == "image/jpeg" && starts_with(image.bytes, {0xFF, 0xD8, 0xFF});
    if (!png && !jpeg) refuse(element("source.image", i), "is neither PNG nor JPEG, or not what its type says");
  }
}

void check_binding(const ClothAsset& asset) {
  check_size("binding", asset.binding.size(), asset.source.position.size());
  for (std::size_t i = 0; i < asset.binding.size(); ++i) {
    const Binding& binding = asset.binding[i];
    for (const uint32_t pixel : binding.pixel) {
      check_index("binding", i, pixel, asset.pixel_count());
      if (!asset.valid(pixel)) refuse(element("binding", i), "names a pixel that is not valid");
    }
    const float sum = binding.weight[0] + binding.weight[1] + binding.weight[2];
    if (!(std::abs(sum - 1) <= kUnitTolerance)) refuse(element("binding", i), "has weights that do not sum to 1");
    if (!is_coordinate(binding.offset)) refuse(element("binding", i), "has an offset that is not finite");
  }
}

void check_vertex_groups(const ClothAsset& asset) {
  for (std::size_t g = 0; g < asset.vertex_groups.size(); ++g) {
    for (const uint32_t v : asset.vertex_groups[g].source_vertex) {
      check_index("vertex_groups", g, v, asset.source.source_vertex_count);
    }
  }
}

/// The axes T, B, N at a bound vertex.
struct Frame {
  Vec3d t, b, n;
  [[nodiscard]] Vec3d to_space(const Vec3d& local) const {
    Vec3d sum = t * local.x;
    sum += b * local.y;
    return sum += n * local.z;
  }
};

Frame binding_frame(const Binding& binding, const std::vector<Vec3>& position, const std::vector<Vec3>& normal) {
  Vec3d direction;
  for (std::size_t k = 0; k < 3; ++k) direction += to_double(normal[binding.pixel[k]]) * double{binding.weight[k]};
  const Vec3d n = unit(direction, to_double(normal[binding.pixel[0]]));
  const Vec3d edge = to_double(position[binding.pixel[1]]) - to_double(position[binding.pixel[0]]);
  const Vec3d t = unit(edge - n * dot(edge, n), any_across(n));
  return {t, cross(n, t), n};
}

}  // namespace

const char* to_string(Layout layout) {
  switch (layout) {
    case Layout::square:
      return "square";
    case Layout::panels:
      return "panels";
    case Layout::uv:
      return "uv";
  }
  return "unknown";
}

void add_middles(const SourceMesh& source, std::vector<Vec3>& points) {
  points.reserve(source.source_vertex_count);
  for (const auto& [a, b] : source.middle) points.push_back((points[a] + points[b]) * 0.5F);
}

void validate(const ClothAsset& asset) {
  check_image(asset);
  check_pixels(asset);
  check_springs(asset);
  check_cells(asset);
  check_splits(asset);
  check_seam_bends(asset);
  check_sewing(asset);
  check_source_vertices(asset.source);
  check_parts(asset.source);
  check_materials(asset.source);
  check_images(asset.source);
  check_binding(asset);
  check_vertex_groups(asset);
  if (!asset.paint.empty()) check_size("paint", asset.paint.size(), asset.source.source_vertex_count);
}

uint32_t count_valid_pixels(const ClothAsset& asset) {
  return asset.pixel_count() - static_cast<uint32_t>(std::count(asset.chart.begin(), asset.chart.end(), kNoChart));
}

void compute_normals(const ClothAsset& asset, const std::vector<Vec3>& position, std::vector<Vec3>& normal) {
  check_count("position", position.size(), asset.pixel_count());
  const std::vector<uint32_t> first_copy = first_copies(asset);
  std::vector<Vec3d> sum(asset.pixel_count());
  for (const Triangle& t : pixel_triangles(asset)) {
    const Vec3d a = to_double(position[t[0]]), b = to_double(position[t[1]]), c = to_double(position[t[2]]);
    const Vec3d weighted = cross(b - a, c - a);
    for (const uint32_t pixel : t) sum[first_copy[pixel]] += weighted;
  }
  normal.assign(asset.pixel_count(), Vec3{});
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) continue;
    normal[i] = to_float(unit(sum[first_copy[i]], {0, 1, 0}));
  }
}

void evaluate_binding(const ClothAsset& asset, const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                      std::vector<Vec3>& out, float scale) {
  check_count("position", position.size(), asset.pixel_count());
  check_count("normal", normal.size(), asset.pixel_count());
  out.resize(asset.binding.size());
  for (std::size_t i = 0; i < asset.binding.size(); ++i) {
    const Binding& binding = asset.binding[i];
    Vec3d point = binding_frame(binding, position, normal).to_space(to_double(binding.offset) * double{scale});
    for (std::size_t k = 0; k < 3; ++k) point += to_double(position[binding.pixel[k]]) * double{binding.weight[k]};
    out[i] = to_float(point);
  }
}

Vec3 binding_offset(const Binding& binding, const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                    const Vec3& point, float scale) {
  const Frame frame = binding_frame(binding, position, normal);
  Vec3d rest = to_double(point);
  for (std::size_t k = 0; k < 3; ++k) rest += to_double(position[binding.pixel[k]]) * -double{binding.weight[k]};
  rest = rest * (1 / double{scale});
  return to_float({dot(rest, frame.t), dot(rest, frame.b), dot(rest, frame.n)});
}

std::vector<Vec3> bind_normals(const ClothAsset& asset) {
  std::vector<Vec3> rest_normal, bound;
  compute_normals(asset, asset.rest_position, rest_normal);
  bound.reserve(asset.binding.size());
  for (std::size_t i = 0; i < asset.binding.size(); ++i) {
    const Frame frame = binding_frame(asset.binding[i], asset.rest_position, rest_normal);
    const Vec3d n = to_double(asset.source.normal[i]);
    bound.push_back(to_float({dot(n, frame.t), dot(n, frame.b), dot(n, frame.n)}));
  }
  return bound;
}

void evaluate_bound_normals(const ClothAsset& asset, const std::vector<Vec3>& bound, const std::vector<Vec3>& position,
                            const std::vector<Vec3>& normal, std::vector<Vec3>& out) {
  check_count("bound normals", bound.size(), asset.binding.size());
  check_count("position", position.size(), asset.pixel_count());
  check_count("normal", normal.size(), asset.pixel_count());
  out.resize(asset.binding.size());
  for (std::size_t i = 0; i < asset.binding.size(); ++i) {
    const Frame frame = binding_frame(asset.binding[i], position, normal);
    out[i] = to_float(unit(frame.to_space(to_double(bound[i])), frame.n));
  }
}

double drawn_triangle_size(const ClothAsset& asset) {
  double area = 0, sum = 0;
  for (const Triangle& t : asset.source.triangle) {
    const auto at = [&](size_t k) { return to_double(asset.source.position[t[k]]); };
    const double twice = length(cross(at(1) - at(0), at(2) - at(0)));
    area += twice;
    sum += twice * std::sqrt(twice);
  }
  return area > 0 && asset.spacing > 0 ? sum / area / static_cast<double>(asset.spacing) : 0;
}

}  // namespace geocloth
