// SPDX-License-Identifier: Apache-2.0
// A device and one queue, either our own or an application's. One queue is enough: every pass needs the one before it.
// vk::raii destroys what it holds in the reverse order of the members; what belongs to the application is released.
#include "vulkan/context.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "vulkan/instance.h"

namespace geocloth::vulkan {
namespace {

/// Features that a renderer on the same device uses where they exist; the solver needs none.
vk::PhysicalDeviceFeatures wanted_features(const vk::raii::PhysicalDevice& device) {
  const vk::PhysicalDeviceFeatures has = device.getFeatures();
  return {.fillModeNonSolid = has.fillModeNonSolid, .samplerAnisotropy = has.samplerAnisotropy};
}

vk::raii::Device create_device(const Candidate& candidate, bool swapchains) {
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue{
      .queueFamilyIndex = candidate.queue_family, .queueCount = 1, .pQueuePriorities = &priority};
  const vk::PhysicalDeviceFeatures features = wanted_features(candidate.device);
  const char* const extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  return {candidate.device, vk::DeviceCreateInfo{.queueCreateInfoCount = 1,
                                                 .pQueueCreateInfos = &queue,
                                                 .enabledExtensionCount = swapchains ? 1U : 0U,
                                                 .ppEnabledExtensionNames = &extension,
                                                 .pEnabledFeatures = &features}};
}

bool has_swapchains(const vk::raii::PhysicalDevice& device) {
  const auto extensions = device.enumerateDeviceExtensionProperties();
  return std::ranges::any_of(extensions, [](const vk::ExtensionProperties& extension) {
    return std::strcmp(extension.extensionName.data(), VK_KHR_SWAPCHAIN_EXTENSION_NAME) == 0;
  });
}

}  // namespace

Context::Context(const DeviceWish& wish) : loader_(open_loader()) {
  guarded("open a device", [&] {
    const bool validate = validation_requested();
    instance_ = create_instance(loader_, validate ? log_.get() : nullptr, wish.instance_extensions);
    if (validate) messenger_ = vk::raii::DebugUtilsMessengerEXT(instance_, messenger_info(*log_));
    std::vector<Candidate> candidates = list_candidates(instance_);
    if (wish.presents) {
      for (Candidate& c : candidates)
        c.presents = has_swapchains(c.device) && wish.presents(*instance_, *c.device, c.queue_family);
    }
    const Candidate& chosen = choose(candidates, wish);
    device_ = create_device(chosen, static_cast<bool>(wish.presents));
    queue_ = device_.getQueue(chosen.queue_family, 0);
    adopt_candidate(chosen);
  });
}

Context::Context(const VulkanDevice& foreign) : foreign_(true), loader_(open_loader()) {
  if (foreign.instance == VK_NULL_HANDLE || foreign.physical_device == VK_NULL_HANDLE ||
      foreign.device == VK_NULL_HANDLE || foreign.queue == VK_NULL_HANDLE)
    throw Error(ErrorCode::invalid_argument,
                "VulkanDevice has a null handle; set instance, physical_device, device, queue_family and queue");
  instance_ = vk::raii::Instance(loader_, foreign.instance);
  Candidate candidate = examine(vk::raii::PhysicalDevice(instance_, foreign.physical_device));
  const auto families = candidate.device.getQueueFamilyProperties();
  const bool known = foreign.queue_family < families.size();
  if (!known || !(families[foreign.queue_family].queueFlags & vk::QueueFlagBits::eCompute)) {
    instance_.release();
    throw Error(ErrorCode::invalid_argument, "VulkanDevice::queue_family " + std::to_string(foreign.queue_family) +
                                                 (known ? " cannot compute" : " does not exist on this device") +
                                                 "; pass a family that can");
  }
  if (!candidate.info.usable) {
    instance_.release();
    throw Error(ErrorCode::device, candidate.info.name + " cannot run the solver. " + candidate.info.reason);
  }
  candidate.queue_family = foreign.queue_family;
  candidate.graphics = static_cast<bool>(families[foreign.queue_family].queueFlags & vk::QueueFlagBits::eGraphics);
  device_ = vk::raii::Device(candidate.device, foreign.device);
  queue_ = vk::raii::Queue(device_, foreign.queue);
  adopt_candidate(candidate);
}

Context::~Context() {
  if (!foreign_) return;
  device_.release();
  instance_.release();
}

void Context::adopt_candidate(const Candidate& candidate) {
  physical_device_ = candidate.device;
  queue_family_ = candidate.queue_family;
  info_ = candidate.info;
  graphics_ = candidate.graphics;
  limits_ = physical_device_.getProperties().limits;
  memory_ = physical_device_.getMemoryProperties();
  const uint32_t bits = physical_device_.getQueueFamilyProperties()[queue_family_].timestampValidBits;
  timestamp_mask_ = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  timestamp_period_ = bits == 0 ? 0 : static_cast<double>(limits_.timestampPeriod) * 1e-9;
}

VulkanDevice Context::handles() const {
  return {.instance = *instance_,
          .physical_device = *physical_device_,
          .device = *device_,
          .queue_family = queue_family_,
          .queue = *queue_};
}

uint32_t Context::memory_type(uint32_t type_bits, vk::MemoryPropertyFlags required,
                              vk::MemoryPropertyFlags preferred) const {
  for (const vk::MemoryPropertyFlags wanted : std::array{required | preferred, required})
    for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
      if ((type_bits & (1U << i)) != 0 && (memory_.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  throw Error(ErrorCode::device, info_.name + " has no memory of the kind that is needed; use the cpu backend");
}

vk::raii::DeviceMemory Context::allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags required,
                                         vk::MemoryPropertyFlags preferred) const {
  return {device_, vk::MemoryAllocateInfo{.allocationSize = needs.size,
                                          .memoryTypeIndex = memory_type(needs.memoryTypeBits, required, preferred)}};
}

}  // namespace geocloth::vulkan
