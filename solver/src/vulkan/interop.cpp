// SPDX-License-Identifier: Apache-2.0
#include "geocloth/solver/vulkan_interop.h"
#include "solver_impl.h"
#include "vulkan/vulkan_backend.h"

namespace geocloth {
namespace {

vulkan::VulkanBackend& vulkan_backend(Solver& solver) {
  if (auto* backend = dynamic_cast<vulkan::VulkanBackend*>(&solver.impl().backend())) return *backend;
  throw Error(ErrorCode::unsupported,
              "this solver runs on the cpu backend and has no Vulkan objects; construct it with Backend::vulkan or "
              "make_vulkan_solver");
}

}  // namespace

Solver make_vulkan_solver(std::span<const ClothDesc> cloths, const SolverSettings& settings,
                          const VulkanDevice& device) {
  const auto context = vulkan::guarded("adopt a device", [&] { return std::make_shared<vulkan::Context>(device); });
  return Solver(std::make_unique<Solver::Impl>(
      cloths, settings, [&](SimulationData data) { return vulkan::make_backend(context, std::move(data)); }));
}

VulkanDevice vulkan_device(Solver& solver) {
  return vulkan_backend(solver).context().handles();
}

VulkanClothImages vulkan_images(Solver& solver, uint32_t cloth) {
  vulkan::VulkanBackend& backend = vulkan_backend(solver);
  const vulkan::ClothResources& resources = backend.cloth(solver.impl().index_of(cloth));
  return {.position = resources.position.handle(),
          .position_view = resources.position.view(),
          .normal = resources.normal.handle(),
          .normal_view = resources.normal.view(),
          .width = resources.width,
          .height = resources.height,
          .layout = VK_IMAGE_LAYOUT_GENERAL,
          .origin = solver.impl().origin()};
}

Vec3 vulkan_origin(Solver& solver) {
  static_cast<void>(vulkan_backend(solver));
  return solver.impl().origin();
}

std::shared_ptr<const ValidationLog> validation_log(Solver& solver) {
  return vulkan_backend(solver).context().validation_log();
}

}  // namespace geocloth
