// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer entry for the asset reader. Whatever the bytes are, reading gives an asset or an Error; an asset that is
// accepted must be written and read again without a difference. Without libFuzzer, replay_main.cpp runs the corpus.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace geocloth;
  try {
    const ClothAsset asset = decode_asset(std::as_bytes(std::span(data, size)), "fuzz");
    const auto bytes = encode_asset(asset);
    if (encode_asset(decode_asset(bytes, "again")) != bytes) std::abort();
  } catch (const Error&) {
  }
  return 0;
}
