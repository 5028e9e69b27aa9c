#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# From a fresh clone on Debian 12 to moving cloth: installs what is missing, builds, makes the project's own garments,
# converts them, plays them over colliders in wind, and leaves assets, animations, pictures and films in a folder.
# usage: tools/demo.sh [FOLDER]        default out/demo
set -eu
cd "$(dirname "$0")/.."
out=${1:-out/demo}

tools/install_packages.sh demo
cmake --preset release -D GEOCLOTH_TESTS=OFF
cmake --build --preset release --target geocloth_program geocloth_make_meshes
geocloth=build/release/geocloth

mkdir -p "$out"
build/release/meshes/make_meshes "$out/meshes"
cp meshes/scenes/*.json "$out"

# play SCENE: the film, the motion and the report
play() {
  "$geocloth" simulate "$out/$1.json" -o "$out/$1.animated.glb" -o "$out/$1.mp4" --report "$out/$1.simulate.json"
  # Twelve moments, evenly spread over the film.
  frames=$(ffprobe -loglevel error -show_entries stream=nb_frames -of csv=p=0 "$out/$1.mp4")
  ffmpeg -y -loglevel error -i "$out/$1.mp4" -frames:v 1 -update 1 \
    -vf "select='not(mod(n\,$((frames / 12))))',scale=480:-1,tile=4x3" "$out/$1.contact_sheet.png"
}

for garment in t_shirt cape poncho; do
  echo "== $garment"
  "$geocloth" convert "$out/meshes/garments/$garment.obj" -o "$out/$garment.glb" --resolution 96 \
    --report "$out/$garment.convert.json" --pictures "$out/$garment.pictures"
  play "$garment"
done
echo "== walker"
play walker

cat <<TEXT

Done. For each of t_shirt, cape and poncho, and walker, who wears the poncho, in $out:
  NAME.glb                the asset: garment and geometry image (opens in Blender, three.js and every glTF viewer)
  NAME.animated.glb       the motion
  NAME.mp4                the film
  NAME.contact_sheet.png  twelve moments of it
  NAME.pictures/          geometry image, charts with the split points, distortion
  NAME.convert.json, NAME.simulate.json   the reports
TEXT
