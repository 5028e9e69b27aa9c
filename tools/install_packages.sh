#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs on Debian 12 what is missing of: the build (always), "demo", "test". Touches nothing when all is there.
# usage: tools/install_packages.sh [demo] [test]
set -eu

packages="g++ cmake ninja-build pkg-config git ca-certificates
  libcgal-dev libeigen3-dev libassimp-dev libpugixml-dev libdraco-dev libmeshoptimizer-dev zlib1g-dev libtbb-dev libhwy-dev
  libcli11-dev libfmt-dev nlohmann-json3-dev
  libpng-dev libjpeg-dev libstb-dev libopenexr-dev libglfw3-dev libimgui-dev
  libvulkan-dev glslang-tools spirv-tools libgtest-dev libgmock-dev"
optional=""
for purpose in "$@"; do
  case $purpose in
    # lavapipe draws where there is no GPU.
    demo) packages="$packages ffmpeg mesa-vulkan-drivers" ;;
    test)
      packages="$packages ffmpeg mesa-vulkan-drivers vulkan-validationlayers xvfb clang clang-format clang-tidy"
      # The glTF validator and three.js come through npm; the browser test skips where there is no Chromium.
      command -v node >/dev/null || packages="$packages nodejs"
      command -v npm >/dev/null || packages="$packages npm"
      command -v chromium >/dev/null || optional="$optional chromium"
      ;;
    *) echo "install_packages.sh: unknown purpose: $purpose" >&2; exit 2 ;;
  esac
done

is_installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q '^install ok installed$'; }
missing_of() { for package in "$@"; do is_installed "$package" || printf '%s ' "$package"; done; }

# shellcheck disable=SC2086
missing=$(missing_of $packages)
# shellcheck disable=SC2086
missing_optional=$(missing_of $optional)
[ -n "$missing$missing_optional" ] || exit 0

if [ "$(id -u)" = 0 ]; then
  as_root=""
elif command -v sudo >/dev/null; then
  as_root="sudo"
else
  echo "install_packages.sh: these packages are missing; install them as root: $missing" >&2
  exit 1
fi

updated=no
install() {
  if $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"; then return 0; fi
  # Package lists are absent on a fresh container, or too old.
  [ "$updated" = no ] || return 1
  updated=yes
  $as_root apt-get update && $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

if [ -n "$missing" ]; then
  echo "installing: $missing"
  # shellcheck disable=SC2086
  install $missing
fi
if [ -n "$missing_optional" ]; then
  echo "installing: $missing_optional"
  # shellcheck disable=SC2086
  install $missing_optional || echo "install_packages.sh: without $missing_optional; its tests are skipped" >&2
fi
