// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer entry for the cache readers: the bytes as each of the three formats give frames or an Error.
#include <cstdint>
#include <span>

#include "export/cache_reader.h"
#include "geocloth/asset/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace geocloth;
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto attempt = [](auto&& read) {
    try {
      static_cast<void>(read());
    } catch (const Error&) {
    }
  };
  attempt([&] { return decode_gltf_cache(bytes, "fuzz"); });
  attempt([&] { return decode_point_cache(bytes, "fuzz.pc2"); });
  attempt([&] { return decode_point_cache(bytes, "fuzz.mdd"); });
  return 0;
}
