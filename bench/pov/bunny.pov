// Twin of bunny.lua: a scanned mesh of 69,451 smooth triangles, 2 high, on a floor; two lamps, a faint mirror, depth 5.
// mesh.inc is written by mesh.lua from the OBJ file.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 5 }
camera { perspective location <0.4, 1.9, -4.2> look_at <0, 0.95, 0> angle 38 right x * 4/3 up y }
light_source { <5, 7, -6> rgb 0.85 }
light_source { <-6, 5, -3> rgb <0.25, 0.28, 0.35> }
background { rgb <0.3, 0.35, 0.45> }
box { <-8, -0.2, -8>, <8, 0, 8>
  pigment { checker rgb 0.85, rgb 0.3 scale 0.5 } finish { ambient 0.08 diffuse 0.8 reflection 0.1 } }
#include "mesh.inc"
object { Mesh pigment { rgb <0.8, 0.7, 0.55> } finish { ambient 0.08 diffuse 0.75 phong 0.5 phong_size 40 reflection 0.08 } }
