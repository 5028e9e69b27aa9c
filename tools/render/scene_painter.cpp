// SPDX-License-Identifier: GPL-3.0-or-later
// One picture: a shadow map from the key light, then background, ground, colliders and cloth with four samples a pixel.
// The cloth's vertices are fetched from the position and normal images through the binding, in both passes.
#include "render/scene_painter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "background_frag.h"
#include "background_vert.h"
#include "cloth_frag.h"
#include "cloth_vert.h"
#include "geocloth/asset/error.h"
#include "render/gpu_cloth.h"
#include "render/gpu_target.h"
#include "render/render_layout.h"
#include "render/solid_mesh.h"
#include "ribbon_frag.h"
#include "ribbon_vert.h"
#include "solid_frag.h"
#include "solid_vert.h"

namespace geocloth::render {
namespace {

constexpr uint32_t kShadowSide = 2048;  ///< [pixels]
constexpr auto kBothStages = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
constexpr uint32_t kPushBytes = 128;  ///< what every device has
static_assert(sizeof(shader::ClothDraw) <= kPushBytes && sizeof(shader::SolidDraw) <= kPushBytes &&
              sizeof(shader::RibbonDraw) <= kPushBytes);

struct SolidVertex {
  Vec3 position, normal;
};

struct GpuSolid {
  vulkan::Buffer vertices, indices;
  uint32_t index_count;
};

/// What is drawn with which pipeline.
struct Pipelines {
  vk::raii::Pipeline background, solid, solid_shadow, cloth, cloth_shadow, ribbon;
};

shader::vec4 to_vec4(const Vec3& v, float w) {
  return {v.x, v.y, v.z, w};
}

shader::mat4 to_mat4(const Matrix4& m) {
  shader::mat4 result;
  for (size_t i = 0; i < 4; ++i) result.column[i] = {m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]};
  return result;
}

shader::mat4 to_mat4(const Transform& pose) {
  const Vec3 x = rotate(pose.rotate, {1, 0, 0}) * pose.scale, y = rotate(pose.rotate, {0, 1, 0}) * pose.scale,
             z = rotate(pose.rotate, {0, 0, 1}) * pose.scale;
  return {{to_vec4(x, 0), to_vec4(y, 0), to_vec4(z, 0), to_vec4(pose.translate, 1)}};
}

GpuSolid upload_solid(const ContextPtr& context, const SolidMesh& mesh) {
  std::vector<SolidVertex> vertices;
  for (size_t i = 0; i < mesh.position.size(); ++i) vertices.push_back({mesh.position[i], mesh.normal[i]});
  return {filled_buffer(context, std::span<const SolidVertex>(vertices), vk::BufferUsageFlagBits::eVertexBuffer),
          filled_buffer(context, std::span(mesh.triangle), vk::BufferUsageFlagBits::eIndexBuffer),
          static_cast<uint32_t>(3 * mesh.triangle.size())};
}

std::span<const vk::VertexInputAttributeDescription> solid_attributes() {
  static const std::array<vk::VertexInputAttributeDescription, 2> attributes{
      {{0, 0, vk::Format::eR32G32B32Sfloat, offsetof(SolidVertex, position)},
       {1, 0, vk::Format::eR32G32B32Sfloat, offsetof(SolidVertex, normal)}}};
  return attributes;
}

Pipelines make_pipelines(const ContextPtr& context, vk::PipelineLayout layout, vk::RenderPass picture,
                         const ShadowTarget& shadow) {
  const vk::VertexInputBindingDescription solid{.stride = sizeof(SolidVertex)}, cloth{.stride = sizeof(ClothVertex)},
      ribbon{.stride = sizeof(RibbonInstance), .inputRate = vk::VertexInputRate::eInstance};
  const auto drawn = [&](std::span<const uint32_t> vertex, std::span<const uint32_t> fragment,
                         const vk::VertexInputBindingDescription& binding,
                         std::span<const vk::VertexInputAttributeDescription> attributes, bool depth, bool coverage) {
    return make_pipeline(context, layout, picture,
                         {.vertex = vertex,
                          .fragment = fragment,
                          .vertex_binding = binding,
                          .attributes = attributes,
                          .depth = depth,
                          .alpha_to_coverage = coverage});
  };
  const auto shadowed = [&](std::span<const uint32_t> vertex, const vk::VertexInputBindingDescription& binding,
                            std::span<const vk::VertexInputAttributeDescription> attributes) {
    return make_pipeline(context, layout, shadow.render_pass(),
                         {.vertex = vertex,
                          .fragment = {},
                          .vertex_binding = binding,
                          .attributes = attributes,
                          .samples = vk::SampleCountFlagBits::e1,
                          .depth_bias = true});
  };
  return {.background = drawn(background_vert, background_frag, {}, {}, false, false),
          .solid = drawn(solid_vert, solid_frag, solid, solid_attributes(), true, false),
          .solid_shadow = shadowed(solid_vert, solid, solid_attributes()),
          .cloth = drawn(cloth_vert, cloth_frag, cloth, cloth_attributes(), true, true),
          .cloth_shadow = shadowed(cloth_vert, cloth, cloth_attributes()),
          .ribbon = drawn(ribbon_vert, ribbon_frag, ribbon, ribbon_attributes(), true, false)};
}

vk::raii::PipelineLayout make_layout(const ContextPtr& context, std::span<const vk::DescriptorSetLayout> sets) {
  const vk::PushConstantRange push{.stageFlags = kBothStages, .size = kPushBytes};
  return {context->device(), vk::PipelineLayoutCreateInfo{.setLayoutCount = static_cast<uint32_t>(sets.size()),
                                                          .pSetLayouts = sets.data(),
                                                          .pushConstantRangeCount = 1,
                                                          .pPushConstantRanges = &push}};
}

/// Unit vector to the key light: over the viewer's left shoulder.
Vec3 key_light(const Camera& camera) {
  const Vec3 back = camera.eye - camera.target;
  const Vec3 level = Vec3{back.x, 0, back.z};
  const Vec3 towards = length(level) > 1e-6F ? normalized(level) : Vec3{0, 0, 1};
  const Vec3 right = cross(Vec3{0, 1, 0}, towards);
  return normalized(towards * 0.75F - right * 0.65F + Vec3{0, 1.15F, 0});
}

/// The plane whose mesh is a square of 2 x 2 in xz, `half` times enlarged about the point of the plane nearest to what
/// is shown, moved to whole steps so that its grid stays where it is in the world.
Transform plane_pose(const Vec3& point, const Vec3& normal, const Vec3& center, float half, float step) {
  const Vec3 up{0, 1, 0};
  const Vec3 axis = cross(up, normal);
  Quat turn;
  if (length(axis) > 1e-6F) {
    const float half_angle = std::atan2(length(axis), dot(up, normal)) / 2;
    const Vec3 a = normalized(axis) * std::sin(half_angle);
    turn = {a.x, a.y, a.z, std::cos(half_angle)};
  } else if (normal.y < 0) {
    turn = {1, 0, 0, 0};
  }
  const Vec3 x = rotate(turn, {1, 0, 0}), z = rotate(turn, {0, 0, 1});
  const auto whole = [step](float v) { return std::round(v / step) * step; };
  const Vec3 along = center - point;
  return {point + x * whole(dot(along, x)) + z * whole(dot(along, z)), turn, half};
}

}  // namespace

class ScenePainter::Impl {
 public:
  Impl(ContextPtr context, const RenderScene& scene, Show show, vk::RenderPass picture_pass, Solver* lender)
      : subject_(scene.subject),
        context_(std::move(context)),
        lender_(lender),
        frame_layout_(make_set_layout(
            context_, std::array{vk::DescriptorType::eUniformBuffer, vk::DescriptorType::eCombinedImageSampler})),
        cloth_layouts_(context_),
        layout_(make_layout(context_, std::array{*frame_layout_, *cloth_layouts_.images, *cloth_layouts_.material})),
        shadow_(context_, kShadowSide),
        pipelines_(make_pipelines(context_, *layout_, picture_pass, shadow_)),
        frame_(context_, sizeof(shader::FrameParams), vk::BufferUsageFlagBits::eUniformBuffer, vulkan::Memory::upload),
        ground_(upload_solid(context_, ground_mesh())) {
    for (size_t i = 0; i < scene.cloths.size(); ++i) cloths_.push_back(make_cloth(i, scene.cloths[i], show));
    for (const Collider& collider : scene.colliders) solids_.push_back(make_solid(collider));
    colliders_ = scene.colliders;
    find_ground_height(scene);
    make_frame_set();
  }

  void set_cloth(size_t index, const RenderCloth& cloth, Show show) {
    cloths_.at(index) = make_cloth(index, cloth, show);
  }
  void set_lender(Solver* lender) { lender_ = lender; }
  void set_ribbons(size_t cloth, RibbonLayer layer, std::span<const RibbonInstance> ribbons) {
    cloths_.at(cloth)->set_ribbons(context_, layer, ribbons);
  }
  void set_camera(const Camera& camera) { camera_ = camera; }
  void set_subject(const Bounds& subject) { subject_ = subject; }

  void prepare(vk::Extent2D extent, std::span<const Collider> colliders, std::span<const ClothState> states) {
    if (colliders.size() != solids_.size() || (lender_ == nullptr && states.size() != cloths_.size()))
      throw Error(ErrorCode::invalid_argument, "a picture needs a pose of every collider and a state of every cloth");
    for (size_t i = 0; i < cloths_.size(); ++i) {
      if (lender_ == nullptr) {
        cloths_[i]->upload(states[i]);
      } else {
        cloths_[i]->set_origin(vulkan_origin(*lender_));
      }
    }
    for (size_t i = 0; i < solids_.size(); ++i)
      if (has_deformed(colliders_[i], colliders[i])) solids_[i] = make_solid(colliders[i]);
    colliders_.assign(colliders.begin(), colliders.end());
    extent_ = extent;
    write_frame_params();
  }

  void record_before(const vk::raii::CommandBuffer& commands, const Layers& layers) const {
    for (const auto& cloth : cloths_) cloth->record_upload(commands);
    shadow_.begin(commands);
    bind(commands, pipelines_.solid_shadow);
    if (layers.colliders) draw_colliders(commands, true);
    bind(commands, pipelines_.cloth_shadow);
    for (const auto& cloth : cloths_) cloth->record_draw(commands, *layout_, true, layers.strain_range);
    shadow_.end(commands);
  }

  void record_picture(const vk::raii::CommandBuffer& commands, const Layers& layers) const {
    bind(commands, pipelines_.background);
    commands.draw(3, 1, 0, 0);
    bind(commands, pipelines_.solid);
    draw_grounds(commands);
    if (layers.colliders) draw_colliders(commands, false);
    bind(commands, pipelines_.cloth);
    for (const auto& cloth : cloths_) cloth->record_draw(commands, *layout_, false, layers.strain_range);
    bind(commands, pipelines_.ribbon);
    const auto height = static_cast<float>(extent_.height);
    const auto draw = [&](RibbonLayer layer, float thickness) {
      for (const auto& cloth : cloths_) cloth->record_ribbons(commands, *layout_, layer, thickness);
    };
    draw(RibbonLayer::seams, std::max(2.F, height / 180));
    draw(RibbonLayer::sewing, std::max(1.F, height / 500));
    if (layers.springs) draw(RibbonLayer::springs, std::max(1.F, height / 600));
    if (layers.pins) draw(RibbonLayer::pins, std::max(5.F, height / 100));
  }

  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::unique_ptr<GpuCloth> make_cloth(size_t index, const RenderCloth& cloth, Show show) {
    std::optional<VulkanClothImages> lent;
    if (lender_ != nullptr) lent = vulkan_images(*lender_, static_cast<uint32_t>(index));
    return std::make_unique<GpuCloth>(context_, cloth_layouts_, cloth, index, show, lent, warnings_);
  }

  void find_ground_height(const RenderScene& scene) {
    has_plane_ =
        std::ranges::any_of(scene.colliders, [](const Collider& c) { return std::holds_alternative<Plane>(c.shape); });
    ground_height_ = scene.ground_height.value_or(subject_.empty() ? 0 : subject_.low.y - 0.03F * subject_.diagonal());
  }

  void make_frame_set() {
    const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, 1},
                           vk::DescriptorPoolSize{vk::DescriptorType::eCombinedImageSampler, 1}};
    pool_ = {context_->device(),
             vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                          .maxSets = 1,
                                          .poolSizeCount = static_cast<uint32_t>(sizes.size()),
                                          .pPoolSizes = sizes.data()}};
    const vk::DescriptorSetLayout layout = *frame_layout_;
    frame_set_ =
        std::move(vk::raii::DescriptorSets(context_->device(),
                                           {.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &layout})
                      .front());
    const vk::DescriptorBufferInfo buffer{.buffer = frame_.handle(), .range = sizeof(shader::FrameParams)};
    const vk::DescriptorImageInfo shadow = shadow_.sampled();
    context_->device().updateDescriptorSets(
        std::array{vk::WriteDescriptorSet{.dstSet = *frame_set_,
                                          .dstBinding = 0,
                                          .descriptorCount = 1,
                                          .descriptorType = vk::DescriptorType::eUniformBuffer,
                                          .pBufferInfo = &buffer},
                   vk::WriteDescriptorSet{.dstSet = *frame_set_,
                                          .dstBinding = 1,
                                          .descriptorCount = 1,
                                          .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                          .pImageInfo = &shadow}},
        {});
  }

  /// Radius of what the picture is about [m].
  [[nodiscard]] float radius() const { return std::max(subject_.diagonal() / 2, 1e-4F); }
  [[nodiscard]] Vec3 center() const { return subject_.empty() ? Vec3{} : subject_.center(); }
  /// Distance of grid lines: a power of ten.
  [[nodiscard]] float grid_step() const { return std::pow(10.F, std::floor(std::log10(radius() * 0.4F))); }

  void write_frame_params() {
    const float aspect = static_cast<float>(extent_.width) / static_cast<float>(extent_.height);
    const float distance = length(camera_.eye - center()), reach = 12 * radius();
    const float near = std::max(0.02F * radius(), (distance - 3 * radius()) * 0.3F);
    const Vec3 light = key_light(camera_);
    const float half = 1.25F * radius(), depth = 6 * radius();
    const shader::FrameParams params{
        .view_projection = to_mat4(perspective(camera_.field_of_view_deg, aspect, near, distance + reach) *
                                   look_at(camera_.eye, camera_.target)),
        .light_projection =
            to_mat4(orthographic(half, half, 0, 2 * depth) * look_at(center() + light * depth, center())),
        .eye = to_vec4(camera_.eye, 1),
        .to_light = to_vec4(light, 2 * half / kShadowSide),
        .center = to_vec4(center(), radius()),
        .viewport = {static_cast<float>(extent_.width), static_cast<float>(extent_.height), 0, 0}};
    frame_.as<shader::FrameParams>()[0] = params;
  }

  void bind(const vk::raii::CommandBuffer& commands, const vk::raii::Pipeline& pipeline) const {
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, *frame_set_, {});
  }

  [[nodiscard]] std::optional<GpuSolid> make_solid(const Collider& collider) const {
    const SolidMesh mesh = solid_mesh(collider.shape);
    return mesh.triangle.empty() ? std::nullopt : std::optional(upload_solid(context_, mesh));
  }

  static bool has_deformed(const Collider& before, const Collider& now) {
    const auto* body = std::get_if<MeshSolid>(&now.shape);
    return body != nullptr && !(before.shape == now.shape);
  }

  void draw_solid(const vk::raii::CommandBuffer& commands, const GpuSolid& solid, const shader::SolidDraw& draw) const {
    commands.bindVertexBuffers(0, solid.vertices.handle(), vk::DeviceSize{0});
    commands.bindIndexBuffer(solid.indices.handle(), 0, vk::IndexType::eUint32);
    commands.pushConstants<shader::SolidDraw>(*layout_, kBothStages, 0, draw);
    commands.drawIndexed(solid.index_count, 1, 0, 0, 0);
  }

  void draw_colliders(const vk::raii::CommandBuffer& commands, bool shadow_pass) const {
    for (size_t i = 0; i < colliders_.size(); ++i)
      if (solids_[i])
        draw_solid(commands, *solids_[i],
                   {.model = to_mat4(colliders_[i].pose),
                    .base_color = {0.50F, 0.47F, 0.44F, 1},
                    .shadow_pass = shadow_pass ? 1U : 0U,
                    .ground = 0,
                    .grid_scale = 1,
                    .grid_step = 1});
  }

  void draw_plane(const vk::raii::CommandBuffer& commands, const Vec3& point, const Vec3& normal) const {
    const float half = 10 * radius(), step = grid_step();
    draw_solid(commands, ground_,
               {.model = to_mat4(plane_pose(point, normal, center(), half, 10 * step)),
                .base_color = {0.46F, 0.47F, 0.49F, 1},
                .shadow_pass = 0,
                .ground = 1,
                .grid_scale = half,
                .grid_step = step});
  }

  void draw_grounds(const vk::raii::CommandBuffer& commands) const {
    for (const Collider& collider : colliders_)
      if (const auto* plane = std::get_if<Plane>(&collider.shape))
        draw_plane(commands, apply(collider.pose, plane->point), rotate(collider.pose.rotate, plane->normal));
    if (!has_plane_) draw_plane(commands, {0, ground_height_, 0}, {0, 1, 0});
  }

  Bounds subject_;
  ContextPtr context_;
  Solver* lender_;
  std::vector<std::string> warnings_;
  vk::raii::DescriptorSetLayout frame_layout_;
  ClothLayouts cloth_layouts_;
  vk::raii::PipelineLayout layout_;
  ShadowTarget shadow_;
  Pipelines pipelines_;
  vulkan::Buffer frame_;
  vk::raii::DescriptorPool pool_ = nullptr;
  vk::raii::DescriptorSet frame_set_ = nullptr;
  GpuSolid ground_;
  std::vector<std::unique_ptr<GpuCloth>> cloths_;  ///< a descriptor pool may not be moved over: its sets die later
  std::vector<std::optional<GpuSolid>> solids_;
  std::vector<Collider> colliders_;  ///< in their poses
  Camera camera_;
  vk::Extent2D extent_{1, 1};
  bool has_plane_ = false;
  float ground_height_ = 0;
};

ScenePainter::ScenePainter(ContextPtr context, const RenderScene& scene, Show show, vk::RenderPass picture_pass,
                           Solver* lender)
    : impl_(std::make_unique<Impl>(std::move(context), scene, show, picture_pass, lender)) {}
ScenePainter::~ScenePainter() = default;

void ScenePainter::set_cloth(size_t index, const RenderCloth& cloth, Show show) {
  impl_->set_cloth(index, cloth, show);
}
void ScenePainter::set_lender(Solver* lender) {
  impl_->set_lender(lender);
}
void ScenePainter::set_ribbons(size_t cloth, RibbonLayer layer, std::span<const RibbonInstance> ribbons) {
  impl_->set_ribbons(cloth, layer, ribbons);
}
void ScenePainter::set_camera(const Camera& camera) {
  impl_->set_camera(camera);
}
void ScenePainter::set_subject(const Bounds& subject) {
  impl_->set_subject(subject);
}
void ScenePainter::prepare(vk::Extent2D extent, std::span<const Collider> colliders,
                           std::span<const ClothState> states) {
  impl_->prepare(extent, colliders, states);
}
void ScenePainter::record_before(const vk::raii::CommandBuffer& commands, const Layers& layers) const {
  impl_->record_before(commands, layers);
}
void ScenePainter::record_picture(const vk::raii::CommandBuffer& commands, const Layers& layers) const {
  impl_->record_picture(commands, layers);
}
const std::vector<std::string>& ScenePainter::warnings() const {
  return impl_->warnings();
}

}  // namespace geocloth::render
