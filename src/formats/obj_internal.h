/* Reads Wavefront OBJ: v, vt, vn, f in its four spellings, negative indices, n-gons, continued lines, CRLF, blanks,
 * comments; groups, materials and everything else are skipped (formats/model.h reads them too). Facts: Wavefront
 * "Object Files (.obj)", Appendix B1 of the Advanced Visualizer manual. Speed matters: a million triangles are read
 * in a fraction of a second. Numbers are correctly rounded. Errors read `FILE:LINE: what`. */
#ifndef GRAY_FORMATS_OBJ_INTERNAL_H
#define GRAY_FORMATS_OBJ_INTERNAL_H

#include "base/error.h"
#include "mesh/mesh.h"

struct mesh *obj_read(const char *path, struct error *error);
/* From memory; `path` is for messages. The bytes need no final NUL. */
struct mesh *obj_parse(const char *path, const char *text, size_t size, struct error *error);

#endif
