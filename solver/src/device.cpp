// SPDX-License-Identifier: Apache-2.0
// What can run the solver: the cpu, which always can, and what the Vulkan loader finds. Nothing that goes wrong in a
// loader or a driver may stop a program that would be content with the cpu: it becomes an entry with a reason.
#include "geocloth/solver/device.h"

#include <algorithm>
#include <exception>

#include <unistd.h>

#include "cpu/cpu_name.h"
#include "vulkan/candidate.h"
#include "vulkan/context.h"
#include "vulkan/instance.h"

namespace geocloth {
namespace {

uint64_t physical_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), page_size = sysconf(_SC_PAGE_SIZE);
  return pages > 0 && page_size > 0 ? static_cast<uint64_t>(pages) * static_cast<uint64_t>(page_size) : 0;
}

DeviceInfo cpu_info() {
  DeviceInfo info;
  info.backend = Backend::cpu;
  info.name = cpu::cpu_name();
  info.type = "cpu";
  info.driver = "geocloth";
  info.memory_bytes = physical_memory();
  return info;
}

std::vector<DeviceInfo> vulkan_devices() {
  return vulkan::guarded("list its devices", [] {
    const vk::raii::Context loader = vulkan::open_loader();
    const vk::raii::Instance instance = vulkan::create_instance(loader, nullptr);
    const std::vector<vulkan::Candidate> candidates = vulkan::list_candidates(instance);
    std::vector<DeviceInfo> devices;
    devices.reserve(candidates.size());
    for (const vulkan::Candidate& candidate : candidates) devices.push_back(candidate.info);
    if (const auto automatic = vulkan::find_fitting(candidates, {.real_gpu = true}))
      devices[*automatic].chosen_automatically = true;
    return devices;
  });
}

DeviceInfo unusable(const std::string& reason) {
  DeviceInfo info;
  info.backend = Backend::vulkan;
  info.name = "Vulkan";
  info.type = "none";
  info.usable = false;
  info.reason = reason;
  return info;
}

}  // namespace

const char* to_string(Backend backend) {
  switch (backend) {
    case Backend::automatic:
      return "auto";
    case Backend::cpu:
      return "cpu";
    case Backend::vulkan:
      return "vulkan";
  }
  return "unknown";
}

std::vector<DeviceInfo> enumerate_devices() {
  std::vector<DeviceInfo> devices{cpu_info()};
  try {
    for (DeviceInfo& device : vulkan_devices()) devices.push_back(std::move(device));
    if (devices.size() == 1) devices.push_back(unusable("The Vulkan loader found no device."));
  } catch (const std::exception& e) {
    devices.push_back(unusable(e.what()));
  }
  const bool has_gpu = std::ranges::any_of(devices, &DeviceInfo::chosen_automatically);
  devices.front().chosen_automatically = !has_gpu;
  return devices;
}

}  // namespace geocloth
