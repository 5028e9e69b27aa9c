// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <exception>

#include <geocloth/asset/asset_file.h>
#include <geocloth/parametrize/convert.h>

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  geocloth::ConvertOptions options;
  options.flatten.resolution = 32;
  const geocloth::ConvertResult result = geocloth::convert(argv[1], options);
  geocloth::write_asset(result.asset, argv[2]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
