/* STL: 80 bytes, a count, and 50 bytes a triangle. OBJ with MTL, and PLY, as their readers in src/formats describe
 * them. 3MF ("3D Manufacturing Format, Core Specification", 1.3, "Materials and Properties Extension", 1.2): a zip with
 * a part in XML and a picture. */
#include "export/model_write.h"

#include "base/key_map.h"
#include "base/mem.h"
#include "export/gltf_file_internal.h"
#include "export/triangles_internal.h"
#include "export/zip_internal.h"
#include "image/transfer.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void export_model_destroy(struct export_model *model) {
    for (size_t i = 0; i < model->parts.count; i++) {
        list_destroy(&export_parts(model)[i].points);
        list_destroy(&export_parts(model)[i].triangles);
    }
    list_destroy(&model->parts);
    list_destroy(&model->materials);
}

/* A file that grows; without memory it stays as it is, and the result is an error. */
struct writer {
    const struct export_model *model;
    const struct model_write_options *options;
    struct model_files *files;
    struct list *out; /* one of them */
    bool failed;
    struct key_map colours; /* of the corners of textured triangles: their numbers in the group */
};

static void put(struct writer *w, const void *bytes, size_t size) {
    w->failed = !list_add_bytes(w->out, bytes, size) || w->failed;
}

static void print(struct writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void print(struct writer *w, const char *format, ...) {
    char line[512];
    va_list values;
    va_start(values, format);
    int length = vsnprintf(line, sizeof line, format, values);
    va_end(values);
    if (length > 0)
        put(w, line, (size_t)length < sizeof line ? (size_t)length : sizeof line - 1);
}

static void put_number(struct writer *w, uint32_t number, size_t bytes) {
    w->failed = !list_add_number(w->out, number, bytes) || w->failed;
}

static void put_float(struct writer *w, double value) {
    float number = (float)value;
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    put_number(w, bits, 4);
}

static const struct export_material *material_at(const struct writer *w, uint32_t material) {
    return (struct export_material *)w->model->materials.items + material;
}

static size_t count_of(const struct export_model *model, bool points) {
    size_t count = 0;
    for (size_t i = 0; i < model->parts.count; i++)
        count += points ? export_parts(model)[i].points.count : export_parts(model)[i].triangles.count;
    return count;
}

const char *export_plain_name(const char *name, char out[64]) {
    size_t length = 0;
    for (; name[length] && length < 63; length++) {
        char c = name[length];
        bool fine = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || strchr("_-.", c);
        out[length] = fine ? c : '_';
    }
    out[length] = '\0';
    return out;
}

/* The normal and the corners of a triangle. */
static void facet_of(const struct export_part *part, size_t triangle, struct vec3 out[4]) {
    export_corners(part, triangle, out + 1);
    out[0] = vec3_normalize(triangle_normal(out + 1));
}

static void print_points(struct writer *w, const struct export_part *part, const char *format) {
    for (const struct vec3 *p = export_points(part), *end = p + part->points.count; p < end; p++)
        print(w, format, p->x, p->y, p->z);
}

static void write_stl(struct writer *w) {
    char header[80] = {0};
    memcpy(header, model_stl_header, strlen(model_stl_header));
    put(w, header, sizeof header);
    put_number(w, (uint32_t)count_of(w->model, false), 4);
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        for (size_t t = 0; t < part->triangles.count; t++) {
            struct vec3 facet[4];
            facet_of(part, t, facet);
            for (int k = 0; k < 12; k++)
                put_float(w, vec3_get(facet[k / 3], k % 3));
            put_number(w, 0, 2);
        }
    }
}

static void write_text_stl(struct writer *w) {
    char name[64];
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        print(w, "solid %s\n", export_plain_name(part->name, name));
        for (size_t t = 0; t < part->triangles.count; t++) {
            struct vec3 f[4];
            facet_of(part, t, f);
            print(w, "facet normal %.9g %.9g %.9g\nouter loop\n", f[0].x, f[0].y, f[0].z);
            for (int k = 1; k < 4; k++)
                print(w, "vertex %.9g %.9g %.9g\n", f[k].x, f[k].y, f[k].z);
            print(w, "endloop\nendfacet\n");
        }
        print(w, "endsolid %s\n", name);
    }
}

static void write_obj(struct writer *w) {
    char name[64];
    size_t first = 1;
    print(w, "%s\nmtllib %s\n", model_obj_header, w->options->mtl_name);
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        uint32_t material = UINT32_MAX;
        print(w, "o %s\n", export_plain_name(part->name, name));
        print_points(w, part, "v %.9g %.9g %.9g\n");
        for (size_t t = 0; t < part->triangles.count; t++) {
            const struct export_triangle *triangle = &export_triangles(part)[t];
            if (triangle->material != material)
                print(w, "usemtl %s\n", material_at(w, triangle->material)->name);
            material = triangle->material;
            print(w, "f %zu %zu %zu\n", first + triangle->vertex[0], first + triangle->vertex[1],
                  first + triangle->vertex[2]);
        }
        first += part->points.count;
    }
}

static void write_mtl(struct writer *w) {
    print(w, "%s\n", model_obj_header);
    for (uint32_t i = 0; i < w->model->materials.count; i++) {
        struct colour kd = material_at(w, i)->diffuse;
        print(w, "newmtl %s\nKd %.6g %.6g %.6g\n", material_at(w, i)->name, kd.r, kd.g, kd.b);
    }
}

static void write_ply(struct writer *w) {
    print(w,
          "ply\nformat binary_little_endian 1.0\ncomment written by gray\nelement vertex %zu\n"
          "property float x\nproperty float y\nproperty float z\nelement face %zu\n"
          "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
          "end_header\n",
          count_of(w->model, true), count_of(w->model, false));
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        for (size_t k = 0; k < 3 * part->points.count; k++)
            put_float(w, vec3_get(export_points(part)[k / 3], (int)(k % 3)));
    }
    uint32_t first = 0;
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        for (size_t t = 0; t < part->triangles.count; t++) {
            const struct export_triangle *triangle = &export_triangles(part)[t];
            const uint8_t(*display)[3] = triangle->display;
            put_number(w, 3, 1);
            for (int k = 0; k < 3; k++)
                put_number(w, first + triangle->vertex[k], 4);
            for (int k = 0; k < 3; k++)
                put_number(w, (1U + display[0][k] + display[1][k] + display[2][k]) / 3, 1);
        }
        first += (uint32_t)part->points.count;
    }
}

static bool write_coloured_ply(const struct coloured_mesh *mesh, struct list *out) {
    struct writer w = {.out = out};
    print(&w,
          "ply\nformat binary_little_endian 1.0\ncomment written by gray\nelement vertex %zu\n"
          "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
          "property uchar blue\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
          mesh->point_count, mesh->triangle_count);
    for (size_t i = 0; i < mesh->point_count; i++) {
        for (int k = 0; k < 3; k++)
            put_float(&w, vec3_get(mesh->points[i], k));
        put(&w, mesh->colours[i], 3);
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        put_number(&w, 3, 1);
        for (int k = 0; k < 3; k++)
            put_number(&w, mesh->triangles[i][k], 4);
    }
    return !w.failed;
}

/* Adds the numbers of the vertices, three each, to the buffer; prints their accessor. */
static void print_floats(struct writer *w, struct gltf_buffer *buffer, const float *numbers, size_t count) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    uint32_t view = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        low[i % 3] = math_min(low[i % 3], (double)numbers[i]);
        high[i % 3] = math_max(high[i % 3], (double)numbers[i]);
    }
    w->failed = !gltf_add_view(buffer, numbers, 3 * count * sizeof *numbers, GLTF_VERTICES, &view) || w->failed;
    print(w,
          "{\"bufferView\":%u,\"componentType\":5126,\"count\":%zu,\"max\":[%.17g,%.17g,%.17g],"
          "\"min\":[%.17g,%.17g,%.17g],\"type\":\"VEC3\"},",
          view, count, high[0], high[1], high[2], low[0], low[1], low[2]);
}

/* One mesh of colours that are light already (KHR_materials_unlit). */
static bool write_coloured_glb(const struct coloured_mesh *mesh, struct list *out) {
    const struct transfer_function srgb = {.kind = TRANSFER_SRGB};
    const size_t count = mesh->point_count, corners = 3 * mesh->triangle_count;
    struct gltf_buffer buffer = {0};
    struct list text = {0};
    struct writer w = {.out = &text};
    struct error unused = {0};
    uint32_t view = 0;
    float *numbers = mem_alloc((6 * count + 1) * sizeof *numbers), *colours = numbers + 3 * count;
    for (size_t i = 0; numbers && i < 3 * count; i++) {
        numbers[i] = (float)vec3_get(mesh->points[i / 3], (int)(i % 3));
        colours[i] = (float)transfer_decode(srgb, mesh->colours[i / 3][i % 3] / 255.0);
    }
    print(&w, "%s\"version\":\"2.0\"},\"accessors\":[", model_glb_header);
    if (numbers) {
        print_floats(&w, &buffer, numbers, count);
        print_floats(&w, &buffer, colours, count);
    }
    mem_free(numbers);
    bool ok = numbers && gltf_add_indices(&buffer, (const uint32_t *)mesh->triangles, corners, count, &view);
    print(&w, "{\"bufferView\":%u,\"componentType\":%u,\"count\":%zu,\"type\":\"SCALAR\"}],\"bufferViews\":[", view,
          gltf_index_component(count), corners);
    for (size_t i = 0; i < buffer.views.count; i++) {
        const struct gltf_view *at = (const struct gltf_view *)buffer.views.items + i;
        print(&w, "%s{\"buffer\":0,\"byteLength\":%zu,\"byteOffset\":%zu,\"target\":%u}", i ? "," : "", at->size,
              at->start, at->target);
    }
    print(&w,
          "],\"buffers\":[{\"byteLength\":%zu}],\"extensionsUsed\":[\"KHR_materials_unlit\"],\"materials\":[{"
          "\"doubleSided\":true,\"extensions\":{\"KHR_materials_unlit\":{}}}],\"meshes\":[{\"primitives\":[{"
          "\"attributes\":{\"COLOR_0\":1,\"POSITION\":0},\"indices\":2,\"material\":0}]}],\"nodes\":[{\"mesh\":0}],"
          "\"scene\":0,\"scenes\":[{\"nodes\":[0]}]}",
          buffer.bytes.count);
    ok = ok && !w.failed && gltf_file_write(&buffer, &text, true, out, &unused);
    gltf_buffer_destroy(&buffer);
    list_destroy(&text);
    return ok;
}

bool coloured_mesh_write(const struct coloured_mesh *mesh, enum model_format format, struct list *out) {
    return format == FORMAT_GLB ? write_coloured_glb(mesh, out) : write_coloured_ply(mesh, out);
}

/* --- 3MF --- */

static void print_escaped(struct writer *w, const char *text) {
    for (; *text; text++) {
        const char *entity = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        if (entity)
            print(w, "%s", entity);
        else
            put(w, (unsigned char)*text < ' ' ? "_" : text, 1);
    }
}

static uint64_t key_of(const uint8_t display[3]) {
    return 1 + ((uint64_t)display[0] << 16 | (uint64_t)display[1] << 8 | display[2]);
}

/* The group of the colours of textured triangles, each once. */
static void write_colours(struct writer *w) {
    struct key_map *colours = &w->colours;
    for (size_t i = 0; i < w->model->parts.count; i++) {
        const struct export_part *part = &export_parts(w->model)[i];
        for (size_t c = 0; c < 3 * part->triangles.count; c++) {
            const struct export_triangle *triangle = &export_triangles(part)[c / 3];
            uint64_t key = key_of(triangle->display[c % 3]);
            if (!material_at(w, triangle->material)->textured || key_map_find(colours, key))
                continue;
            if (colours->count == 0)
                print(w, "<m:colorgroup id=\"%zu\">\n", w->model->parts.count + 2);
            print(w, "<m:color color=\"#%06X\"/>\n", (unsigned)key - 1);
            w->failed = !key_map_add(colours, key, (uint32_t)colours->count) || w->failed;
        }
    }
    print(w, colours->count > 0 ? "</m:colorgroup>\n" : "");
}

static void write_corners(struct writer *w, const struct export_triangle *triangle) {
    print(w, " pid=\"%zu\"", w->model->parts.count + 2);
    for (int k = 0; k < 3; k++) {
        const uint32_t *number = key_map_find(&w->colours, key_of(triangle->display[k]));
        print(w, " p%d=\"%u\"", k + 1, number ? *number : 0); /* NULL: no memory, and the writer has failed */
    }
}

static void write_object(struct writer *w, const struct export_part *part, size_t id) {
    const struct export_triangle *triangles = export_triangles(part);
    print(w, "<object id=\"%zu\" type=\"model\" pid=\"1\" pindex=\"%u\" name=\"", id, triangles[0].material);
    print_escaped(w, part->name);
    print(w, "\"><mesh><vertices>\n");
    print_points(w, part, "<vertex x=\"%.9g\" y=\"%.9g\" z=\"%.9g\"/>\n");
    print(w, "</vertices><triangles>\n");
    for (size_t t = 0; t < part->triangles.count; t++) {
        print(w, "<triangle v1=\"%u\" v2=\"%u\" v3=\"%u\"", triangles[t].vertex[0], triangles[t].vertex[1],
              triangles[t].vertex[2]);
        if (material_at(w, triangles[t].material)->textured)
            write_corners(w, &triangles[t]);
        else if (triangles[t].material != triangles[0].material)
            print(w, " pid=\"1\" p1=\"%u\"", triangles[t].material);
        print(w, "/>\n");
    }
    print(w, "</triangles></mesh></object>\n");
}

static void write_3mf_model(struct writer *w) {
    static const char *const units[] = {
        [MODEL_MM] = "millimeter", [MODEL_CM] = "centimeter", [MODEL_M] = "meter", [MODEL_IN] = "inch"};
    print(w,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"%s\" xml:lang=\"en-US\" "
          "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
          "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n"
          "<metadata name=\"Application\">gray</metadata>\n<resources><basematerials id=\"1\">\n",
          units[w->options->unit]);
    for (uint32_t i = 0; i < w->model->materials.count; i++) {
        const uint8_t *display = material_at(w, i)->display;
        print(w, "<base name=\"%s\" displaycolor=\"#%06X\"/>\n", material_at(w, i)->name,
              (unsigned)key_of(display) - 1);
    }
    print(w, "</basematerials>\n");
    write_colours(w);
    for (size_t i = 0; i < w->model->parts.count; i++)
        write_object(w, &export_parts(w->model)[i], i + 2);
    print(w, "</resources><build>\n");
    for (size_t i = 0; i < w->model->parts.count; i++)
        print(w, "<item objectid=\"%zu\"/>\n", i + 2);
    print(w, "</build></model>\n");
}

static bool write_3mf(struct writer *w) {
    static const char types[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
        "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
        "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
        "<Default Extension=\"png\" ContentType=\"image/png\"/></Types>";
    static const char relations[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
        "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
        "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
        "<Relationship Target=\"/Metadata/thumbnail.png\" Id=\"rel1\" "
        "Type=\"http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail\"/></Relationships>";
    struct list model = {0}, *out = w->out, *directory = &w->files->directory;
    w->out = &model;
    write_3mf_model(w);
    bool ok = !w->failed && zip_add(out, directory, "3D/3dmodel.model", model.items, model.count) &&
              zip_add(out, directory, "[Content_Types].xml", types, sizeof types - 1) &&
              zip_add(out, directory, "_rels/.rels", relations, sizeof relations - 1);
    list_destroy(&model);
    key_map_destroy(&w->colours);
    return ok;
}

bool model_add_thumbnail(struct model_files *files, const struct list *png, struct error *error) {
    return (zip_add(&files->model, &files->directory, "Metadata/thumbnail.png", png->items, png->count) &&
            zip_end(&files->model, &files->directory, 4)) ||
           error_no_memory(error, "a model");
}

void model_files_destroy(struct model_files *files) {
    list_destroy(&files->model);
    list_destroy(&files->mtl);
    list_destroy(&files->directory);
}

bool model_write(const struct export_model *model, const struct model_write_options *options, struct model_files *files,
                 struct error *error) {
    struct writer w = {.model = model, .options = options, .files = files, .out = &files->model};
    if (count_of(model, false) > INT32_MAX || count_of(model, true) > INT32_MAX)
        return error_set(error, ERROR_SCENE, "the model has more triangles than its file can count");
    switch (options->format) {
    case FORMAT_STL:
        options->text ? write_text_stl(&w) : write_stl(&w);
        break;
    case FORMAT_OBJ:
        write_obj(&w);
        w.out = &files->mtl;
        write_mtl(&w);
        break;
    case FORMAT_PLY:
        write_ply(&w);
        break;
    case FORMAT_3MF:
        w.failed = !write_3mf(&w);
        break;
    case FORMAT_GLTF:
    case FORMAT_GLB:
    case FORMAT_OTHER:
        break;
    }
    return !w.failed || error_no_memory(error, "a model");
}
