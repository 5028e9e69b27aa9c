// SPDX-License-Identifier: Apache-2.0
// The loader, opened at run time, and an instance, with the validation layers where they are asked for: plain
// validation and synchronization validation, whose messages are printed and kept.
#include "vulkan/instance.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "geocloth/asset/error.h"

namespace geocloth {

void ValidationLog::add(std::string message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

}  // namespace geocloth

namespace geocloth::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  std::fprintf(stderr, "geocloth: Vulkan validation: %s\n", data->pMessage);
  static_cast<ValidationLog*>(user)->add(data->pMessage);
  return VK_FALSE;
}

void require_validation_layer(const vk::raii::Context& loader) {
  const auto layers = loader.enumerateInstanceLayerProperties();
  const bool found = std::ranges::any_of(
      layers, [](const auto& layer) { return std::strcmp(layer.layerName.data(), kValidationLayer) == 0; });
  if (!found)
    throw Error(ErrorCode::device, std::string("the Vulkan layer ") + kValidationLayer +
                                       " is not installed; install it (Debian: vulkan-validationlayers) or unset "
                                       "GEOCLOTH_VULKAN_VALIDATION");
}

vk::raii::Instance instantiate(const vk::raii::Context& loader, const vk::InstanceCreateInfo& info) {
  try {
    return {loader, info};
  } catch (const vk::IncompatibleDriverError&) {
    throw Error(ErrorCode::device,
                "the Vulkan loader found no driver; install the one of your GPU (Debian: mesa-vulkan-drivers), or use "
                "the cpu backend");
  }
}

}  // namespace

bool validation_requested() {
  const char* value = std::getenv("GEOCLOTH_VULKAN_VALIDATION");
  return value != nullptr && *value != '\0' && std::strcmp(value, "0") != 0;
}

vk::raii::Context open_loader() {
  try {
    return {};
  } catch (const std::exception&) {
    throw Error(
        ErrorCode::device,
        "the Vulkan loader (libvulkan.so.1) is not installed; install it (Debian: libvulkan1) together with the "
        "driver of your GPU, or use the cpu backend");
  }
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog& log) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  return {.messageSeverity = Severity::eWarning | Severity::eError,
          .messageType = Type::eValidation | Type::ePerformance,
          .pfnUserCallback = on_message,
          .pUserData = &log};
}

vk::raii::Instance create_instance(const vk::raii::Context& loader, ValidationLog* log,
                                   std::span<const char* const> extensions) {
  if (loader.enumerateInstanceVersion() < kApiVersion)
    throw Error(ErrorCode::device, "the Vulkan loader is older than 1.1; update it or use the cpu backend");
  const vk::ApplicationInfo application{
      .pApplicationName = "geocloth", .pEngineName = "geocloth", .apiVersion = VK_API_VERSION_1_2};
  std::vector<const char*> names(extensions.begin(), extensions.end());
  vk::InstanceCreateInfo info{.pApplicationInfo = &application};
  info.setPEnabledExtensionNames(names);
  if (log == nullptr) return instantiate(loader, info);

  require_validation_layer(loader);
  const std::array<const char*, 1> layers{kValidationLayer};
  names.insert(names.end(), {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME});
  const auto enabled = vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  // The messenger in the chain hears what happens while the instance itself is made and destroyed.
  const vk::DebugUtilsMessengerCreateInfoEXT messenger = messenger_info(*log);
  const vk::ValidationFeaturesEXT features{
      .pNext = &messenger, .enabledValidationFeatureCount = 1, .pEnabledValidationFeatures = &enabled};
  info.pNext = &features;
  info.setPEnabledLayerNames(layers).setPEnabledExtensionNames(names);
  return instantiate(loader, info);
}

}  // namespace geocloth::vulkan
