# SPDX-License-Identifier: MIT
# blender -b -P blender_view.py -- MESHES.obj ENGINE OUT.png: the S-I tongue view of the exported
# meshes (millimetres), drawn five times; prints the mean time of one drawing.
import sys
import time

import bpy
from mathutils import Matrix, Vector

meshes, engine, out = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.ops.wm.obj_import(filepath=meshes, forward_axis="Y", up_axis="Z")
for o in bpy.context.selected_objects:
    for p in o.data.polygons:
        p.use_smooth = True
    for m in o.data.materials:  # Workbench shows the viewport's colour
        m.diffuse_color = m.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value

eye, target, up = Vector((0, -25, 330)), Vector((0, -8, -40)), Vector((0, -1, 0))
back = (eye - target).normalized()
right = up.cross(back).normalized()
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
bpy.context.collection.objects.link(camera)
camera.matrix_world = Matrix.Translation(eye) @ Matrix((right, back.cross(right), back)).transposed().to_4x4()
camera.data.sensor_fit = "VERTICAL"
camera.data.angle = 21 * 3.14159265 / 180
camera.data.clip_end = 1000
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
bpy.context.collection.objects.link(sun)
sun.data.energy = 3
sun.matrix_world = Matrix.Translation(eye) @ Matrix.Rotation(0.5, 4, "X")

scene = bpy.context.scene
scene.camera = camera
scene.render.engine = engine
scene.render.resolution_x, scene.render.resolution_y = 1280, 720
scene.render.filepath = out
if engine == "BLENDER_WORKBENCH":
    shading = scene.display.shading
    shading.light, shading.color_type = "STUDIO", "MATERIAL"
    shading.show_shadows = shading.show_cavity = True
    shading.cavity_type = "WORLD"  # its ambient occlusion
    scene.display.render_aa = "8"
else:
    scene.eevee.use_gtao = True
    scene.eevee.taa_render_samples = 16

bpy.ops.render.render(write_still=True)  # compiles, and is not counted
wall, cpu = time.perf_counter(), time.process_time()
for _ in range(5):
    bpy.ops.render.render()
print("%s: %.0f ms of processor time, %.0f ms by the clock"
      % (engine, 200 * (time.process_time() - cpu), 200 * (time.perf_counter() - wall)))
