// SPDX-License-Identifier: Apache-2.0
#include "vulkan/inter_resources.h"

#include <algorithm>

#include "rest/self_points.h"
#include "vulkan/upload.h"

namespace geocloth::vulkan {
InterResources::InterResources(const std::shared_ptr<const Context>& context, const InterData& data)
    : points(storage_buffer(context, sizeof(shader::SelfPoint) * data.points.most_points)),
      words(storage_buffer(context, sizeof(uint32_t) * data.points.most_words)),
      params(context, sizeof(shader::ClothParams), vk::BufferUsageFlagBits::eUniformBuffer, Memory::upload) {
  upload(context, data);
}

void InterResources::upload(const std::shared_ptr<const Context>& context, const InterData& data) {
  numbers = data.points.numbers;
  parts = data.parts;
  Upload upload(context);
  upload.to_buffer(points, std::span(data.points.points));
  upload.to_buffer(words, std::span(data.points.words));
  upload.run();
  shader::ClothParams values{};
  set_self_numbers(numbers, values);
  params.as<shader::ClothParams>().front() = values;
}

bool InterResources::has_room_for(const InterData& data) const {
  return std::ranges::equal(parts, data.parts, {}, &InterPart::cloth, &InterPart::cloth) &&
         sizeof(shader::SelfPoint) * data.points.most_points <= points.size() &&
         sizeof(uint32_t) * data.points.most_words <= words.size();
}

}  // namespace geocloth::vulkan
