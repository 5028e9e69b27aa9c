// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geocloth/solver/vulkan_interop.h"
#include "render/gpu_support.h"
#include "render/render_layout.h"
#include "render/renderer.h"

namespace geocloth::render {

/// Layouts of the descriptor sets 1 (images of a cloth) and 2 (texture of a material).
struct ClothLayouts {
  vk::raii::DescriptorSetLayout images, material;
  explicit ClothLayouts(const ContextPtr& context);
};

/// Vertex of cloth.vert: a Binding and what it looks like.
struct ClothVertex {
  std::array<uint32_t, 3> pixel{};
  std::array<float, 3> weight{};
  Vec3 offset;  ///< [m] in the frame of the binding
  Vec3 normal;  ///< in the frame of the binding
  Vec2 uv;
  Vec2 grid;  ///< [pixels]
  Color color;
};
/// Instance of ribbon.vert.
struct RibbonInstance {
  std::array<uint32_t, 2> pixel{};
  Color color;
};
[[nodiscard]] std::span<const vk::VertexInputAttributeDescription> cloth_attributes();
[[nodiscard]] std::span<const vk::VertexInputAttributeDescription> ribbon_attributes();

/// Lines over a cloth, each drawn on its own.
enum class RibbonLayer : uint8_t { seams, sewing, springs, pins };
inline constexpr size_t kRibbonLayers = 4;
/// Structural and shear springs, one ribbon each.
[[nodiscard]] std::vector<RibbonInstance> spring_ribbons(const ClothAsset& asset);
/// A dot at each pixel.
[[nodiscard]] std::vector<RibbonInstance> pixel_dots(std::span<const uint32_t> pixels, Color color);

/// One run of triangles with one material.
struct ClothRun {
  uint32_t first_index = 0, index_count = 0;
  uint32_t material = 0;  ///< index into the materials of the GpuCloth
};

/// What the device keeps of a garment for one way of showing it.
class GpuCloth {
 public:
  /// @param index  of the cloth in its scene: cloths without colours of their own are told apart
  /// @param lent   the solver's images; else the cloth has its own, filled by upload()
  GpuCloth(const ContextPtr& context, const ClothLayouts& layouts, const RenderCloth& cloth, size_t index, Show show,
           const std::optional<VulkanClothImages>& lent, std::vector<std::string>& warnings);

  /// Puts a state into the staging buffer. The device must not be drawing.
  void upload(const ClothState& state);
  /// What is to be added to the positions of images that a solver lends.
  void set_origin(const Vec3& origin) { origin_ = origin; }
  /// Copies it to the images.
  void record_upload(const vk::raii::CommandBuffer& commands) const;
  /// Draws with the pipeline that is bound.
  void record_draw(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout, bool shadow_pass,
                   float strain_range) const;
  /// What a layer draws from now on; a cloth shown by its seams begins with them. The device must not be drawing.
  void set_ribbons(const ContextPtr& context, RibbonLayer layer, std::span<const RibbonInstance> ribbons);
  /// Nothing where the layer is empty.
  void record_ribbons(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout, RibbonLayer layer,
                      float thickness) const;

 private:
  struct Ribbons {
    std::optional<vulkan::Buffer> instances;
    uint32_t count = 0;
  };
  struct Material {
    shader::vec4 base_color{1, 1, 1, 1};
    float alpha_cutoff = 0;
    vulkan::Image texture;
  };

  void make_geometry(const ContextPtr& context, const RenderCloth& cloth, Show show);
  void make_materials(const ContextPtr& context, const ClothAsset& asset, size_t index, Show show,
                      std::vector<std::string>& warnings);
  void make_images(const ContextPtr& context, const ClothAsset& asset, const std::optional<VulkanClothImages>& lent);
  void make_sets(const ContextPtr& context, const ClothLayouts& layouts, const std::optional<VulkanClothImages>& lent);

  uint32_t width_ = 0, height_ = 0;
  float scale_ = 1;
  Vec3 origin_;
  uint32_t mode_ = 0;
  std::vector<ClothRun> runs_;
  std::vector<Material> materials_;
  std::optional<vulkan::Buffer> vertices_, indices_, staging_;
  std::array<Ribbons, kRibbonLayers> ribbons_;
  std::optional<vulkan::Image> position_, normal_, rest_, heat_scale_;
  vk::raii::Sampler sampler_ = nullptr, clamped_ = nullptr;
  vk::raii::DescriptorPool pool_ = nullptr;
  vk::raii::DescriptorSet images_set_ = nullptr;
  std::vector<vk::raii::DescriptorSet> material_sets_;
};

}  // namespace geocloth::render
