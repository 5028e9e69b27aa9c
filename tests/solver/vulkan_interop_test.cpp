// SPDX-License-Identifier: GPL-3.0-or-later
// What solver/README.md shows: an engine owns the VkDevice, lends it to the solver and uses the position image in its
// own commands on the same queue, without a wait in between.
#include "geocloth/solver/vulkan_interop.h"

#include "support/make_sheet.h"
#include "support/vulkan_test.h"
#include "vulkan/buffer.h"
#include "vulkan/commands.h"
#include "vulkan/context.h"

namespace geocloth {
namespace {

class VulkanInteropTest : public test::VulkanTest {
 protected:
  /// The engine's own device.
  std::shared_ptr<const vulkan::Context> engine_ = nullptr;
  std::shared_ptr<const ValidationLog> engine_log_ = nullptr;

  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    engine_ = std::make_shared<vulkan::Context>(vulkan::DeviceWish{});
    engine_log_ = engine_->validation_log();
  }
  void TearDown() override {
    engine_.reset();
    if (engine_log_) {
      EXPECT_THAT(engine_log_->messages(), testing::IsEmpty());
    }
    VulkanTest::TearDown();
  }

  std::vector<ClothDesc> sheet_ = {
      {.asset = std::make_shared<ClothAsset>(test::make_sheet({.nx = 9, .ny = 7, .charts_x = 2})),
       .transform = {.translate = {1000, 0, 0}}}};
};

/// Bound all the same, what lies beyond the device's limit would be read as anything.
TEST_F(VulkanInteropTest, MoreThanAShaderMaySeeOfABufferIsRefused) {
  const size_t most = engine_->limits().maxStorageBufferRange;
  try {
    const vulkan::Buffer buffer = vulkan::storage_buffer(engine_, most + 4);
    FAIL() << "it was made";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::device);
    EXPECT_THAT(e.what(), testing::HasSubstr(std::to_string(most >> 20U) + " MiB of a buffer"));
    EXPECT_THAT(e.what(), testing::HasSubstr("the cpu backend"));
  }
}

/// What an engine does that wants another layout than the solver's for a while.
void change_layout(const vk::raii::CommandBuffer& commands, const VulkanClothImages& images, vk::ImageLayout from,
                   vk::ImageLayout to) {
  const vk::ImageMemoryBarrier barrier{.srcAccessMask = vk::AccessFlagBits::eMemoryWrite,
                                       .dstAccessMask = vk::AccessFlagBits::eMemoryRead,
                                       .oldLayout = from,
                                       .newLayout = to,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = images.position,
                                       .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1}};
  commands.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eAllCommands, {}, {}, {},
                           barrier);
}

TEST_F(VulkanInteropTest, AnEngineReadsThePositionsInItsOwnCommands) {
  Solver solver = make_vulkan_solver(sheet_, {.device = ""}, engine_->handles());
  for (int frame = 0; frame < 3; ++frame) solver.step();

  const VulkanClothImages images = vulkan_images(solver, 0);
  const size_t pixels = size_t{images.width} * images.height;
  const vulkan::Buffer copy(engine_, pixels * 16, vk::BufferUsageFlagBits::eTransferDst, vulkan::Memory::readback);
  vulkan::run_once(engine_, [&](const vk::raii::CommandBuffer& commands) {
    const vk::BufferImageCopy region{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                     .imageExtent = {images.width, images.height, 1}};
    change_layout(commands, images, vk::ImageLayout::eGeneral, vk::ImageLayout::eTransferSrcOptimal);
    commands.copyImageToBuffer(images.position, vk::ImageLayout::eTransferSrcOptimal, copy.handle(), region);
    change_layout(commands, images, vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::eGeneral);
  });
  solver.step();  // may overwrite the image only after the engine's copy

  const ClothAsset& asset = *sheet_[0].asset;
  Solver again = make_solver(sheet_, {.device = ""});
  for (int frame = 0; frame < 3; ++frame) again.step();
  std::vector<Vec3> expected;
  again.read_positions(0, expected);
  const std::span<const float> texels = copy.as<float>();
  for (uint32_t i = 0; i < pixels; ++i) {
    if (!asset.valid(i)) continue;
    const Vec3 position = Vec3{texels[4 * i], texels[4 * i + 1], texels[4 * i + 2]} + images.origin;
    EXPECT_EQ(position, expected[i]) << "pixel " << i;
  }
}

TEST_F(VulkanInteropTest, TheSolverRunsOnTheEnginesDeviceAndLeavesItAlive) {
  const VulkanDevice device = engine_->handles();
  {
    Solver solver = make_vulkan_solver(sheet_, {.device = ""}, device);
    solver.step();
    EXPECT_EQ(vulkan_device(solver).device, device.device);
    EXPECT_EQ(vulkan_device(solver).queue, device.queue);
    EXPECT_EQ(solver.statistics().device, engine_->info().name);
    const VulkanClothImages images = vulkan_images(solver, 0);
    EXPECT_EQ(images.width, sheet_[0].asset->width);
    EXPECT_EQ(images.height, sheet_[0].asset->height);
    EXPECT_NE(images.position_view, VkImageView{});
    EXPECT_NE(images.normal_view, VkImageView{});
  }
  engine_->device().waitIdle();  // the device is still there
}

TEST_F(VulkanInteropTest, HandlesThatCannotWorkAreRefused) {
  VulkanDevice device = engine_->handles();
  device.queue_family = 99;
  EXPECT_THROW((void)make_vulkan_solver(sheet_, {.device = ""}, device), Error);
  device = engine_->handles();
  device.queue = VK_NULL_HANDLE;
  EXPECT_THROW((void)make_vulkan_solver(sheet_, {.device = ""}, device), Error);
}

TEST_F(VulkanInteropTest, ASolverOnTheCpuHasNoVulkanObjects) {
  Solver solver(sheet_, {.backend = Backend::cpu, .device = ""});
  EXPECT_THROW((void)vulkan_device(solver), Error);
  EXPECT_THROW((void)vulkan_images(solver, 0), Error);
}

TEST_F(VulkanInteropTest, ImagesKeepTheirHandlesWhileOtherClothsComeAndGo) {
  Solver solver = make_solver(sheet_, {.device = ""});
  const VkImage first = vulkan_images(solver, 0).position;
  const uint32_t added = solver.add_cloth(sheet_[0]);
  solver.step();
  const VkImage second = vulkan_images(solver, added).position;
  EXPECT_EQ(vulkan_images(solver, 0).position, first);
  EXPECT_NE(second, first);
  solver.remove_cloth(0);
  solver.step();
  EXPECT_EQ(vulkan_images(solver, added).position, second);
  EXPECT_THROW((void)vulkan_images(solver, 0), Error);
}

TEST_F(VulkanInteropTest, AClothThatDoesNotExistIsRefused) {
  Solver solver = make_solver(sheet_, {.device = ""});
  EXPECT_THROW((void)vulkan_images(solver, 1), Error);
}

}  // namespace
}  // namespace geocloth
