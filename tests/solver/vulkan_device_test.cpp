// SPDX-License-Identifier: GPL-3.0-or-later
// Which device is taken, and what a user reads when none fits.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>

#include "geocloth/solver/device.h"
#include "support/make_sheet.h"
#include "support/vulkan_test.h"

namespace geocloth {
namespace {

using test::make_sheet;

std::vector<ClothDesc> one_sheet() {
  return {{.asset = std::make_shared<ClothAsset>(make_sheet({.nx = 5, .ny = 5}))}};
}

/// Hides every driver from the Vulkan loader while it lives.
class NoDriver {
 public:
  NoDriver() {
    for (const char* name : kNames) {
      const char* old = std::getenv(name);
      if (old != nullptr) old_[name] = old;
      setenv(name, "/nonexistent/driver.json", 1);
    }
  }
  NoDriver(const NoDriver&) = delete;
  NoDriver& operator=(const NoDriver&) = delete;
  ~NoDriver() {
    for (const char* name : kNames) {
      if (const auto old = old_.find(name); old != old_.end())
        setenv(name, old->second.c_str(), 1);
      else
        unsetenv(name);
    }
  }

 private:
  static constexpr std::array<const char*, 2> kNames{"VK_ICD_FILENAMES", "VK_DRIVER_FILES"};
  std::map<std::string, std::string> old_;
};

std::string message_of(const SolverSettings& settings) {
  try {
    const Solver solver(one_sheet(), settings);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::device);
    return e.what();
  }
  return "no error";
}

TEST(DeviceListTest, TheCpuComesFirstAndIsAlwaysUsable) {
  const std::vector<DeviceInfo> devices = enumerate_devices();
  ASSERT_GE(devices.size(), 2U);
  EXPECT_EQ(devices.front().backend, Backend::cpu);
  EXPECT_TRUE(devices.front().usable);
  EXPECT_EQ(devices.front().type, "cpu");
  EXPECT_FALSE(devices.front().name.empty());
  EXPECT_GT(devices.front().memory_bytes, 0U);
}

TEST(DeviceListTest, ExactlyOneDeviceIsChosenAutomaticallyAndItIsNoSoftwareDevice) {
  const std::vector<DeviceInfo> devices = enumerate_devices();
  EXPECT_EQ(std::ranges::count_if(devices, &DeviceInfo::chosen_automatically), 1);
  for (const DeviceInfo& device : devices) {
    if (device.chosen_automatically) {
      EXPECT_NE(device.type, "software");
      EXPECT_TRUE(device.usable);
    }
  }
}

TEST(DeviceListTest, WhatCannotBeUsedSaysWhyInASentence) {
  for (const DeviceInfo& device : enumerate_devices()) {
    EXPECT_EQ(device.usable, device.reason.empty()) << device.name;
    EXPECT_THAT(device.type,
                testing::AnyOf("cpu", "discrete gpu", "integrated gpu", "virtual gpu", "software", "none"));
  }
}

TEST(DeviceListTest, WithoutADriverTheListSaysSoAndTheCpuIsChosen) {
  const NoDriver no_driver;
  const std::vector<DeviceInfo> devices = enumerate_devices();
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_TRUE(devices[0].chosen_automatically);
  EXPECT_FALSE(devices[1].usable);
  EXPECT_THAT(devices[1].reason, testing::HasSubstr("driver"));
}

TEST(NoDeviceTest, VulkanWithoutADriverIsAnErrorThatNamesTheRemedy) {
  const NoDriver no_driver;
  EXPECT_THAT(message_of({.backend = Backend::vulkan, .device = ""}),
              testing::AllOf(testing::HasSubstr("driver"), testing::HasSubstr("cpu backend")));
}

TEST(NoDeviceTest, AutomaticWithoutADriverTakesTheCpu) {
  const NoDriver no_driver;
  Solver solver(one_sheet(), {.backend = Backend::automatic, .device = ""});
  solver.step();
  EXPECT_EQ(solver.statistics().backend, "cpu");
}

class VulkanDeviceTest : public test::VulkanTest {};

TEST_F(VulkanDeviceTest, AnUnknownNameIsRefusedWithTheReasonOfEveryDevice) {
  const std::string message = message_of({.backend = Backend::vulkan, .device = "Voodoo 3"});
  EXPECT_THAT(message, testing::HasSubstr("Voodoo 3"));
  for (const DeviceInfo& device : enumerate_devices()) {
    if (device.backend != Backend::vulkan) continue;
    EXPECT_THAT(message, testing::HasSubstr(device.name));
  }
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST_F(VulkanDeviceTest, ADeviceIsFoundByAPartOfItsNameInAnyCase) {
  for (const DeviceInfo& device : enumerate_devices()) {
    if (device.backend != Backend::vulkan || !device.usable) continue;
    std::string part = device.name.substr(0, device.name.size() / 2);
    for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    Solver solver = make_solver(one_sheet(), {.device = part});
    EXPECT_THAT(solver.statistics().device, testing::StartsWith(device.name.substr(0, part.size())));
  }
}

}  // namespace
}  // namespace geocloth
