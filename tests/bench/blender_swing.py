# SPDX-License-Identifier: GPL-3.0-or-later
# The scene `geocloth bench --scene swing --size 100` in Blender's cloth: 1 m, 1 cm apart, the edge pinned, level at
# first, down on to a ball that pokes through the plane where it would hang; 300 frames at 60 a second.
#   blender -b --python tests/bench/blender_swing.py -- [quality steps] [stiffness]
# Blender's own defaults are 5 steps, stiffness 15, 0.3 kg a vertex; its units are its own.
import sys
import time

import bpy
import numpy

words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
quality = int(words[0]) if words else 5
stiffness = float(words[1]) if len(words) > 1 else 15.0
COUNT, SPACING, FRAMES = 100, 0.01, 300
SIDE = SPACING * (COUNT - 1)

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = 60
scene.frame_end = FRAMES

points = [(i * SPACING, -j * SPACING, 0) for j in range(COUNT) for i in range(COUNT)]
faces = [(k, k + 1, k + COUNT + 1, k + COUNT)
         for j in range(COUNT - 1) for k in range(j * COUNT, (j + 1) * COUNT - 1)]
mesh = bpy.data.meshes.new("sheet")
mesh.from_pydata(points, [], faces)
sheet = bpy.data.objects.new("sheet", mesh)
scene.collection.objects.link(sheet)
sheet.vertex_groups.new(name="top").add(list(range(COUNT)), 1, "REPLACE")

bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.15 * SIDE,
                                     location=(SIDE / 2, 0, -0.55 * SIDE))
ball = bpy.context.object
ball.modifiers.new("collision", "COLLISION")
ball.collision.thickness_outer = 0.002

modifier = sheet.modifiers.new("cloth", "CLOTH")
modifier.settings.quality = quality
modifier.settings.vertex_group_mass = "top"
modifier.settings.tension_stiffness = stiffness
modifier.settings.compression_stiffness = stiffness
modifier.settings.shear_stiffness = stiffness
modifier.collision_settings.distance_min = 0.002
modifier.point_cache.frame_end = FRAMES

seconds = []
for frame in range(1, FRAMES + 1):
    begin = time.perf_counter()
    scene.frame_set(frame)
    evaluated = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get())
    seconds.append(time.perf_counter() - begin)

flat = numpy.empty(3 * COUNT * COUNT, "f4")
evaluated.data.vertices.foreach_get("co", flat)
p = flat.reshape(COUNT, COUNT, 3)
length = numpy.concatenate([numpy.linalg.norm(p[:, 1:] - p[:, :-1], axis=2).ravel(),
                            numpy.linalg.norm(p[1:] - p[:-1], axis=2).ravel()])
stretch = 100 * (length / SPACING - 1)
print(f"blender {bpy.app.version_string}, {quality} steps, stiffness {stiffness:g}: "
      f"{1000 * numpy.median(seconds[5:]):.0f} ms/frame, stretch {stretch.max():+.2f} % max, "
      f"{numpy.maximum(stretch, 0).mean():+.3f} % mean")
