// SPDX-License-Identifier: Apache-2.0
#include "vulkan/cloth_resources.h"

#include <algorithm>
#include <utility>

#include "vulkan/upload.h"

namespace geocloth::vulkan {
namespace {

using ImageUsage = vk::ImageUsageFlagBits;
using BufferUsage = vk::BufferUsageFlagBits;

/// Sampled too, because a renderer may want to; copied from, because files are written.
constexpr vk::ImageUsageFlags kStateUsage =
    ImageUsage::eStorage | ImageUsage::eSampled | ImageUsage::eTransferSrc | ImageUsage::eTransferDst;
constexpr vk::ImageUsageFlags kRestUsage = ImageUsage::eStorage | ImageUsage::eTransferDst;

Image make_image(const std::shared_ptr<const Context>& context, const ClothData& data, vk::ImageUsageFlags usage,
                 vk::Format format = vk::Format::eR32G32B32A32Sfloat) {
  return {context, {.format = format, .extent = {data.width, data.height}, .usage = usage}};
}

}  // namespace

/// [bytes] Of the buffers of which a cut, or another material, may make other ones; after any cut.
struct ClothResources::Lengths {
  Lengths(const ClothData& data, bool with_multipliers)
      : attachments(data.attachments ? sizeof(shader::Attachment) * data.pixel_count() : 0),
        seam_springs(sizeof(shader::SeamSpring) * data.most_seam_springs),
        split_pixel(sizeof(uint32_t) * data.split_pixel.size()),
        self_points(sizeof(shader::SelfPoint) * data.self.most_points),
        self_words(sizeof(uint32_t) * data.self.most_words) {
    // One for each spring component of each pixel and one for each seam bend.
    const size_t components = size_t{shader::kSpringComponents} * data.pixel_count() + data.most_seam_springs;
    if (with_multipliers) multipliers = sizeof(float) * components;
    // Cuts may part a row, but one has at least two copies.
    if (!data.split_pixel.empty()) split_offset = sizeof(uint32_t) * (data.split_pixel.size() / 2 + 1);
  }

  size_t multipliers = 0, attachments, seam_springs, split_offset = 0, split_pixel, self_points, self_words;
};

ClothResources::ClothResources(const std::shared_ptr<const Context>& context, const ClothData& data,
                               bool with_multipliers, bool fine, SolverPath chosen_path)
    : ClothResources(context, data, Lengths(data, with_multipliers), with_multipliers, fine, chosen_path) {}

ClothResources::ClothResources(const std::shared_ptr<const Context>& context, const ClothData& data,
                               const Lengths& lengths, bool with_multipliers, bool fine, SolverPath chosen_path)
    : path(chosen_path),
      width(data.width),
      height(data.height),
      split_rows(data.split_rows()),
      seam_color_offset(data.seam_color_offset),
      self(data.self.numbers),
      position(make_image(context, data, kStateUsage)),
      previous(make_image(context, data, kStateUsage)),
      carry(make_image(context, data, kStateUsage)),
      normal(make_image(context, data, kStateUsage)),
      springs{make_image(context, data, kRestUsage), make_image(context, data, kRestUsage),
              make_image(context, data, kRestUsage)},
      cell(make_image(context, data, kRestUsage, vk::Format::eR32Uint)),
      offset(context, {.format = vk::Format::eR32G32B32A32Sfloat,
                       .extent = fine ? vk::Extent2D{data.width, data.height} : vk::Extent2D{1, 1},
                       .usage = kStateUsage}),
      multipliers(storage_buffer(context, lengths.multipliers)),
      attachments(storage_buffer(context, lengths.attachments)),
      seam_springs(storage_buffer(context, lengths.seam_springs)),
      split_offset(storage_buffer(context, lengths.split_offset)),
      split_pixel(storage_buffer(context, lengths.split_pixel)),
      measures(context, sizeof(uint32_t) * shader::kMeasureCount, BufferUsage::eStorageBuffer, Memory::readback),
      inverse_mass(storage_buffer(context, sizeof(float) * data.pixel_count())),
      self_points(storage_buffer(context, lengths.self_points)),
      self_words(storage_buffer(context, lengths.self_words)),
      pin_of_pixel(storage_buffer(context, path != SolverPath::plain ? sizeof(uint32_t) * data.pixel_count() : 0)),
      with_multipliers_(with_multipliers) {
  Upload upload(context);
  if (path == SolverPath::tiled) {
    scratch.emplace(ScratchImages{make_image(context, data, kRestUsage), make_image(context, data, kRestUsage),
                                  make_image(context, data, kRestUsage)});
    for (const Image* image : {&scratch->position, &scratch->previous, &scratch->carry}) upload.clear_image(*image);
  }
  upload.to_image(position, std::span(data.position));
  upload.to_image(previous, std::span(data.position));
  upload.clear_image(carry);
  upload.clear_image(offset);
  upload.clear_image(normal);
  add_topology(upload, data);
  upload.run();
  std::ranges::fill(measures.as<uint32_t>(), 0U);
}

void ClothResources::add_topology(Upload& upload, const ClothData& data) const {
  for (size_t family = 0; family < springs.size(); ++family)
    upload.to_image(springs[family], std::span(data.springs[family]));
  upload.to_image(cell, std::span(data.cell));
  upload.to_buffer(seam_springs, std::span(data.seam_springs));
  upload.to_buffer(split_offset, std::span(data.split_offset));
  upload.to_buffer(split_pixel, std::span(data.split_pixel));
  upload.to_buffer(self_points, std::span(data.self.points));
  upload.to_buffer(self_words, std::span(data.self.words));
}

bool ClothResources::upload_topology(const std::shared_ptr<const Context>& context, const ClothData& data) {
  const Lengths lengths(data, with_multipliers_);
  bool grown = false;
  for (const auto& [buffer, length] :
       {std::pair{&multipliers, lengths.multipliers}, std::pair{&attachments, lengths.attachments},
        std::pair{&seam_springs, lengths.seam_springs}, std::pair{&split_offset, lengths.split_offset},
        std::pair{&split_pixel, lengths.split_pixel}, std::pair{&self_points, lengths.self_points},
        std::pair{&self_words, lengths.self_words}}) {
    if (buffer->size() >= length) continue;
    *buffer = storage_buffer(context, length);
    grown = true;
  }
  split_rows = data.split_rows();
  seam_color_offset = data.seam_color_offset;
  self = data.self.numbers;
  Upload upload(context);
  add_topology(upload, data);
  upload.run();
  return grown;
}

size_t ClothResources::memory_bytes() const {
  constexpr size_t kVectorImages = 4 + 3;  // position, previous, carry, normal; springs
  const size_t offsets = size_t{offset.extent().width} * offset.extent().height;
  size_t sum =
      pixel_count() * (kVectorImages * sizeof(shader::vec4) + sizeof(uint32_t)) + offsets * sizeof(shader::vec4);
  if (scratch) sum += pixel_count() * 3 * sizeof(shader::vec4);
  for (const Buffer* buffer : {&multipliers, &attachments, &seam_springs, &split_offset, &split_pixel, &measures,
                               &inverse_mass, &self_points, &self_words, &pin_of_pixel})
    sum += buffer->size();
  return sum;
}

}  // namespace geocloth::vulkan
