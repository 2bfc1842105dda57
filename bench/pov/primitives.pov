// Twin of primitives.lua: 25 balls (red mirrors, green, glass) and 12 posts on a checkered floor, two lamps, depth 8.
// POV-Ray is left-handed: z here is -z there.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 8 }
camera { perspective location <0, 4.5, -11> look_at <0, 0.9, 0> angle 50 right x * 4/3 up y }
light_source { <8, 12, -9> rgb <0.90, 0.90, 0.85> }
light_source { <-9, 7, -6> rgb <0.25, 0.28, 0.35> }
background { rgb <0.25, 0.35, 0.55> }
box { <-14, -0.2, -14>, <14, 0, 14>
  pigment { checker rgb 0.9, rgb 0.15 } finish { ambient 0.08 diffuse 0.8 reflection 0.15 } }
#for (I, 0, 24)
  #local X = mod(I, 5) - 2;
  #local Z = floor(I / 5) - 2;
  sphere { <1.6 * X, 0.6, 1.6 * Z>, 0.6
    #switch (mod(I, 3))
    #case (0) pigment { rgb <0.8, 0.2 + 0.1 * X, 0.2> } finish { ambient 0.08 diffuse 0.7 phong 0.6 phong_size 40 reflection 0.3 } #break
    #case (1) pigment { rgb <0.2, 0.6, 0.3 + 0.1 * Z> } finish { ambient 0.08 diffuse 0.7 phong 0.6 phong_size 40 reflection 0.05 } #break
    #else pigment { rgbf <0.95, 0.98, 1, 0.9> } finish { ambient 0 diffuse 0.1 phong 0.8 phong_size 80 reflection 0.1 } interior { ior 1.5 }
    #end }
#end
#for (I, 0, 11)
  box { <-0.35, 0, -0.35>, <0.35, 0.8 + 0.15 * mod(I, 4), 0.35>
    rotate y * 23 * I translate <5.6 * cos(I * pi / 6), 0, 5.6 * sin(I * pi / 6)>
    pigment { rgb <0.7, 0.65, 0.2 + 0.06 * I> } finish { ambient 0.08 diffuse 0.7 phong 0.6 phong_size 40 reflection 0.2 } }
#end
