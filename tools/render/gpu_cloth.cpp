// SPDX-License-Identifier: GPL-3.0-or-later
// A garment on the device. Two meshes over the same images: the source mesh through its binding, or the grid itself,
// whose vertices are pixels (a binding with one weight). Either way cloth.vert draws it.
#include "render/gpu_cloth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "render/canvas.h"
#include "render/color_map.h"
#include "render/seam_lines.h"

namespace geocloth::render {
namespace {

constexpr float kOpaque = -1;  ///< ClothDraw::alpha_cutoff

/// glTF ignores the alpha of what is opaque, and what is cut out is so, too, where there is any of it.
float alpha_cutoff_of(const SourceMaterial& material) {
  if (material.alpha_mask) return material.alpha_cutoff > 0 ? material.alpha_cutoff : kOpaque;
  return material.alpha_blend ? 0 : kOpaque;
}

constexpr vk::Format kFloat4 = vk::Format::eR32G32B32A32Sfloat;
/// For materials without a colour of their own, in order: a garment of several still reads as several. The next cloth
/// begins with the next one.
constexpr std::array<Color, 5> kFabrics{
    {{118, 142, 176, 255}, {186, 132, 108, 255}, {140, 160, 124, 255}, {172, 150, 178, 255}, {196, 176, 128, 255}}};
constexpr Color kPaleFabric{196, 200, 206, 255};  ///< under grid lines and seams
constexpr Color kFreeBorder{24, 26, 32, 255};
constexpr Color kThread{206, 62, 44, 255};
constexpr Color kStructural{28, 32, 44, 255}, kShear{236, 190, 92, 255};  ///< springs, by family
constexpr uint32_t kMaxTextureSide = 1024;  ///< there are no smaller levels: a larger one would only flicker

shader::vec4 linear(Color color) {
  const LinearColor c = to_linear(color);
  return {c.r, c.g, c.b, 1};
}

uint32_t draw_mode(Show show) {
  switch (show) {
    case Show::cloth:
      return shader::kDrawMaterial;
    case Show::grid:
      return shader::kDrawGrid;
    case Show::strain:
      return shader::kDrawStrain;
    case Show::charts:
      return shader::kDrawColor;
    case Show::seams:
      return shader::kDrawMaterial;
  }
  return shader::kDrawMaterial;
}

std::vector<ClothVertex> source_vertices(const RenderCloth& cloth) {
  const ClothAsset& asset = *cloth.asset;
  std::vector<ClothVertex> vertices(asset.binding.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Binding& binding = asset.binding[i];
    vertices[i] = {.pixel = binding.pixel,
                   .weight = binding.weight,
                   .offset = binding.offset,
                   .normal = cloth.bound_normal[i],
                   .uv = asset.source.uv.empty() ? Vec2{} : asset.source.uv[i],
                   .grid = {},
                   .color = {}};
  }
  return vertices;
}

std::vector<ClothVertex> grid_vertices(const ClothAsset& asset) {
  std::vector<ClothVertex> vertices(asset.pixel_count());
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    const uint32_t column = pixel % asset.width, row = pixel / asset.width;
    vertices[pixel] = {.pixel = {pixel, pixel, pixel},
                       .weight = {1, 0, 0},
                       .offset = {},
                       .normal = {0, 0, 1},
                       .uv = {},
                       .grid = {static_cast<float>(column), static_cast<float>(row)},
                       .color = distinct_color(asset.valid(pixel) ? asset.chart[pixel] : 0U)};
  }
  return vertices;
}

std::vector<RibbonInstance> seam_ribbons(const ClothAsset& asset) {
  std::vector<RibbonInstance> ribbons;
  for (const OutlineEdge& edge : find_seam_lines(asset).edge)
    ribbons.push_back({{edge.a, edge.b}, edge.seam == kNoSeam ? kFreeBorder : seam_color(edge.seam)});
  return ribbons;
}

/// From point to point of what is to be sewn together.
std::vector<RibbonInstance> sewing_ribbons(const ClothAsset& asset) {
  std::vector<RibbonInstance> ribbons;
  ribbons.reserve(asset.sewing.size());
  for (const auto& thread : asset.sewing) ribbons.push_back({thread, kThread});
  return ribbons;
}

/// xyz rest position, w which structural springs end at the pixel (kRest*).
std::vector<shader::vec4> rest_texels(const ClothAsset& asset) {
  std::vector<uint32_t> springs(asset.pixel_count(), 0);
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if ((asset.spring_mask[pixel] & kSpringRight) != 0) {
      springs[pixel] |= shader::kRestRight;
      springs[pixel + 1] |= shader::kRestLeft;
    }
    if ((asset.spring_mask[pixel] & kSpringDown) != 0) {
      springs[pixel] |= shader::kRestDown;
      springs[pixel + asset.width] |= shader::kRestUp;
    }
  }
  std::vector<shader::vec4> texels(asset.pixel_count());
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    const Vec3& p = asset.rest_position[pixel];
    texels[pixel] = {p.x, p.y, p.z, static_cast<float>(springs[pixel])};
  }
  return texels;
}

Picture heat_scale() {
  Picture scale(256, 1);
  for (uint32_t i = 0; i < scale.width; ++i) scale.at(i, 0) = diverging_color((static_cast<float>(i) + 0.5F) / 256);
  return scale;
}

}  // namespace

std::vector<RibbonInstance> spring_ribbons(const ClothAsset& asset) {
  std::vector<RibbonInstance> ribbons;
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    const uint32_t mask = asset.spring_mask[pixel], down = pixel + asset.width;
    if ((mask & kSpringRight) != 0) ribbons.push_back({{pixel, pixel + 1}, kStructural});
    if ((mask & kSpringDown) != 0) ribbons.push_back({{pixel, down}, kStructural});
    if ((mask & kSpringDownRight) != 0) ribbons.push_back({{pixel, down + 1}, kShear});
    if ((mask & kSpringDownLeft) != 0) ribbons.push_back({{pixel, down - 1}, kShear});
  }
  return ribbons;
}

std::vector<RibbonInstance> pixel_dots(std::span<const uint32_t> pixels, Color color) {
  std::vector<RibbonInstance> dots;
  dots.reserve(pixels.size());
  for (const uint32_t pixel : pixels) dots.push_back({{pixel, pixel}, color});
  return dots;
}

ClothLayouts::ClothLayouts(const ContextPtr& context)
    : images(make_set_layout(context,
                             std::array{vk::DescriptorType::eSampledImage, vk::DescriptorType::eSampledImage,
                                        vk::DescriptorType::eSampledImage, vk::DescriptorType::eCombinedImageSampler})),
      material(make_set_layout(context, std::array{vk::DescriptorType::eCombinedImageSampler})) {}

std::span<const vk::VertexInputAttributeDescription> cloth_attributes() {
  using Format = vk::Format;
  static const std::array<vk::VertexInputAttributeDescription, 7> attributes{
      {{0, 0, Format::eR32G32B32Uint, offsetof(ClothVertex, pixel)},
       {1, 0, Format::eR32G32B32Sfloat, offsetof(ClothVertex, weight)},
       {2, 0, Format::eR32G32B32Sfloat, offsetof(ClothVertex, offset)},
       {3, 0, Format::eR32G32B32Sfloat, offsetof(ClothVertex, normal)},
       {4, 0, Format::eR32G32Sfloat, offsetof(ClothVertex, uv)},
       {5, 0, Format::eR32G32Sfloat, offsetof(ClothVertex, grid)},
       {6, 0, Format::eR8G8B8A8Unorm, offsetof(ClothVertex, color)}}};
  return attributes;
}

std::span<const vk::VertexInputAttributeDescription> ribbon_attributes() {
  static const std::array<vk::VertexInputAttributeDescription, 2> attributes{
      {{0, 0, vk::Format::eR32G32Uint, offsetof(RibbonInstance, pixel)},
       {1, 0, vk::Format::eR8G8B8A8Unorm, offsetof(RibbonInstance, color)}}};
  return attributes;
}

GpuCloth::GpuCloth(const ContextPtr& context, const ClothLayouts& layouts, const RenderCloth& cloth, size_t index,
                   Show show, const std::optional<VulkanClothImages>& lent, std::vector<std::string>& warnings)
    : width_(cloth.asset->width), height_(cloth.asset->height), scale_(cloth.scale), mode_(draw_mode(show)) {
  make_geometry(context, cloth, show);
  make_materials(context, *cloth.asset, index, show, warnings);
  make_images(context, *cloth.asset, lent);
  make_sets(context, layouts, lent);
}

void GpuCloth::make_geometry(const ContextPtr& context, const RenderCloth& cloth, Show show) {
  const ClothAsset& asset = *cloth.asset;
  const bool source = show == Show::cloth;
  const std::vector<ClothVertex> vertices = source ? source_vertices(cloth) : grid_vertices(asset);
  const std::vector<Triangle> triangles = source ? asset.source.triangle : pixel_triangles(asset);
  vertices_ = filled_buffer(context, std::span(vertices), vk::BufferUsageFlagBits::eVertexBuffer);
  indices_ = filled_buffer(context, std::span(triangles), vk::BufferUsageFlagBits::eIndexBuffer);
  if (source) {
    for (const SourcePart& part : asset.source.part)
      runs_.push_back({3 * part.first_triangle, 3 * part.triangle_count, part.material});
  } else {
    runs_.push_back({0, static_cast<uint32_t>(3 * triangles.size()), 0});
  }
  if (show != Show::seams) return;
  set_ribbons(context, RibbonLayer::seams, seam_ribbons(asset));
  set_ribbons(context, RibbonLayer::sewing, sewing_ribbons(asset));
}

void GpuCloth::set_ribbons(const ContextPtr& context, RibbonLayer layer, std::span<const RibbonInstance> ribbons) {
  Ribbons& target = ribbons_.at(static_cast<size_t>(layer));
  target.count = static_cast<uint32_t>(ribbons.size());
  target.instances.reset();
  if (!ribbons.empty()) target.instances = filled_buffer(context, ribbons, vk::BufferUsageFlagBits::eVertexBuffer);
}

void GpuCloth::make_materials(const ContextPtr& context, const ClothAsset& asset, size_t index, Show show,
                              std::vector<std::string>& warnings) {
  const Picture white(1, 1, {255, 255, 255, 255});
  if (show != Show::cloth) {
    materials_.push_back({linear(kPaleFabric), 0, texture_of(context, white)});
    return;
  }
  size_t plain_count = index;
  for (const SourceMaterial& source : asset.source.material) {
    const auto& c = source.base_color;
    // What modelling programs write for "no material": grey without a texture.
    const bool plain = !source.base_color_image && c[0] == c[1] && c[1] == c[2] && c[0] > 0.1F;
    Picture texture = white;
    if (source.base_color_image) {
      const SourceImage& image = asset.source.image[*source.base_color_image];
      try {
        texture = shrunk_to_fit(decode_picture(std::as_bytes(std::span(image.bytes)), image.name), kMaxTextureSide,
                                kMaxTextureSide);
      } catch (const Error& error) {
        warnings.push_back(std::string(error.what()) + "; drawn in plain colour");
      }
    }
    materials_.push_back(
        {plain ? linear(kFabrics[plain_count++ % kFabrics.size()]) : shader::vec4{c[0], c[1], c[2], c[3]},
         alpha_cutoff_of(source), texture_of(context, texture)});
  }
  if (materials_.empty())
    materials_.push_back({linear(kFabrics[index % kFabrics.size()]), kOpaque, texture_of(context, white)});
}

void GpuCloth::make_images(const ContextPtr& context, const ClothAsset& asset,
                           const std::optional<VulkanClothImages>& lent) {
  const std::vector<shader::vec4> rest = rest_texels(asset);
  rest_ = filled_image(context, kFloat4, {width_, height_}, std::as_bytes(std::span(rest)));
  heat_scale_ = texture_of(context, heat_scale());
  if (lent) {
    origin_ = lent->origin;
    return;
  }
  const std::vector<shader::vec4> nothing(asset.pixel_count(), shader::vec4(0, 0, 0, 0));
  position_ = filled_image(context, kFloat4, {width_, height_}, std::as_bytes(std::span(nothing)));
  normal_ = filled_image(context, kFloat4, {width_, height_}, std::as_bytes(std::span(nothing)));
  staging_ = vulkan::Buffer(context, 2 * sizeof(shader::vec4) * vk::DeviceSize{asset.pixel_count()},
                            vk::BufferUsageFlagBits::eTransferSrc, vulkan::Memory::upload);
}

void GpuCloth::make_sets(const ContextPtr& context, const ClothLayouts& layouts,
                         const std::optional<VulkanClothImages>& lent) {
  const vk::raii::Device& device = context->device();
  const auto materials = static_cast<uint32_t>(materials_.size());
  const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eSampledImage, 3},
                         vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, 1 + materials}};
  pool_ = {device, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                .maxSets = 1 + materials,
                                                .poolSizeCount = static_cast<uint32_t>(sizes.size()),
                                                .pPoolSizes = sizes.data()}};
  const auto make_sampler = [&](vk::SamplerAddressMode mode) {
    return vk::raii::Sampler(device, vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                                           .minFilter = vk::Filter::eLinear,
                                                           .addressModeU = mode,
                                                           .addressModeV = mode});
  };
  sampler_ = make_sampler(vk::SamplerAddressMode::eRepeat);
  clamped_ = make_sampler(vk::SamplerAddressMode::eClampToEdge);
  const auto allocate = [&](const vk::raii::DescriptorSetLayout& layout) {
    const vk::DescriptorSetLayout handle = *layout;
    vk::raii::DescriptorSets sets(device, {.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &handle});
    return std::move(sets.front());
  };
  const auto write = [&](const vk::raii::DescriptorSet& set, uint32_t binding, vk::DescriptorType type,
                         vk::ImageView view, vk::Sampler sampler) {
    const vk::DescriptorImageInfo info{.sampler = sampler, .imageView = view, .imageLayout = vk::ImageLayout::eGeneral};
    device.updateDescriptorSets(
        vk::WriteDescriptorSet{
            .dstSet = *set, .dstBinding = binding, .descriptorCount = 1, .descriptorType = type, .pImageInfo = &info},
        {});
  };
  images_set_ = allocate(layouts.images);
  using Type = vk::DescriptorType;
  write(images_set_, 0, Type::eSampledImage, lent ? vk::ImageView(lent->position_view) : position_->view(), {});
  write(images_set_, 1, Type::eSampledImage, lent ? vk::ImageView(lent->normal_view) : normal_->view(), {});
  write(images_set_, 2, Type::eSampledImage, rest_->view(), {});
  write(images_set_, 3, Type::eCombinedImageSampler, heat_scale_->view(), *clamped_);
  for (const Material& material : materials_) {
    material_sets_.push_back(allocate(layouts.material));
    write(material_sets_.back(), 0, Type::eCombinedImageSampler, material.texture.view(), *sampler_);
  }
}

void GpuCloth::upload(const ClothState& state) {
  const size_t pixels = size_t{width_} * height_;
  if (state.position.size() != pixels || state.normal.size() != pixels)
    throw Error(ErrorCode::invalid_argument, "a cloth state has " + std::to_string(state.position.size()) +
                                                 " pixels, the asset " + std::to_string(pixels));
  const std::span<shader::vec4> texels = staging_->as<shader::vec4>();
  for (size_t i = 0; i < pixels; ++i) {
    const Vec3 &p = state.position[i], &n = state.normal[i];
    texels[i] = {p.x, p.y, p.z, 1};
    texels[pixels + i] = {n.x, n.y, n.z, 0};
  }
}

void GpuCloth::record_upload(const vk::raii::CommandBuffer& commands) const {
  if (!staging_) return;
  const auto copy = [&](const vulkan::Image& image, vk::DeviceSize offset) {
    vulkan::change_layout(commands, image, vk::ImageLayout::eGeneral, vk::ImageLayout::eTransferDstOptimal);
    commands.copyBufferToImage(staging_->handle(), image.handle(), vk::ImageLayout::eTransferDstOptimal,
                               image.whole_copy(offset));
    vulkan::change_layout(commands, image, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eGeneral);
  };
  copy(*position_, 0);
  copy(*normal_, sizeof(shader::vec4) * vk::DeviceSize{width_} * height_);
}

void GpuCloth::record_draw(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout, bool shadow_pass,
                           float strain_range) const {
  commands.bindVertexBuffers(0, vertices_->handle(), vk::DeviceSize{0});
  commands.bindIndexBuffer(indices_->handle(), 0, vk::IndexType::eUint32);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, layout, 1, *images_set_, {});
  for (const ClothRun& run : runs_) {
    const size_t material = run.material < materials_.size() ? run.material : 0;
    const shader::ClothDraw draw{.base_color = materials_[material].base_color,
                                 .origin = {origin_.x, origin_.y, origin_.z, 0},
                                 .width = width_,
                                 .mode = mode_,
                                 .shadow_pass = shadow_pass ? 1U : 0U,
                                 .scale = scale_,
                                 .alpha_cutoff = materials_[material].alpha_cutoff,
                                 .strain_range = strain_range};
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, layout, 2, *material_sets_[material], {});
    commands.pushConstants<shader::ClothDraw>(
        layout, vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment, 0, draw);
    commands.drawIndexed(run.index_count, 1, run.first_index, 0, 0);
  }
}

void GpuCloth::record_ribbons(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout, RibbonLayer layer,
                              float thickness) const {
  const Ribbons& ribbons = ribbons_.at(static_cast<size_t>(layer));
  if (ribbons.count == 0) return;
  const shader::RibbonDraw draw{
      .origin = {origin_.x, origin_.y, origin_.z, 0}, .width = width_, .thickness = thickness};
  commands.bindVertexBuffers(0, ribbons.instances->handle(), vk::DeviceSize{0});
  commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, layout, 1, *images_set_, {});
  commands.pushConstants<shader::RibbonDraw>(
      layout, vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment, 0, draw);
  commands.draw(6, ribbons.count, 0, 0);
}

}  // namespace geocloth::render
