// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth devices: every backend and device that could run the solver, and why one cannot.
#include <cstdio>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command.h"
#include "geocloth/solver/device.h"

namespace geocloth {
namespace {

struct DevicesArguments {
  bool json = false;
};

constexpr double kMebibyte = 1024.0 * 1024.0;

void print_for_people(const std::vector<DeviceInfo>& devices) {
  for (const DeviceInfo& device : devices) {
    fmt::print("{}{} {}: {}", device.chosen_automatically ? "* " : "  ", to_string(device.backend), device.type,
               device.name);
    if (!device.driver.empty()) fmt::print(", {}", device.driver);
    if (device.memory_bytes > 0) fmt::print(", {:.0f} MiB", static_cast<double>(device.memory_bytes) / kMebibyte);
    if (!device.usable) fmt::print("\n    not usable: {}", device.reason);
    fmt::print("\n");
  }
  fmt::print("* is what --backend auto takes\n");
}

void print_json(const std::vector<DeviceInfo>& devices) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const DeviceInfo& device : devices) {
    list.push_back({{"backend", to_string(device.backend)},
                    {"name", device.name},
                    {"type", device.type},
                    {"driver", device.driver},
                    {"memory_bytes", device.memory_bytes},
                    {"usable", device.usable},
                    {"reason", device.reason},
                    {"chosen_automatically", device.chosen_automatically}});
  }
  fmt::print("{}\n", nlohmann::ordered_json{{"devices", list}}.dump(2));
}

}  // namespace

CommandRun add_devices(CLI::App& app) {
  auto options = std::make_shared<DevicesArguments>();
  app.add_flag("--json", options->json, "print JSON for programs [default off]");
  return [options] {
    const std::vector<DeviceInfo> devices = enumerate_devices();
    if (options->json) {
      print_json(devices);
    } else {
      print_for_people(devices);
    }
  };
}

}  // namespace geocloth
