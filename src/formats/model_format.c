#include "formats/model_format.h"

#include <string.h>
#include <strings.h>

const char model_stl_header[] = "gray: binary STL";
const char model_obj_header[] = "# written by gray";
const char model_scene_header[] = "-- A scene written by gray";
const char model_glb_header[] = "{\"asset\":{\"generator\":\"gray\",";

enum model_format model_format_written(const char *name) {
    static const char *const endings[] = {MODEL_FORMATS(LIST_WORD)};
    size_t length = strlen(name);
    for (int i = 0; i < LIST_COUNT(MODEL_FORMATS); i++)
        if (length > strlen(endings[i]) && strcasecmp(name + length - strlen(endings[i]), endings[i]) == 0)
            return (enum model_format)i;
    return FORMAT_OTHER;
}

enum model_format model_format_baked(const char *name) {
    enum model_format format = model_format_written(name);
    return format == FORMAT_PLY || format == FORMAT_GLB ? format : FORMAT_OTHER;
}

static bool begins(const uint8_t *head, size_t size, const char *text) {
    return size >= strlen(text) && memcmp(head, text, strlen(text)) == 0;
}

bool model_file_is(const uint8_t *head, size_t size) {
    /* The first file in a 3MF zip of gray is its model; other programs begin with a file that all such packages have.
     */
    bool package = begins(head, size, "PK\3\4") && size > 33 && memcmp(head + 30, "3D/", 3) == 0;
    bool glb = begins(head, size, "glTF") && size > 20 && begins(head + 20, size - 20, model_glb_header);
    bool json = begins(head, size, model_glb_header) || begins(head, size, "{\"define\": {\n") ||
                begins(head, size, "{\"defaults\": \"classic\",\n") || begins(head, size, "{\"gray\": 1,\n");
    return package || glb || json || begins(head, size, model_scene_header) || begins(head, size, model_stl_header) ||
           begins(head, size, model_obj_header) || begins(head, size, "solid ") || begins(head, size, "ply\n");
}
