// SPDX-License-Identifier: Apache-2.0
// Every physical device is looked at and either taken or refused with a sentence per missing thing, as vk-bootstrap
// does, so that `geocloth devices` and an error can say why. Software devices (lavapipe) are for tests: they are taken
// only when nothing else is there, or when they are named.
#include "vulkan/candidate.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "device_name.h"
#include "geocloth/asset/error.h"
#include "vulkan/bindings.h"
#include "vulkan/instance.h"

namespace geocloth::vulkan {
namespace {

const char* type_name(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete gpu";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated gpu";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual gpu";
    default:
      return "software";
  }
}

uint64_t device_memory(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
  uint64_t bytes = 0;
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      bytes = std::max(bytes, uint64_t{memory.memoryHeaps[i].size});
  return bytes;
}

/// Name and version of the driver in its own words, where the device can tell. Only for devices of an instance of ours:
/// an application's may be too old for the question.
std::optional<std::string> driver_name(const vk::raii::PhysicalDevice& device) {
  if (device.getProperties().apiVersion < VK_API_VERSION_1_2) return std::nullopt;
  const auto chain = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  return std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
}

/// First family that can compute and draw, else the first that can compute; its size when there is none.
uint32_t find_queue_family(const std::vector<vk::QueueFamilyProperties>& families) {
  const auto first_with = [&](vk::QueueFlags flags) {
    const auto it = std::ranges::find_if(families, [&](const auto& f) { return (f.queueFlags & flags) == flags; });
    return static_cast<uint32_t>(it - families.begin());
  };
  const uint32_t both = first_with(vk::QueueFlagBits::eCompute | vk::QueueFlagBits::eGraphics);
  return both < families.size() ? both : first_with(vk::QueueFlagBits::eCompute);
}

/// One sentence for everything that the solver needs and the device lacks.
std::string missing_things(const vk::raii::PhysicalDevice& device, const vk::PhysicalDeviceProperties& properties,
                           bool has_queue) {
  std::string reason;
  const auto add = [&](const std::string& sentence) { reason += (reason.empty() ? "" : " ") + sentence; };
  if (properties.apiVersion < kApiVersion)
    add("It supports Vulkan " + std::to_string(VK_API_VERSION_MAJOR(properties.apiVersion)) + "." +
        std::to_string(VK_API_VERSION_MINOR(properties.apiVersion)) + ", but 1.1 is needed.");
  if (!has_queue) add("It has no queue that can compute.");
  using Feature = vk::FormatFeatureFlagBits;
  const vk::FormatFeatureFlags needed =
      Feature::eStorageImage | Feature::eSampledImage | Feature::eTransferSrc | Feature::eTransferDst;
  const vk::FormatProperties format = device.getFormatProperties(vk::Format::eR32G32B32A32Sfloat);
  if ((format.optimalTilingFeatures & needed) != needed)
    add("It cannot use images of four 32-bit floats as storage images.");
  if (properties.limits.maxPerStageDescriptorStorageImages < kStorageImages)
    add("A shader can have " + std::to_string(properties.limits.maxPerStageDescriptorStorageImages) +
        " storage images, but " + std::to_string(kStorageImages) + " are needed.");
  if (properties.limits.maxPerStageDescriptorStorageBuffers < kStorageBuffers)
    add("A shader can have " + std::to_string(properties.limits.maxPerStageDescriptorStorageBuffers) +
        " storage buffers, but " + std::to_string(kStorageBuffers) + " are needed.");
  return reason;
}

}  // namespace

Candidate examine(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceProperties properties = device.getProperties();
  const auto families = device.getQueueFamilyProperties();
  const uint32_t family = find_queue_family(families);
  const bool has_queue = family < families.size();
  const std::string reason = missing_things(device, properties, has_queue);
  const std::string type = type_name(properties.deviceType);
  return {.device = device,
          .info = {.backend = Backend::vulkan,
                   .name = properties.deviceName.data(),
                   .type = type,
                   .driver = "driver version " + std::to_string(properties.driverVersion),
                   .memory_bytes = device_memory(device),
                   .usable = reason.empty(),
                   .reason = reason},
          .software = type == "software",
          .graphics = has_queue && (families[family].queueFlags & vk::QueueFlagBits::eGraphics),
          .queue_family = has_queue ? family : 0};
}

namespace {

/// Why this candidate does not fit the options; empty when it does.
std::string refusal(const Candidate& candidate, const DeviceWish& wish) {
  if (!candidate.info.usable) return candidate.info.reason;
  if (!is_part_of_name(wish.name, candidate.info.name)) return "Its name does not contain '" + wish.name + "'.";
  if (wish.name.empty() && wish.real_gpu && candidate.software)
    return "It is a software device, which is used only when it is named.";
  if (wish.graphics && !candidate.graphics) return "Its compute queue cannot draw.";
  if (wish.presents && !candidate.presents) return "It cannot show pictures in a window of this display.";
  return {};
}

std::ptrdiff_t rank(const Candidate& candidate) {
  constexpr std::array<std::string_view, 3> kOrder{"discrete gpu", "integrated gpu", "virtual gpu"};
  return std::ranges::find(kOrder, candidate.info.type) - kOrder.begin();
}

}  // namespace

std::vector<Candidate> list_candidates(const vk::raii::Instance& instance) {
  std::vector<Candidate> candidates;
  for (const auto& device : vk::raii::PhysicalDevices(instance)) {
    Candidate& candidate = candidates.emplace_back(examine(device));
    if (auto driver = driver_name(device)) candidate.info.driver = std::move(*driver);
  }
  return candidates;
}

std::optional<size_t> find_fitting(const std::vector<Candidate>& candidates, const DeviceWish& wish) {
  std::optional<size_t> best;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (refusal(candidates[i], wish).empty() && (!best || rank(candidates[i]) < rank(candidates[*best]))) best = i;
  return best;
}

const Candidate& choose(const std::vector<Candidate>& candidates, const DeviceWish& wish) {
  if (const auto best = find_fitting(candidates, wish)) return candidates[*best];
  if (candidates.empty())
    throw Error(ErrorCode::device,
                "the Vulkan loader found no device; install the driver of your GPU (Debian: mesa-vulkan-drivers), or "
                "use the cpu backend");
  std::string refused;
  for (const Candidate& candidate : candidates) refused += " " + candidate.info.name + ": " + refusal(candidate, wish);
  throw Error(ErrorCode::device, "no Vulkan device fits." + refused +
                                     " Run 'geocloth devices' to see what there is, or use the cpu backend.");
}

}  // namespace geocloth::vulkan
