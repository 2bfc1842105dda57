// Twin of solids.lua: 16 CSG solids of marble and wood on a floor under a 4 x 4 area light, depth 5.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 5 }
camera { perspective location <0, 6, -12> look_at <0, 0.8, 0> angle 45 right x * 4/3 up y }
light_source { <6, 11, -7> rgb 1 area_light <2.5, 0, 0>, <0, 0, 2.5>, 4, 4 }
background { rgb <0.15, 0.18, 0.25> }
#declare Marble = pigment { marble turbulence 0.8 octaves 4 omega 0.5 lambda 2 scale 0.7
  color_map { [0 rgb <0.95, 0.93, 0.90>] [1 rgb <0.25, 0.22, 0.25>] } }
#declare Wood = pigment { wood turbulence 0.08 octaves 4 scale 0.18 rotate x * 82
  color_map { [0 rgb <0.70, 0.45, 0.22>] [1 rgb <0.30, 0.16, 0.06>] } }
#declare Finish = finish { ambient 0.08 diffuse 0.75 phong 0.4 phong_size 30 }
#declare Node = difference { intersection { box { -0.8, 0.8 } sphere { 0, 1.08 } }
  cylinder { -2 * x, 2 * x, 0.45 } cylinder { -2 * y, 2 * y, 0.45 } cylinder { -2 * z, 2 * z, 0.45 } }
#declare Bitten = difference { sphere { 0, 0.9 } box { <0, 0, -1>, 1 } sphere { <-0.5, 0.5, -0.6>, 0.45 } }
#declare Hut = intersection { cone { -0.9 * y, 0.95, 1.1 * y, 0.1 } box { <-0.7, -0.9, -0.7>, <0.7, 0.8, 0.7> } sphere { -0.2 * y, 0.95 } }
box { <-14, -0.2, -14>, <14, -0.01, 14>
  pigment { checker rgb <0.75, 0.72, 0.65>, rgb <0.35, 0.33, 0.30> } finish { ambient 0.08 diffuse 0.8 } }
#for (I, 0, 15)
  object { #switch (mod(I, 3)) #case (0) Node #break #case (1) Bitten #break #else Hut #end
    #if (mod(I, 2) = 0) pigment { Marble } #else pigment { Wood } #end finish { Finish }
    rotate y * 31 * I translate <2.4 * mod(I, 4) - 3.6, 0.95, 2.4 * floor(I / 4) - 3.2> }
#end
