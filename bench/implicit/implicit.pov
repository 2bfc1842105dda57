// Twin of implicit.lua: Declare=Name=0 to 9 selects the function. Its max_gradient is the smallest without holes, by hand.
#version 3.7;
global_settings { assumed_gamma 1.0 }
camera { perspective location <2.4, 1.8, 3.2> right -x * 4/3 up y angle 48 look_at 0 }
light_source { <5, 8, 3> rgb 0.9 }
#declare Golden = (1 + sqrt(5)) / 2;
#declare Square = Golden * Golden;
#declare Ball = function(x, y, z) { exp(-10 * (x * x + y * y + z * z)) }
#declare Mix = function(x, y, z) { min(x, y) - pow(max(z - abs(x - y), 0) / z, 2) * z / 4 }
#declare Gyroid = function(x, y, z) { sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x) }
#declare Box = function(x, y, z) { sqrt(pow(max(x, 0), 2) + pow(max(y, 0), 2) + pow(max(z, 0), 2)) - 0.1 }
#declare Length = function(x, y, z) { sqrt(x * x + y * y + z * z) }
#declare Ring = function(x, y, z) { Length(Length(x, 0, z) - 0.6, y, 0) - 0.2 }
#declare Rod = function(x, y, z) { max(Length(x, 0, z) - 0.1, abs(y) - 0.8) }
#declare Heart = function(x, y, z) { pow(x * x + 2.25 * y * y + z * z - 1, 3) - x * x * z * z * z - 0.1125 * y * y * z * z * z }
#declare Barth = function(x, y, z) { 4 * (Square * x * x - y * y) * (Square * y * y - z * z) * (Square * z * z - x * x)
  - (1 + 2 * Golden) * pow(x * x + y * y + z * z - 1, 2) }
isosurface {
  #switch (Name)
    #case (0) #declare G = 1.75; function { Length(x, y, z) - 0.8 + 0.1 * sin(10 * x) * sin(10 * y) * sin(10 * z) } #break
    #case (1) #declare G = 14; function { Gyroid(8 * x, 8 * y, 8 * z) } #break
    #case (2) #declare G = 10.5; function { abs(Gyroid(6 * x, 6 * y, 6 * z)) - 0.25 } #break
    #case (3) #declare G = 300; function { Barth(1.5 * x, 1.5 * y, 1.5 * z) } #break
    #case (4) #declare G = 250; function { Heart(1.3 * x, 1.3 * z, 1.3 * y) } #break
    #case (5) #declare G = 3; function { 0.4 - Ball(x, y, z) - Ball(x - 0.5, y - 0.3, z - 0.1) - Ball(x + 0.4, y - 0.4, z - 0.3)
        - Ball(x - 0.1, y + 0.5, z - 0.3) - Ball(x + 0.3, y + 0.2, z + 0.5) } #break
    #case (6) #declare G = 1.7; function { Box(abs(cos(2 * y) * x + sin(2 * y) * z) - 0.4, abs(y) - 0.8,
        abs(cos(2 * y) * z - sin(2 * y) * x) - 0.4) } #break
    #case (7) #declare G = 12.5; function { pow(pow(abs(x), 2.5) + pow(abs(z), 2.5), 0.4) + pow(abs(y), 0.7) - 0.9 } #break
    #case (8) #declare G = 1.1; function { Length(mod(x + 5, 0.5) - 0.25, mod(y + 5, 0.5) - 0.25, mod(z + 5, 0.5) - 0.25) - 0.2 } #break
    #case (9) #declare G = 1.1; function { Mix(Mix(Ring(x, y, z), Length(x - 0.2, y, z) - 0.45, 0.2), Rod(x, y, z), 0.15) } #break
  #end
  contained_by { box { -1, 1 } }
  max_gradient G accuracy 0.0001
  pigment { rgb <0.8, 0.6, 0.3> } finish { ambient 0.2 diffuse 1 phong 0.3 phong_size 20 }
}
plane { y, -1.2 pigment { rgb <0.5, 0.5, 0.55> } finish { ambient 0.2 diffuse 1 } }
