// SPDX-License-Identifier: GPL-3.0-or-later
// The Vulkan backend that Debian ships in libimgui calls libvulkan by name, which would then have to be there for every
// other command too, and it writes colours as they are into targets that are not sRGB. So the lists of triangles are
// drawn here, with the pipelines of the renderer; all of the widgets are the library's.
#include "view/panel_painter.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <imgui.h>

#include "panel_frag.h"
#include "panel_vert.h"
#include "render/render_layout.h"

namespace geocloth::view {
namespace {

using render::ContextPtr;

constexpr auto kBothStages = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
constexpr vk::IndexType kIndexType = sizeof(ImDrawIdx) == 2 ? vk::IndexType::eUint16 : vk::IndexType::eUint32;

vulkan::Image glyph_texture(const ContextPtr& context) {
  unsigned char* coverage = nullptr;
  int width = 0, height = 0;
  ImGui::GetIO().Fonts->GetTexDataAsAlpha8(&coverage, &width, &height);
  const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
  return render::filled_image(context, vk::Format::eR8Unorm,
                              {static_cast<uint32_t>(width), static_cast<uint32_t>(height)},
                              std::as_bytes(std::span(coverage, count)));
}

vk::raii::PipelineLayout make_layout(const ContextPtr& context, vk::DescriptorSetLayout set) {
  const vk::PushConstantRange push{.stageFlags = kBothStages, .size = sizeof(shader::PanelDraw)};
  return {context->device(),
          vk::PipelineLayoutCreateInfo{
              .setLayoutCount = 1, .pSetLayouts = &set, .pushConstantRangeCount = 1, .pPushConstantRanges = &push}};
}

vk::raii::Pipeline make_pipeline(const ContextPtr& context, vk::PipelineLayout layout, vk::RenderPass pass) {
  const std::array<vk::VertexInputAttributeDescription, 3> attributes{
      {{0, 0, vk::Format::eR32G32Sfloat, offsetof(ImDrawVert, pos)},
       {1, 0, vk::Format::eR32G32Sfloat, offsetof(ImDrawVert, uv)},
       {2, 0, vk::Format::eR8G8B8A8Unorm, offsetof(ImDrawVert, col)}}};
  return render::make_pipeline(context, layout, pass,
                               {.vertex = panel_vert,
                                .fragment = panel_frag,
                                .vertex_binding = {.stride = sizeof(ImDrawVert)},
                                .attributes = attributes,
                                .depth = false,
                                .blend = true});
}

vk::raii::DescriptorPool make_pool(const ContextPtr& context) {
  const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 1};
  return {context->device(), vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                          .maxSets = 1,
                                                          .poolSizeCount = 1,
                                                          .pPoolSizes = &size}};
}

/// A buffer of at least so many bytes, with room to grow.
void make_room(const ContextPtr& context, std::optional<vulkan::Buffer>& buffer, vk::DeviceSize bytes,
               vk::BufferUsageFlags usage) {
  if (buffer && buffer->size() >= bytes) return;
  buffer.emplace(context, bytes + bytes / 2, usage, vulkan::Memory::upload);
}

/// A clip rectangle of the library in pixels of the picture; empty where nothing is left of it.
vk::Rect2D clip_of(const ImDrawData& data, const ImVec4& rectangle) {
  const auto to_pixels = [](float at, float corner, float scale, float limit) {
    return static_cast<int32_t>(std::clamp((at - corner) * scale, 0.F, limit));
  };
  const ImVec2 &corner = data.DisplayPos, &scale = data.FramebufferScale, &size = data.DisplaySize;
  const int32_t left = to_pixels(rectangle.x, corner.x, scale.x, size.x * scale.x),
                right = to_pixels(rectangle.z, corner.x, scale.x, size.x * scale.x),
                top = to_pixels(rectangle.y, corner.y, scale.y, size.y * scale.y),
                bottom = to_pixels(rectangle.w, corner.y, scale.y, size.y * scale.y);
  return {{left, top},
          {static_cast<uint32_t>(std::max(right - left, 0)), static_cast<uint32_t>(std::max(bottom - top, 0))}};
}

}  // namespace

PanelPainter::PanelPainter(ContextPtr context, vk::RenderPass picture_pass)
    : context_(std::move(context)),
      glyphs_(glyph_texture(context_)),
      set_layout_(render::make_set_layout(context_, std::array{vk::DescriptorType::eCombinedImageSampler})),
      layout_(make_layout(context_, *set_layout_)),
      pipeline_(make_pipeline(context_, *layout_, picture_pass)),
      sampler_(context_->device(),
               vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear, .minFilter = vk::Filter::eLinear}),
      pool_(make_pool(context_)) {
  const vk::DescriptorSetLayout layout = *set_layout_;
  set_ = std::move(vk::raii::DescriptorSets(context_->device(),
                                            {.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &layout})
                       .front());
  const vk::DescriptorImageInfo image{
      .sampler = *sampler_, .imageView = glyphs_.view(), .imageLayout = vk::ImageLayout::eGeneral};
  context_->device().updateDescriptorSets(
      vk::WriteDescriptorSet{.dstSet = *set_,
                             .dstBinding = 0,
                             .descriptorCount = 1,
                             .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                             .pImageInfo = &image},
      {});
}

void PanelPainter::prepare(const ImDrawData& data) {
  runs_.clear();
  if (data.TotalVtxCount == 0) return;
  corner_size_ = {data.DisplayPos.x, data.DisplayPos.y, data.DisplaySize.x, data.DisplaySize.y};
  make_room(context_, vertices_, sizeof(ImDrawVert) * static_cast<size_t>(data.TotalVtxCount),
            vk::BufferUsageFlagBits::eVertexBuffer);
  make_room(context_, indices_, sizeof(ImDrawIdx) * static_cast<size_t>(data.TotalIdxCount),
            vk::BufferUsageFlagBits::eIndexBuffer);
  const std::span<ImDrawVert> vertices = vertices_->as<ImDrawVert>();
  const std::span<ImDrawIdx> indices = indices_->as<ImDrawIdx>();
  uint32_t first_vertex = 0, first_index = 0;
  for (const ImDrawList* list : std::span(data.CmdLists, static_cast<size_t>(data.CmdListsCount))) {
    std::copy(list->VtxBuffer.begin(), list->VtxBuffer.end(), vertices.begin() + first_vertex);
    std::copy(list->IdxBuffer.begin(), list->IdxBuffer.end(), indices.begin() + first_index);
    for (const ImDrawCmd& command : list->CmdBuffer) {
      const vk::Rect2D clip = clip_of(data, command.ClipRect);
      if (command.UserCallback != nullptr || clip.extent.width == 0 || clip.extent.height == 0) continue;
      runs_.push_back({clip, first_index + command.IdxOffset, command.ElemCount,
                       static_cast<int32_t>(first_vertex + command.VtxOffset)});
    }
    first_vertex += static_cast<uint32_t>(list->VtxBuffer.Size);
    first_index += static_cast<uint32_t>(list->IdxBuffer.Size);
  }
}

void PanelPainter::record(const vk::raii::CommandBuffer& commands, vk::Extent2D extent) const {
  if (runs_.empty()) return;
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline_);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, *set_, {});
  commands.bindVertexBuffers(0, vertices_->handle(), vk::DeviceSize{0});
  commands.bindIndexBuffer(indices_->handle(), 0, kIndexType);
  const auto& [x, y, width, height] = corner_size_;
  commands.pushConstants<shader::PanelDraw>(*layout_, kBothStages, 0, shader::PanelDraw{{x, y, width, height}});
  for (const Run& run : runs_) {
    // The window may have become smaller since the widgets were laid out.
    const auto inside = [](int32_t at, uint32_t size, uint32_t limit) {
      const auto start = static_cast<uint32_t>(at);
      return start < limit ? std::min(size, limit - start) : 0U;
    };
    const vk::Extent2D left{inside(run.clip.offset.x, run.clip.extent.width, extent.width),
                            inside(run.clip.offset.y, run.clip.extent.height, extent.height)};
    if (left.width == 0 || left.height == 0) continue;
    commands.setScissor(0, vk::Rect2D{run.clip.offset, left});
    commands.drawIndexed(run.index_count, 1, run.first_index, run.first_vertex, 0);
  }
}

}  // namespace geocloth::view
