/* The table of foreign words. A row is a list of words and what to use; the first row with the word is taken. Rows of
 * fields hold only for functions that have a certain field. Every name of gray in the table exists, which a test
 * checks. */
#include "settings/foreign_words.h"

#include <string.h>

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* Words are separated by blanks, in lower case, without '_', '-' and a plural s, American, without a prefix (plain). */
struct foreign_word {
    const char *use, *words;
};
struct foreign_field {
    const char *field; /* that the function must have */
    const char *use;   /* NULL: `field` */
    const char *words;
};

static const struct foreign_word options[] = {
    {"--spp N with --integrator path, else -ss N", "sample nsample samplesperpixel aa antialias antialiasing quality"},
    {"-j N", "thread nthread core cpu processor worker job parallel t p nproc workthread"},
    {"--size WxH", "resolution res width height w dimension geometry imagesize viewport"},
    {"the fields eye, target and fov of gr.render", "camera cam eye from position lookat lookfrom target"},
    {"the fields eye, target and fov of gr.render", "direction fov fieldofview angle zoom"},
    {"-o FILE", "output out outfile outputfile filename file save saveas dest to image picture png export"},
    {"-o FILE: the ending decides", "format outputformat type jpg jpeg exr hdr pfm gif mp4 webp"},
    {"--integrator path|whitted",
     "renderer method engine algorithm mode pathtracer pathtracing pathtrace path pt radiosity globalillumination"},
    {"--max-depth N, or -reflect-limit and -refract-limit", "bounce depth raydepth recursion recursiondepth"},
    {"--srgb, the curve of screens", "gamma"},
    {"--tone reinhard or --tone filmic", "tonemap tonemapping tonemapper tm"},
    {"--exposure STOPS", "brightness ev stop iso gain"},
    {"--frames N or --frames A-B", "animation animate framestart frameend framerange framecount nframe frame"},
    {"--fps X", "framerate rate"},
    {"-gui", "window show interactive live viewer ui"},
    {"--time-limit SECONDS", "time timeout timebudget rendertime second duration"},
    {"--crop X,Y,W,H", "region tile cropwindow border roi cropregion subregion"},
    {"--verbose", "log debug info loglevel verbosity v"},
    {"-q", "silent s"},
    {"--stats", "stat statistic profile timing benchmark"},
    {"--force", "overwrite f yes y replace"},
    {"-D name=value", "set var variable param parameter arg define"},
    {"the fields aperture and focus of gr.render", "dof depthoffield aperture lens focus"},
    {"the fields lights and background of gr.render", "light lamp sun environment env envmap hdri sky background"},
    {"its name alone, as in gray scene.lua", "scene input i script infile in load open"},
    {"--noise X, with --integrator path", "adaptive noisethreshold adaptivethreshold targetnoise error"},
    {"--watch", "reload auto"},
    {"--allow-read DIR", "include includepath l"},
    {"--turntable N", "turn rotate spin"},
};

static const struct foreign_word functions[] = {
    {"gr.light{position = ..., colour = ...}", "pointlight omnilight omni bulb lamp lightsource pointlamp"},
    {"gr.sun_light or gr.directional_light", "sun sunlight sunlamp"},
    {"gr.directional_light", "directional distantlight parallellight dirlight infinitelight farlight"},
    {"gr.area_light", "area quadlight rectlight rectanglelight softbox squarelight"},
    {"gr.spherical_light", "spherelight balllight"},
    {"gr.spot_light", "spot spotlamp conelight"},
    {"the field ambient of gr.render", "ambient ambientlight"},
    {"gr.sky_map{image = ...} as background, or gr.sky_light", "environment environmentlight envlight domelight"},
    {"gr.sky_map{image = ...} as background", "ibl hdri skydome skybox skysphere environmentmap"},
    {"gr.sphere", "ball globe spheregeometry uvsphere icosphere"},
    {"gr.box or gr.cube", "cuboid brick boxgeometry block"},
    {"gr.rectangle", "rect quad quadrilateral planegeometry"},
    {"gr.plane", "ground floor infiniteplane groundplane halfspace"},
    {"gr.disc", "circle disk circlegeometry"},
    {"gr.cylinder, or gr.sweep along a curve", "tube pipe cylindergeometry"},
    {"gr.torus", "ring donut doughnut torusgeometry"},
    {"gr.cone, or gr.mesh with your own vertices", "pyramid frustum conegeometry truncatedcone"},
    {"gr.mesh(material, 'file.obj')", "polyhedron trimesh trianglemesh indexedfaceset obj loadobj load import"},
    {"gr.mesh(material, 'file.obj')",
     "stl importstl loadstl ply gltf glb model loadmodel loadmesh readobj buffergeometry shape"},
    {"gr.prism", "linearextrude extrude extrusion"},
    {"gr.lathe", "rotateextrude revolve revolution surfaceofrevolution sor"},
    {"gr.blob", "metaball blobby"},
    {"gr.implicit", "isosurface sdf julia distancefield parametric"},
    {"gr.height_field", "heightmap terrain heightfield elevation surface"},
    {"gr.patch", "bezier bicubicpatch nurbs bezierpatch"},
    {"gr.curve", "spline line polyline hair"},
    {"require 'text' and text.node", "text text3d font"},
    {"gr.node", "group empty object transform collection object3d container assembly scene parent world root"},
    {"gr.difference", "subtract minus cut sub subtraction boolean"},
    {"gr.union", "join combine fuse unite"},
    {"gr.intersection", "intersect common"},
    {"the method, as in n:translate(x, y, z) or n:rotate('y', degrees)",
     "translate move rotate scale multmatrix rotatex rotatey"},
    {"scene:add_child(n)", "add addchild append attach insert"},
    {"gr.material{kd = {r, g, b}}", "color paint pigment rgb rgba phong lambert lambertian matte diffuse"},
    {"gr.material{kd = {r, g, b}}",
     "basicmaterial standardmaterial phongmaterial meshphongmaterial meshlambertmaterial shader plastic"},
    {"gr.rr_material", "glass dielectric transparent water refractive transmission"},
    {"gr.material{kd = {0, 0, 0}, reflect = 1}", "mirror reflective chrome"},
    {"gr.metal_material", "metal conductor gold copper silver metallic"},
    {"gr.openpbr_material", "principled pbr disney uber physicalmaterial standardsurface openpbr principledbsdf"},
    {"gr.openpbr_material", "meshstandardmaterial meshphysicalmaterial pbrmaterial"},
    {"gr.material{kd = {0, 0, 0}, emission = {r, g, b}}", "emissive emitter emission glow diffuselight"},
    {"gr.uniform_fog", "fog mist haze volume medium fogexp2 media homogeneous atmosphere"},
    {"gr.texture('file.png')", "image imagetexture loadtexture texturemap picture imagemap bitmap loadimage"},
    {"require 'patterns': kd = function(p) return patterns.checker(p) end", "checker checkerboard checkertexture"},
    {"gr.bump", "bumpmap normalmap normal"},
    {"the fields eye, target and fov of gr.render", "camera perspective perspectivecamera lookat"},
    {"the fields eye, target and fov of gr.render", "orthographiccamera cam view eye ortho"},
    {"gr.render{node = scene, file = 'a.png', ...}", "draw show save output write renderimage raytrace"},
    {"gr.frames", "animate animation"},
    {"gr.vec(x, y, z)", "vector vec3 vector3 pvector point point3 color3 float3 v3 vec2 xyz createvector"},
    {"gr.mix", "lerp interpolate blend map"},
    {"gr.length", "norm magnitude len mag abs"},
    {"gr.normalize", "unit normalise normalized unitvector"},
    {"math.random", "random rand rnd"},
    {"the field background of gr.render", "background bg backgroundcolor"},
    {"require 'colour' and colour.hsv", "hsv hsl hsb colormode blackbody"},
    {"the fields width and height of gr.render", "size resolution canvas width height createcanvas"},
    {"gr.instances, or the same node twice", "instance clone copy duplicate use ref array duplicator"},
    {"gr.noise", "perlin perlinnoise snoise simplex simplexnoise"},
    {"gr.cells", "worley voronoi cellular"},
};

static const struct foreign_word methods[] = {
    {"node:translate(x, y, z)", "move moveto position pos offset shift location locate place at origin centre"},
    {"node:translate(x, y, z)", "translatex translatey translatez movex movey movez"},
    {"node:rotate('y', degrees)", "turn rotatex rotatey rotatez rotx roty rotz rot orient rotation rotateonaxis"},
    {"node:rotate('y', degrees)", "orientation roll pitch yaw euler rotz rot"},
    {"node:rotate(axis, degrees)", "lookat pointat face aim direction"},
    {"node:scale(x, y, z)", "resize size scale grow zoom stretch enlarge shrink"},
    {"node:scale(-1, 1, 1)", "mirror flip reflect"},
    {"node:add_child(n)", "add append attach insert push child include"},
    {"node:set_material(m)", "color paint material mat fill kd diffuse pigment use with shader apply"},
    {"node:set_texture(t)", "texture map image"},
    {"node:set_bump(b)", "bump bumpmap normalmap"},
    {"the field lights of gr.render", "addlight light"},
    {"the fields of gr.render", "camera addcamera background"},
    {"gr.difference(a, b)", "subtract minus difference cut sub"},
    {"the same node again: gr.node{children = {n}}", "clone copy duplicate instance dup"},
    {"node:bounds()", "boundingbox aabb extent getbound box bbox dimension getsize"},
    {"node:faces()", "vertices mesh tomesh triangulate getface geometry triangle"},
    {"node:pose{translate = ..., rotate = ...}", "transform matrix pose multmatrix applymatrix"},
    {"node:reset()", "clear cleartransform identity"},
    {"gr.frames, which draws each picture", "animate"},
    {"node:render{...} or gr.render{node = n, ...}", "draw show trace save raytrace output"},
    {"gr.prism", "extrude linearextrude"},
    {"the field name, as in gr.sphere{name = 'ball'}", "name rename"},
    {"a condition around node:add_child", "hide remove delete removechild visible kill"},
};

/* Fields. Those of materials first; a shape has `material`. */
#define COLOUR_WORDS "albedo color diffuse diffusecolor basecolor pigment rgb rgba tint "
#define IMAGE_WORDS "map texture image tex diffusemap diffusetexture colormap texturemap bitmap picture texturefile"
static const struct foreign_field fields[] = {
    {"kd", NULL, COLOUR_WORDS "reflectance fill paint surfacecolor maincolor ka"},
    {"ks", NULL, "specular specularcolor phong highlightcolor speccolor spec"},
    {"shininess", NULL, "phongsize exponent hardness gloss glossiness specularexponent ns n phongexponent"},
    {"reflect", NULL, "reflection reflectivity mirror kr reflective reflectionamount"},
    {"metalness", NULL, "metallic metal"},
    {"refract", NULL, "transparency transmission transparent refraction kt transmittance refractive transmit"},
    {"opacity", NULL, "alpha dissolve cutout opaque visibility"},
    {"ior", NULL, "index refractionindex indexofrefraction eta ri refractiveindex interior ni"},
    {"emission", NULL, "emissive glow emit luminance ke emissioncolor emissivecolor emissiveintensity emitted"},
    {"two_sided", NULL, "doublesided side doubleside twoside backface"},
    {"bump", NULL, "bumpmap normalmap normal bumptexture heightmap"},
    {"absorption", NULL, "attenuation beer extinction fadecolor absorb"},
    {"lit", "lit = false", "unlit flat shadeless basic"},
    {"kd", "kd = gr.texture('file.png')", IMAGE_WORDS "file filename"},
    {"base_color", NULL, COLOUR_WORDS "kd diffuseweight"},
    {"base_metalness", NULL, "metallic metalness metal"},
    {"specular_roughness", NULL, "roughness rough glossiness shininess"},
    {"specular_ior", NULL, "ior index eta refractiveindex"},
    {"specular_weight", NULL, "specular ks"},
    {"transmission_weight", NULL, "transmission transparency refract"},
    {"coat_weight", NULL, "clearcoat coat"},
    {"fuzz_weight", NULL, "sheen fuzz velvet"},
    {"subsurface_weight", NULL, "subsurface sss subsurfacescattering"},
    {"emission_luminance", "'emission_luminance' and 'emission_color'", "emission emissive ke glow"},
    {"geometry_opacity", NULL, "opacity alpha"},
    {"specular_roughness_anisotropy", NULL, "anisotropy anisotropic"},
    {"base_color", "base_color = gr.texture('file.png')", IMAGE_WORDS "file"},
    /* Pictures. */
    {"eye", "'eye', 'target' and 'fov'", "camera cam cameraangle"},
    {"eye", NULL, "cameraposition camerapos position pos from origin location lookfrom eyepos eyepoint viewpoint"},
    {"target", NULL, "lookat to at center centre aim focuson interest targetposition lookto cameratarget"},
    {"view", NULL, "direction dir viewdirection viewdir gaze forward"},
    {"up", NULL, "upvector vup cameraup updirection"},
    {"fov", NULL, "fovy fieldofview vfov zoom viewangle fovdegree hfov fovx"},
    {"width", "'width' and 'height'", "aspect aspectratio resolution size dimension res imagesize canvas"},
    {"width", NULL, "imagewidth w xres xresolution resx nx"},
    {"height", NULL, "imageheight h yres yresolution resy ny"},
    {"spp", "'samples', or 'spp' with integrator = 'path'", "spp sample samplesperpixel antialias antialiasing aa"},
    {"max_depth", "'max_depth', or 'reflect_limit' and 'refract_limit'", "bounce depth raydepth recursion"},
    {"integrator", NULL, "method renderer engine algorithm mode type technique"},
    {"aperture", "'aperture' and 'focus'", "dof depthoffield lensradius lens aperturesize blur"},
    {"focus", NULL, "focaldistance focusdistance focusdist focaldist"},
    {"srgb", NULL, "gamma"},
    {"tone", NULL, "tonemap tonemapping tonemapper"},
    {"exposure", NULL, "brightness ev iso"},
    {"ambient", NULL, "ambientlight globalambient ambientcolor"},
    {"background", NULL, "bg backgroundcolor bgcolor clearcolor environment env envmap hdri skycolor world"},
    {"lights", NULL, "lamp lighting lightsource sun"},
    {"fog", NULL, "mist haze"},
    {"file", NULL, "filename output outputfile out path outfile save saveas image picture name dest"},
    {"node", NULL, "scene root object geometry shape model node children primitive"},
    {"width", "the option -j N of the command line", "thread core cpu"},
    {"samples", NULL, "quality"},
    {"projection", "projection = 'orthographic'", "ortho orthographic orthogonal"},
    {"shutter", NULL, "motionblur shuttertime"},
    {"eye_to", "gr.frames, which draws each picture", "time frame animation"},
    /* Animations and lights. */
    {"count", NULL, "n frame framecount nframe numberofframes total"},
    {"seconds", NULL, "length duration time"},
    {"draw", NULL, "update func callback render fn function frame each"},
    {"draw", "the option -o FILE of the command line", "file output filename"},
    {"intensity", NULL, "power energy brightness strength watt lumen flux"},
    {"v1", "'v1' and 'v2', the edges", "v u edge size width height side uvec vvec a b axis1 axis2 edge1 edge2"},
    {"outer", "'inner' and 'outer'", "angle cone coneangle cutoff penumbra beamangle innerangle outerangle"},
    {"position", NULL, "pos location loc origin from center centre place at where"},
    {"target", NULL, "lookat at aim pointat to"},
    {"direction", NULL, "dir orientation vector toward pointing lookat target at to"},
    {"falloff", NULL, "attenuation decay fade fadedistance fadepower"},
    {"range", NULL, "distance reach"},
    {"samples", NULL, "shadowsample sample quality subdivision softness"},
    {"emission", NULL, "emissive power radiance luminance le"},
    {"hour", NULL, "time timeofday"},
    {"sun", NULL, "elevation azimuth altitude position direction"},
    {"sky", NULL, "environment env hdri map texture background image"},
    /* Fogs, textures, copies and other functions. */
    {"near", NULL, "start begin from neardistance"},
    {"far", NULL, "end fardistance distance"},
    {"tiles", NULL, "repeat tiling tile scale uvscale"},
    {"of", NULL, "object source what instance original mesh prototype"},
    {"at", NULL, "position point where transform place location matrices translation"},
    {"turn", NULL, "rotation rotate angle orientation"},
    {"turn", "'size', the factor", "scale"},
    {"operands", "the shapes alone, as in gr.difference{a, b}", "first left object1 base"},
    {"operands", NULL, "children object item node shape element part"},
    {"children", NULL, "object item node shape element part member content child"},
    {"file", NULL, "path filename url src model source obj stl meshfile geometry"},
    {"verts", NULL, "vertices point position vertex pt vertexlist"},
    {"faces", NULL, "triangle indices polygon tri index faceindices poly facelist"},
    {"f", NULL, "func fn function sdf field formula equation expression expr density"},
    {"bounds", NULL, "box boundingbox containedby domain limit"},
    {"points", NULL, "vertices vert pt controlpoint path curve profile knot"},
    {"outline", NULL, "profile shape polygon path point contour vert vertices"},
    /* Shapes. */
    {"radius", "none: its surface is exact", "segment slice fn fa fs stack side subdivision detail seg ring"},
    {"centre", NULL, "position pos location loc origin at middle midpoint c center"},
    {"corner", NULL, "position pos location origin at from minimum lowercorner center centre"},
    {"radius", NULL, "r rad"},
    {"radius", "'radius', half of the diameter", "d diameter dia size width"},
    {"from_radius", "'from_radius' and 'radius'", "r1 radius1 bottomradius baseradius radiusbottom toprad"},
    {"from_radius", "'from_radius' and 'radius'", "r2 radius2 topradius radiustop"},
    {"major", NULL, "majorradius outerradius ringradius radius r1 outer r"},
    {"to", "'from' and 'to'", "p1 start begin base a bottom point1 basepoint pa position centre center height h"},
    {"to", "'from' and 'to'", "axis end stop top apex p2 point2"},
    {"height", NULL, "h length depth"},
    {"max", "'min' and 'max'", "corner1 lower low a p1 from start corner position size width height depth"},
    {"max", "'min' and 'max'", "center centre corner2 upper high b p2 to end bound"},
    {"size", "size = {x, y, z}", "width height depth w h d dimension dim scale radius r edge side length xyz"},
    {"along", "'corner', 'along' and 'up'", "u v u1 edge1 edge2 width height size side position centre"},
    {"c", "'a', 'b' and 'c'", "p1 p2 p3 v1 v2 v3 v0 vertices point vert corner"},
    {"normal", NULL, "n dir direction up axis orientation"},
    {"material", "material = gr.material{kd = gr.texture(...)}", IMAGE_WORDS},
    {"material", "material = gr.material{kd = {r, g, b}}", COLOUR_WORDS "kd ks specular shininess reflect"},
    {"material", "material = gr.material{kd = {r, g, b}}",
     "reflection refract ior roughness metallic metalness emission emissive opacity alpha transparency"},
    {"material", NULL, "mat shader surface bsdf finish appearance skin style"},
    {"name", "n:translate(x, y, z)", "translate translation move position pos location offset origin at centre"},
    {"name", "n:rotate('y', degrees)", "rotate rotation orientation euler turn angle rotationx rotationy"},
    {"name", "n:scale(x, y, z)", "scale scaling size resize"},
    {"name", "the methods, as in n:translate(x, y, z)", "transform matrix pose transformation"},
    {"name", NULL, "id label title key tag"},
    {"name", "gr.node{children = {...}}", "children child node"},
};

enum { WORD_SIZE = 40 };

/* Lower case, without '_' and '-', colour as color, without the prefixes of setters and counts. False: too long. */
static bool plain(const char *word, size_t length, char out[WORD_SIZE]) {
    static const char *const prefixes[] = {"set", "max", "num"};
    size_t size = 0;
    for (size_t i = 0; i < length && size < WORD_SIZE - 1; i++) {
        char c = word[i] >= 'A' && word[i] <= 'Z' ? (char)(word[i] - 'A' + 'a') : word[i];
        bool is_british = c == 'u' && size >= 4 && memcmp(out + size - 4, "colo", 4) == 0;
        if (c != '_' && c != '-' && !is_british)
            out[size++] = c;
    }
    out[size] = '\0';
    for (size_t i = 0; i < COUNT(prefixes); i++) {
        if (size > 4 && strncmp(out, prefixes[i], 3) == 0) {
            memmove(out, out + 3, size - 2);
            break;
        }
    }
    return length < WORD_SIZE;
}

/* Whether the words have a plain one, which may have a plural s where they have none, or the other way round. */
static bool words_have(const char *words, const char *word) {
    size_t length = strlen(word);
    for (const char *at = words; *at;) {
        size_t end = strcspn(at, " "), common = end < length ? end : length;
        bool plural =
            length > 2 && ((end + 1 == length && word[end] == 's') || (length + 1 == end && at[length] == 's'));
        if ((plural || end == length) && strncmp(at, word, common) == 0)
            return true;
        at += end + (at[end] == ' ');
    }
    return false;
}

static const char *use_of(const struct foreign_word *rows, size_t count, const char *word, size_t length) {
    char text[WORD_SIZE];
    for (size_t i = 0; plain(word, length, text) && i < count; i++)
        if (words_have(rows[i].words, text))
            return rows[i].use;
    return NULL;
}

const char *foreign_option(const char *word, size_t length) {
    return use_of(options, COUNT(options), word, length);
}

const char *foreign_function(const char *word) {
    return use_of(functions, COUNT(functions), word, strlen(word));
}

const char *foreign_method(const char *word) {
    return use_of(methods, COUNT(methods), word, strlen(word));
}

const char *foreign_field(const char *word, bool (*has_field)(const void *function, const char *name),
                          const void *function, bool *is_name) {
    char text[WORD_SIZE];
    for (size_t i = 0; plain(word, strlen(word), text) && i < COUNT(fields); i++) {
        *is_name = !fields[i].use;
        if (has_field(function, fields[i].field) && words_have(fields[i].words, text))
            return *is_name ? fields[i].field : fields[i].use;
    }
    return NULL;
}

const char *foreign_use_at(size_t index) {
    static const struct {
        const struct foreign_word *rows;
        size_t count;
    } tables[] = {{options, COUNT(options)}, {functions, COUNT(functions)}, {methods, COUNT(methods)}};
    for (size_t i = 0; i < COUNT(tables); index -= tables[i++].count)
        if (index < tables[i].count)
            return tables[i].rows[index].use;
    return index < COUNT(fields) ? fields[index].use ? fields[index].use : fields[index].field : NULL;
}
