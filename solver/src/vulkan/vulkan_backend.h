// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "backend.h"
#include "rest/self_points.h"
#include "vulkan/cloth_resources.h"
#include "vulkan/frame_slot.h"
#include "vulkan/inter_resources.h"
#include "vulkan/pass_kernels.h"
#include "vulkan/pass_timer.h"
#include "vulkan/tile_kernels.h"

namespace geocloth::vulkan {

class Upload;

/// The passes as compute dispatches: one for each group of springs, which every device can run, or several passes at
/// once in the memory of work groups (frame_plan.h), with the same result.
class VulkanBackend final : public SolverBackend {
 public:
  VulkanBackend(std::shared_ptr<const Context> context, SimulationData data);

  void run_frame(const FrameInput& frame) override;
  void wait() override;
  void read_positions(uint32_t cloth, std::vector<shader::vec4>& out) override;
  void read_previous(uint32_t cloth, std::vector<shader::vec4>& out) override;
  void read_carry(uint32_t cloth, std::vector<shader::vec4>& out) override;
  void read_normals(uint32_t cloth, std::vector<shader::vec4>& out) override;
  void write_state(uint32_t cloth, std::span<const shader::vec4> position,
                   std::span<const shader::vec4> previous) override;
  [[nodiscard]] std::optional<Whereabouts> whereabouts(uint32_t /*cloth*/) const override { return std::nullopt; }
  void read_memory(uint32_t cloth, ClothMemory& out) override;
  void write_memory(uint32_t cloth, const ClothMemory& memory, const ClothFrame& pins) override;
  void read_found(FoundPoints& out) override;
  void write_found(const FoundPoints& found) override;
  void shift(const Vec3& by) override;
  void add_cloth(ClothData data) override;
  void remove_cloth(uint32_t cloth) override;
  void replace_topology(uint32_t cloth, ClothData data) override;
  void replace_inter(InterData inter) override;
  float longest_way(uint32_t cloth, uint32_t word) override;
  uint32_t left_behind(uint32_t cloth, uint32_t word) override;
  void read_contacts(uint32_t cloth, std::vector<ContactSum>& out) override;
  void fill_statistics(SolverStatistics& statistics) override;

  [[nodiscard]] const Context& context() const { return *context_; }
  [[nodiscard]] const ClothResources& cloth(uint32_t index) const { return cloths_[index]; }

 private:
  /// What recorded commands depend on besides the contents of buffers.
  struct Recipe {
    std::vector<ScheduleOptions> schedules;  ///< of each cloth
    std::vector<uint32_t> pins;              ///< of each cloth
    bool operator==(const Recipe&) const = default;
  };
  struct Slot {
    Slot(const std::shared_ptr<const Context>& context, const PassKernels& kernels, const TileKernels& tile_kernels,
         const std::vector<ClothResources>& cloths, const InterResources* inter, bool contact_forces);
    std::vector<std::unique_ptr<TileSets>> tiles;  ///< of each cloth; none on the plain path. Before the commands
    FrameSlot frame;
    PassTimer timer;
    Recipe recipe;
    bool timed = false;  ///< its last frame's times are still to be collected
    /// That each cloth met in it, if its contacts are still to be collected; empty if nobody's are.
    std::vector<std::optional<uint32_t>> colliders;
  };

  [[nodiscard]] Recipe recipe_of(const FrameInput& frame) const;
  void make_cloth(ClothData& data);
  [[nodiscard]] Slot& slot(size_t index);
  void record(Slot& slot);
  void record_dispatch(const Slot& slot, const vk::raii::CommandBuffer& commands, size_t cloth,
                       const Dispatch& dispatch);
  static void clear_contacts(const Slot& slot, const vk::raii::CommandBuffer& commands);
  static void copy_contacts(const Slot& slot, const vk::raii::CommandBuffer& commands);
  void compute_normals(const std::vector<uint32_t>& cloths);
  void take_parts();
  void change_pins(uint32_t cloth, const ClothFrame& frame);
  void add_pins(Upload& upload, uint32_t cloth, const ClothFrame& frame) const;
  void read_words(const Buffer& words, const FoundWords& range, FoundPoints& out) const;
  static void add_words(Upload& upload, const FoundPoints& found, const FoundWords& range, const Buffer& words);
  void finish(Slot& slot);
  void read(const Image& image, std::vector<shader::vec4>& out) const;

  std::shared_ptr<const Context> context_;
  SimulationData data_;  ///< without the arrays that are on the device
  TileLimits limits_;
  PassKernels kernels_;
  TileKernels tile_kernels_;
  std::vector<ClothResources> cloths_;
  std::unique_ptr<InterResources> inter_;  ///< none where no cloths collide with each other
  std::vector<std::unique_ptr<Slot>> slots_;
  size_t next_slot_ = 0;
  PassSeconds seconds_{};
  std::vector<std::vector<ContactSum>> contacts_;                ///< of each cloth, of the last frame that is finished
  std::array<uint32_t, shader::kMeasureCount> past_measures_{};  ///< the largest of cloths that have been removed
};

/// On a given device, e.g. an application's.
[[nodiscard]] std::unique_ptr<SolverBackend> make_backend(std::shared_ptr<const Context> context, SimulationData data);

}  // namespace geocloth::vulkan
